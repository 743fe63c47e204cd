#include <fascia/skin/surface/solid_union.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/math/points.h>

namespace fascia {
namespace {

// Of a fillet's radius. At a right angle f = 0 passes the corner at k ln 2 from both solids, a
// circle of radius r at (1 − 1/√2) r.
constexpr double kOfRadius = 0.42;
// Sharper than this nothing is: 1/k stays finite.
constexpr double kSharpest_m = 1e-6;

double sharpness(const SolidUnionOptions& options) {
  return std::max(kOfRadius * options.blend_m, kSharpest_m);
}

void evaluateUnion(const DistanceField& flesh, const SolidUnionOptions& options,
                   ConstVectors points, float* value, Vectors gradient) {
  const std::size_t count = points.count, solids = flesh.solidCount();
  std::vector<float> distance(count * solids), least(count, 3e38f);
  VectorArray normal(count * solids);
  for (std::size_t s = 0; s < solids; ++s) {
    float* own = distance.data() + s * count;
    flesh.evaluate(SolidId(static_cast<std::int64_t>(s)), points, own,
                   view(normal, s * count, count));
    for (std::size_t i = 0; i < count; ++i) least[i] = std::min(least[i], own[i]);
  }
  const double k = sharpness(options);
  for (std::size_t i = 0; i < count; ++i) {
    double sum = 0;
    Vec3 slope = Vec3::Zero();
    for (std::size_t s = 0; s < solids; ++s) {
      const double share = std::exp(double{least[i] - distance[s * count + i]} / k);
      sum += share;
      slope += share * pointAt(normal, s * count + i);
    }
    value[i] = static_cast<float>(double{least[i]} - k * std::log(sum) - options.fat_m);
    slope /= sum;
    gradient.x[i] = static_cast<float>(slope.x());
    gradient.y[i] = static_cast<float>(slope.y());
    gradient.z[i] = static_cast<float>(slope.z());
  }
}

}  // namespace

ImplicitSurface unionOfSolids(const DistanceField& flesh, const SolidUnionOptions& options) {
  FASCIA_ASSERT(flesh.solidCount() > 0, "there is something to lie around");
  ImplicitSurface surface;
  for (std::size_t s = 0; s < flesh.solidCount(); ++s) {
    const SolidId id(static_cast<std::int64_t>(s));
    surface.bounds_m.add(flesh.bounds(id));
    surface.lipschitz = std::max(surface.lipschitz, flesh.lipschitz(id));
  }
  // Many solids at one place swell the most. Estimates grow slower than ways: twice is room enough.
  const double room =
      2 * (options.fat_m + sharpness(options) * std::log(1.0 + double(flesh.solidCount()))) +
      0.02 * surface.bounds_m.size().norm();
  surface.bounds_m.low -= Vec3::Constant(room);
  surface.bounds_m.high += Vec3::Constant(room);
  surface.evaluate = [&flesh, options](ConstVectors points, float* value, Vectors gradient) {
    evaluateUnion(flesh, options, points, value, gradient);
  };
  return surface;
}

}  // namespace fascia
