#include <benchmark/benchmark.h>

#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include <fascia/base/parallel.h>
#include <fascia/math/supernodal_cholesky.h>

namespace fascia {
namespace {

// A torus of triangles with 1.6 times as many points across as around, numbered at random; bent
// like a thin shell: L M⁻¹ L with springs to the rest shape, or smoothed like a membrane: M + c L.
struct Torus {
  int across, around;

  explicit Torus(int points)
      : across(static_cast<int>(std::sqrt(1.6 * points))), around(points / across) {}
  int size() const { return across * around; }

  // Steps that have no common divisor with the size visit every number once.
  int node(int i, int j) const {
    const auto n = static_cast<long>(size());
    long step = 7919;
    while (std::gcd(step, n) != 1) ++step;
    return static_cast<int>(step * ((i % across) * around + j % around) % n);
  }
  SparseMatrix laplacian() const {
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < across; ++i)
      for (int j = 0; j < around; ++j)
        for (const int to : {node(i + 1, j), node(i, j + 1), node(i + 1, j + 1)}) {
          const double weight = 1 + 0.5 * std::sin(0.3 * i) * std::cos(0.7 * j);
          for (const auto& [a, b] : {std::pair(node(i, j), to), std::pair(to, node(i, j))}) {
            entries.emplace_back(a, b, -weight);
            entries.emplace_back(a, a, weight);
          }
        }
    SparseMatrix l(size(), size());
    l.setFromTriplets(entries.begin(), entries.end());
    return l;
  }
  SparseMatrix identity() const {
    SparseMatrix i(size(), size());
    i.setIdentity();
    return i;
  }
  SparseMatrix shell() const {
    const SparseMatrix l = laplacian();
    return SparseMatrix(l * l) + 0.1 * identity();
  }
  SparseMatrix membrane() const { return identity() + 4.0 * laplacian(); }
};

void factorizeShell(benchmark::State& state) {
  const ThreadLimit limit(static_cast<int>(state.range(1)));
  const SparseMatrix a = Torus(static_cast<int>(state.range(0))).shell();
  SupernodalCholesky factor;
  for (auto _ : state) benchmark::DoNotOptimize(factor.factorize(a));
  state.counters["entries"] = static_cast<double>(factor.nonZeros());
}
BENCHMARK(factorizeShell)
    ->ArgsProduct({{2000, 14000, 35000}, {1, 2}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void factorizeShellWithEigen(benchmark::State& state) {
  const SparseMatrix a = Torus(static_cast<int>(state.range(0))).shell();
  Eigen::SimplicialLLT<SparseMatrix> factor;
  for (auto _ : state) factor.compute(a);
}
BENCHMARK(factorizeShellWithEigen)->Arg(2000)->Arg(14000)->Unit(benchmark::kMillisecond);

void solveThree(benchmark::State& state, const SparseMatrix& a) {
  const ThreadLimit limit(static_cast<int>(state.range(1)));
  SupernodalCholesky factor;
  SupernodalCholesky::Scratch scratch;
  if (!factor.factorize(a)) return state.SkipWithError("not positive definite");
  const std::vector<float> b(factor.size(), 1);
  std::vector<float> x, y, z;
  for (auto _ : state) {
    x = b, y = b, z = b;
    factor.solve(x, y, z, scratch);
    benchmark::DoNotOptimize(x.data());
  }
  state.counters["entries"] = static_cast<double>(factor.nonZeros());
}

void solveShell(benchmark::State& state) {
  solveThree(state, Torus(static_cast<int>(state.range(0))).shell());
}
BENCHMARK(solveShell)
    ->ArgsProduct({{2000, 14000, 35000}, {1, 2}})
    ->Unit(benchmark::kMicrosecond)
    ->UseRealTime();

void solveShellWithEigen(benchmark::State& state) {
  const SparseMatrix a = Torus(static_cast<int>(state.range(0))).shell();
  const Eigen::SimplicialLLT<SparseMatrix> factor(a);
  const Eigen::MatrixXd b = Eigen::MatrixXd::Ones(a.rows(), 3);
  Eigen::MatrixXd x;
  for (auto _ : state) {
    x = factor.solve(b);
    benchmark::DoNotOptimize(x.data());
  }
}
BENCHMARK(solveShellWithEigen)->Arg(2000)->Arg(14000)->Unit(benchmark::kMicrosecond);

void solveMembrane(benchmark::State& state) {
  const ThreadLimit limit(1);
  SupernodalCholesky factor;
  SupernodalCholesky::Scratch scratch;
  if (!factor.factorize(Torus(static_cast<int>(state.range(0))).membrane()))
    return state.SkipWithError("not positive definite");
  const std::vector<float> b(factor.size(), 1);
  std::vector<float> x;
  for (auto _ : state) {
    x = b;
    factor.solve(x, scratch);
    benchmark::DoNotOptimize(x.data());
  }
}
BENCHMARK(solveMembrane)->Arg(2000)->Arg(14000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace fascia
