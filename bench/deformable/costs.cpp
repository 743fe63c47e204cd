#include <algorithm>
#include <cstdio>
#include <ctime>
#include <vector>

#include <Eigen/Cholesky>

#include "deformable/bullet_chains.h"
#include "deformable/scenes.h"
#include "deformable/tables.h"

namespace fascia {
namespace {

constexpr double kStep_s = 1.0 / 600;

double cpu_s() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

// Median over runs of the processor time of one call, each run long enough for the clock.
template <class Task>
double medianCost_s(Task&& task) {
  constexpr int kRuns = 7;
  constexpr double kShortest_s = 0.03;
  std::vector<double> costs;
  for (int run = 0; run < kRuns; ++run) {
    int calls = 0;
    const double begin = cpu_s();
    double spent = 0;
    while ((spent = cpu_s() - begin) < kShortest_s) task(), ++calls;
    costs.push_back(spent / calls);
  }
  std::nth_element(costs.begin(), costs.begin() + kRuns / 2, costs.end());
  return costs[kRuns / 2];
}

// The bodies drift without gravity: every step costs the same, and nothing breaks in a long chain.
SceneOptions driftingScene(int bodies, Layout layout, bool constantJacobian) {
  return {.bodies = bodies,
          .layout = layout,
          .gravity_m_per_s2 = Vec3::Zero(),
          .constantJacobian = constantJacobian};
}

double stepCost_s(const SceneOptions& options) {
  BodyScene scene = makeScene(options);
  BodyStepper stepper(*scene.system, {.scheme = BodyScheme::explicitEuler});
  stepper.step(kStep_s, scene.state);
  return medianCost_s([&] { stepper.step(kStep_s, scene.state); });
}

// Forming J W Jᵀ of a chain densely and factoring it, as one would without sparsity.
double denseCost_s(int bodies) {
  const Eigen::Index n = 3 * bodies;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) A(i, i) = 2.1;
  for (Eigen::Index i = 3; i < n; ++i) A(i, i - 3) = A(i - 3, i) = -1;
  Eigen::VectorXd x = Eigen::VectorXd::Ones(n);
  return medianCost_s([&] { x = A.llt().solve(x).normalized(); });
}

void printCost(const char* name, int bodies, Layout layout) {
  const double once = stepCost_s(driftingScene(bodies, layout, true));
  const double every = stepCost_s(driftingScene(bodies, layout, false));
  std::printf("%-6s %7d %12.2f %14.4f %14.4f %9.2f", name, bodies, 1e6 * once, 1e6 * once / bodies,
              1e6 * every / bodies, every / once);
  constexpr int kMostDense = 300;
  if (layout == Layout::chain && bodies <= kMostDense)
    std::printf(" %14.3f", 1e6 * denseCost_s(bodies) / bodies);
  std::printf("\n");
  std::fflush(stdout);
}

struct RealTimeCase {
  const char* name;
  BodyStepperOptions options;
  int stepsPerFrame;
};

// Seconds of processor time for one second of 100 chains of 10 bars that swing.
double swingCost(const RealTimeCase& c, BodyStepperStats& stats) {
  constexpr int kFrames = 60;
  BodyScene scene = makeScene({.bodies = 1000, .chainLength = 10});
  BodyStepper stepper(*scene.system, c.options);
  stepper.step(kStep_s, scene.state);
  const double begin = cpu_s();
  for (int i = 0; i < kFrames * c.stepsPerFrame; ++i)
    stepper.step(1.0 / (kFrames * c.stepsPerFrame), scene.state);
  stats = stepper.stats();
  return (cpu_s() - begin) * 60.0 / kFrames;
}

}  // namespace

void printCosts() {
  std::printf("Explicit step, processor time in microseconds, one thread\n");
  std::printf("%-6s %7s %12s %14s %14s %9s %14s\n", "", "bodies", "per step", "per body, once",
              "every step", "ratio", "dense factor.");
  for (const int bodies : {10, 30, 100, 300, 1000, 3000, 10000})
    printCost("chain", bodies, Layout::chain);
  for (const int bodies : {10, 100, 1000, 10000}) printCost("tree", bodies, Layout::tree);
}

void printRealTime() {
  std::printf(
      "\n1000 bars, 100 chains of 10 nailed at one end, swinging for a second, one thread\n");
  std::printf("%-48s %12s %12s\n", "", "s per s", "x real time");
  const RealTimeCase cases[] = {
      {"explicit, 60 Hz x 10", {.scheme = BodyScheme::explicitEuler}, 10},
      {"implicit Euler, one iteration, 60 Hz x 10", {.max_iterations = 1}, 10},
      {"implicit Euler, 60 Hz x 10", {.tolerance = 1e-6}, 10},
      {"implicit Euler, 60 Hz", {.tolerance = 1e-6}, 1},
      {"energy conserving, 60 Hz x 10",
       {.scheme = BodyScheme::energyConserving, .tolerance = 1e-6},
       10},
  };
  for (const RealTimeCase& c : cases) {
    BodyStepperStats stats;
    const double cost = swingCost(c, stats);
    std::printf("%-48s %12.4f %12.2f   %llu stopped, %llu halved\n", c.name, cost, 1 / cost,
                static_cast<unsigned long long>(stats.stopped),
                static_cast<unsigned long long>(stats.halved));
    std::fflush(stdout);
  }
#ifdef FASCIA_WITH_BULLET
  printBulletChains(100, 10);
#endif
}

}  // namespace fascia
