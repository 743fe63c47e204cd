#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fascia/base/hash.h>
#include <fascia/base/parallel.h>

#include "deformable/scenes.h"
#include "deformable/tables.h"

namespace fascia {
namespace {

struct Scheme {
  const char* name;
  BodyScheme scheme;
};
constexpr Scheme kImplicit[] = {{"implicit Euler", BodyScheme::implicitEuler},
                                {"energy conserving", BodyScheme::energyConserving}};

// Worst drift and energy error of a chain that swings from the horizontal, without damping.
void printMinute(const Scheme& scheme, int bars, double rigidity_Pa) {
  BodyScene scene = makeScene(
      {.bodies = bars, .material = {.rigidity_Pa = rigidity_Pa, .volume_Pa = rigidity_Pa}});
  BodyStepper stepper(*scene.system, {.scheme = scheme.scheme});
  const double start_J = scene.system->energy_J(scene.state);
  // What falling to the lowest place sets free.
  const double mass_kg = scene.system->model().shape(BodyId(0)).mass_kg();
  const double swing_J = mass_kg * 9.81 * bars * (0.5 * bars * kBar_m.x());
  double drift_m = 0, energy_J = 0;
  for (int i = 0; i < 3600; ++i) {
    stepper.step(1.0 / 60, scene.state);
    drift_m = std::max(drift_m, scene.system->drift_m(scene.state));
    energy_J = std::max(energy_J, std::abs(scene.system->energy_J(scene.state) - start_J));
  }
  const BodyStepperStats& stats = stepper.stats();
  std::printf("%-18s %5d %10.0e %12.1e %12.1e %10.1f %7llu\n", scheme.name, bars, rigidity_Pa,
              drift_m / kBar_m.x(), energy_J / swing_J,
              static_cast<double>(stats.iterations) / static_cast<double>(stats.steps),
              static_cast<unsigned long long>(stats.halved));
  std::fflush(stdout);
}

// Period of small swings of one bar, relative to 2π √(I/(m g l)).
double periodError(const Scheme& scheme, double step_s) {
  BodyScene scene = makeScene({.bodies = 1, .material = {.rigidity_Pa = 1e9, .volume_Pa = 1e9}});
  constexpr double kAngle = 0.01;
  const double length = kBar_m.x(), width = kBar_m.y();
  const double exact_s =
      2 * kPi * std::sqrt((length * length / 3 + width * width / 12) / (9.81 * 0.5 * length)) *
      (1 + kAngle * kAngle / 16);
  Transform place;
  place.rotation = Eigen::AngleAxisd(kAngle - 0.5 * kPi, Vec3::UnitZ()).toRotationMatrix();
  place.translation_m = place.rotation * barEnd(1);
  scene.system->model().place(BodyId(0), place, scene.state);
  BodyStepper stepper(*scene.system, {.scheme = scheme.scheme});
  const BodyPoint tip{BodyId(0), barEnd(1)};
  double before = kAngle, first = 0, last = 0;
  int crossings = 0;
  while (scene.state.t_s < 20) {
    stepper.step(step_s, scene.state);
    const double x = scene.system->model().point(scene.state.r, tip).x();
    if (before < 0 && x >= 0) {
      last = scene.state.t_s - step_s * x / (x - before);
      if (crossings++ == 0) first = last;
    }
    before = x;
  }
  return (last - first) / (crossings - 1) / exact_s - 1;
}

}  // namespace

void printAccuracy() {
  std::printf("\nA minute at 60 Hz, one step per frame, no damping, from the horizontal\n");
  std::printf("%-18s %5s %10s %12s %12s %10s %7s\n", "", "bars", "Pa", "drift/size", "energy error",
              "iterations", "halved");
  for (const Scheme& scheme : kImplicit) {
    for (const double rigidity_Pa : {1e4, 1e6}) printMinute(scheme, 1, rigidity_Pa);
    printMinute(scheme, 3, 1e6);
  }
  std::printf("\nPeriod of a stiff bar's small swings against the closed form, relative error\n");
  for (const Scheme& scheme : kImplicit)
    for (const double rate_hz : {60, 240, 960})
      std::printf("%-18s %5.0f Hz %12.2e\n", scheme.name, rate_hz,
                  periodError(scheme, 1 / rate_hz));
}

void printStability() {
  std::printf(
      "\nTen seconds of 10 bars at 60 Hz, implicit Euler: largest length of a bar over its "
      "own\n");
  for (const double rigidity_Pa : {1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9}) {
    BodyScene scene = makeScene(
        {.bodies = 10, .material = {.rigidity_Pa = rigidity_Pa, .volume_Pa = rigidity_Pa}});
    BodyStepper stepper(*scene.system);
    double longest = 0;
    for (int i = 0; i < 600; ++i) {
      stepper.step(1.0 / 60, scene.state);
      for (int b = 0; b < 10; ++b) {
        const BodyModel& model = scene.system->model();
        const Vec3 along = model.point(scene.state.r, {BodyId(b), barEnd(1)}) -
                           model.point(scene.state.r, {BodyId(b), barEnd(-1)});
        longest = std::max(longest, along.norm() / kBar_m.x());
      }
    }
    std::printf("%8.0e Pa %10.4f, stopped %llu, %.1f iterations\n", rigidity_Pa, longest,
                static_cast<unsigned long long>(stepper.stats().stopped),
                static_cast<double>(stepper.stats().iterations) /
                    static_cast<double>(stepper.stats().steps));
    std::fflush(stdout);
  }
}

void printThreads() {
  std::printf("\nState hashes of 1000 bars after 60 steps\n");
  for (const Scheme& scheme :
       {Scheme{"explicit", BodyScheme::explicitEuler}, kImplicit[0], kImplicit[1]}) {
    for (const int threads : {1, 2, 4, 8}) {
      const ThreadLimit limit(threads);
      BodyScene scene = makeScene({.bodies = 1000, .chainLength = 10});
      BodyStepper stepper(*scene.system, {.scheme = scheme.scheme, .tolerance = 1e-6});
      for (int i = 0; i < 60; ++i) stepper.step(1.0 / 600, scene.state);
      StateHash hash;
      hash.add(scene.state.r.data(), scene.state.r.size() * sizeof(double));
      hash.add(scene.state.v.data(), scene.state.v.size() * sizeof(double));
      std::printf("%-18s %d threads %s\n", scheme.name, threads, hash.hex().c_str());
    }
  }
}

}  // namespace fascia
