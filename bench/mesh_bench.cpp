#include <benchmark/benchmark.h>

#include <cmath>

#include <fascia/base/parallel.h>
#include <fascia/skin/mesh/mesh_kernels.h>
#include <fascia/skin/point/leapfrog.h>

namespace fascia {
namespace {

// A triangulated torus of `tiles` x `tiles` patches of 8 x 8 points, numbered patch by patch as the
// skin builder's blocks are, with tissue to its own rest shape and flesh well within.
class Torus {
 public:
  explicit Torus(int tiles, double bending_Nm) : side_(8 * tiles) {
    const auto count = static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_);
    const std::size_t storage = count + 16;
    VectorArray rest(storage);
    for (int j = 0; j < side_; ++j) {
      for (int i = 0; i < side_; ++i) {
        const double a = 2 * kPi * i / side_, b = 2 * kPi * j / side_;
        const std::size_t k = point(i, j);
        rest.x[k] = static_cast<float>((1 + 0.4 * std::cos(b)) * std::cos(a));
        rest.y[k] = static_cast<float>(0.4 * std::sin(b));
        rest.z[k] = static_cast<float>((1 + 0.4 * std::cos(b)) * std::sin(a));
      }
    }
    TriangleMaterial material;
    for (FloatArray* a : {&material.stretch_u, &material.stretch_v}) a->assign(storage, 150.f);
    material.shear.assign(storage, 60.f);
    material.prestretch.assign(storage, 1.08f);
    if (bending_Nm > 0) material.bending.assign(storage, static_cast<float>(bending_Nm));
    membrane_ = TriangleMembrane(triangles(), rest, material);
    setPoints(rest, count);
    stepper_ = MeshStepper(membrane_);
    position_ = rest;
    velocity_.resize(storage);
  }

  void step(int count) {
    const StepInputs inputs{&points_, &step_, &around_, nullptr, {0, -9.81f, 0}};
    stepper_.run(inputs, 0, count, position_, velocity_);
  }
  double pointCount() const { return static_cast<double>(side_) * side_; }

 private:
  std::uint32_t point(int i, int j) const {
    const int x = i % side_, y = j % side_;
    return static_cast<std::uint32_t>((y / 8 * (side_ / 8) + x / 8) * 64 + y % 8 * 8 + x % 8);
  }
  std::vector<TriangleMembrane::Corners> triangles() const {
    std::vector<TriangleMembrane::Corners> out;
    for (int j = 0; j < side_; ++j) {
      for (int i = 0; i < side_; ++i) {
        out.push_back({point(i, j), point(i, j + 1), point(i + 1, j)});
        out.push_back({point(i + 1, j), point(i, j + 1), point(i + 1, j + 1)});
      }
    }
    return out;
  }
  void setPoints(const VectorArray& rest, std::size_t count) {
    const std::size_t storage = rest.size();
    for (FloatArray* a : {&points_.mass, &points_.drag, &points_.fat, &points_.tissueStiffness,
                          &points_.tissueDamping, &points_.tissueRestLength, &points_.free})
      a->assign(storage, 0.f);
    points_.stiffnessBound = membrane_.stiffnessBound();
    for (std::size_t k = 0; k < count; ++k) {
      const float area = membrane_.pointAreas()[k];
      points_.mass[k] = 4 * area, points_.drag[k] = 4 * area, points_.free[k] = 1;
      points_.tissueStiffness[k] = 4000 * area, points_.tissueDamping[k] = 60 * area;
    }
    around_.resize(storage);
    around_.anchor = rest;
    prepareStep(points_, {}, 1.0 / 480, step_);
  }

  int side_;
  TriangleMembrane membrane_;
  PointModel points_;
  PointSurroundings around_;
  StepCoefficients step_;
  MeshStepper stepper_;
  VectorArray position_, velocity_;
};

void run(benchmark::State& state, double bending_Nm) {
  constexpr int kSteps = 16;
  const ThreadLimit limit(static_cast<int>(state.range(1)));
  Torus torus(static_cast<int>(state.range(0)), bending_Nm);
  for (auto _ : state) {
    torus.step(kSteps);
    benchmark::ClobberMemory();
  }
  using benchmark::Counter;
  const double points = static_cast<double>(state.iterations()) * kSteps * torus.pointCount();
  state.counters["s_per_point"] = Counter(points, Counter::kIsRate | Counter::kInvert);
  state.counters["points"] = torus.pointCount();
}

void meshSteps(benchmark::State& state) {
  run(state, 0);
}
BENCHMARK(meshSteps)->ArgsProduct({{4, 9, 12, 22}, {1, 2}})->UseRealTime();

void meshStepsThatBend(benchmark::State& state) {
  run(state, 0.05);
}
BENCHMARK(meshStepsThatBend)->Args({9, 1})->UseRealTime();

}  // namespace
}  // namespace fascia
