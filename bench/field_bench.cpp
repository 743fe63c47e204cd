#include <benchmark/benchmark.h>

#include <string>

#include <fascia/base/random.h>
#include <fascia/field/solid.h>

namespace fascia {
namespace {

// Points around the surface of a solid of half size 0.1 m, as the skin asks for them.
VectorArray pointsNear(std::size_t count) {
  Random random(7);
  VectorArray points(count);
  for (std::size_t i = 0; i < count; ++i) {
    points.x[i] = static_cast<float>(random.uniform(-0.12, 0.12));
    points.y[i] = static_cast<float>(random.uniform(-0.12, 0.12));
    points.z[i] = static_cast<float>(random.uniform(-0.12, 0.12));
  }
  return points;
}

void evaluateSolid(benchmark::State& state, const SolidDef& def) {
  Diagnostics diagnostics;
  const Solid solid(def, "", diagnostics);
  diagnostics.throwIfErrors();
  const auto count = static_cast<std::size_t>(state.range(0));
  const VectorArray points = pointsNear(count);
  VectorArray normals(count);
  FloatArray distance_m(count);
  const Transform world{Eigen::AngleAxisd(0.3, Vec3::UnitY()).toRotationMatrix(), Vec3(0.01, 0, 0)};
  for (auto _ : state) {
    evaluatePosed(solid, world, view(points, 0, count), distance_m.data(), view(normals, 0, count));
    benchmark::ClobberMemory();
  }
  using benchmark::Counter;
  const auto evaluated = static_cast<double>(state.iterations()) * static_cast<double>(count);
  state.counters["s_per_point"] = Counter(evaluated, Counter::kIsRate | Counter::kInvert);
}

const SolidDef kEllipsoid{"superellipsoid", {0.1, 0.08, 0.15}, {}};
const SolidDef kSuperellipsoid{"superellipsoid", {0.1, 0.08, 0.15, 0.5, 0.8}, {}};

BENCHMARK_CAPTURE(evaluateSolid, sphere, SolidDef{"sphere", {0.1}, {}})->Arg(16)->Arg(64);
BENCHMARK_CAPTURE(evaluateSolid, capsule, SolidDef{"capsule", {0.08, 0.1}, {}})->Arg(16)->Arg(64);
BENCHMARK_CAPTURE(evaluateSolid, ellipsoid, kEllipsoid)->Arg(16)->Arg(64);
BENCHMARK_CAPTURE(evaluateSolid, superellipsoid, kSuperellipsoid)->Arg(16)->Arg(64);
BENCHMARK_CAPTURE(evaluateSolid, taperedSphere, SolidDef{"sphere", {0.1}, {{"taper", {0.4}}}})
    ->Arg(64);
BENCHMARK_CAPTURE(evaluateSolid, twistedSphere, SolidDef{"sphere", {0.1}, {{"twist", {0.7}}}})
    ->Arg(64);
BENCHMARK_CAPTURE(evaluateSolid, bentSphere, SolidDef{"sphere", {0.1}, {{"bend", {0.9}}}})->Arg(64);

}  // namespace
}  // namespace fascia
