#include <fascia/skin/point/attach.h>

#include <algorithm>

#include <fascia/base/parallel.h>
#include <fascia/math/points.h>
#include <fascia/skin/point/nearest_solids.h>

namespace fascia {
namespace {

constexpr double kTouch_m = 1e-4;
constexpr int kSteps = 64;

std::size_t pointsOf(std::span<const PointRun> runs) {
  return runs.empty() ? 0 : runs.back().number + runs.back().count;
}

// One point on its way along its normal.
struct March {
  std::size_t point;  // of the run
  Vec3 from_m, inward;
  double reach_m = 0, gone_m = 0;

  Vec3 at() const { return from_m + gone_m * inward; }
};

void attachRun(const DistanceField& field, ConstVectors points, ConstVectors normals, double fat_m,
               Attachment* out) {
  NearestSolids flesh(field, kTouch_m);
  VectorArray at(NearestSolids::kBlock);
  std::vector<March> marching(points.count);
  flesh.measure(points);
  for (std::size_t i = 0; i < points.count; ++i) {
    const Vec3 from = pointAt(points, i);
    const double gap = flesh.distance_m(i);
    // A strand much longer than the shortest one would cross the body.
    marching[i] = {i, from, -pointAt(normals, i), 4 * std::max(gap, kTouch_m) + fat_m};
    out[i] = {flesh.solid(i), from - gap * pointAt(flesh.normals(), i)};
  }
  for (int step = 0; step < kSteps && !marching.empty(); ++step) {
    for (std::size_t m = 0; m < marching.size(); ++m) setPoint(at, m, marching[m].at());
    flesh.measure(view(static_cast<const VectorArray&>(at), 0, marching.size()));
    std::size_t left = 0;
    for (std::size_t m = 0; m < marching.size(); ++m) {
      March march = marching[m];
      const double gap = flesh.distance_m(m);
      if (gap < kTouch_m) {
        out[march.point] = {flesh.solid(m), march.at() - gap * pointAt(flesh.normals(), m)};
        continue;
      }
      march.gone_m += gap;
      if (march.gone_m <= march.reach_m) marching[left++] = march;
    }
    marching.resize(left);
  }
}

}  // namespace

std::vector<Attachment> attachAlongNormals(const DistanceField& field,
                                           std::span<const PointRun> runs,
                                           const VectorArray& points_m, const VectorArray& normals,
                                           double fat_m) {
  std::vector<Attachment> attachments(pointsOf(runs));
  parallelFor(runs.size(), [&](std::size_t n) {
    const PointRun& run = runs[n];
    attachRun(field, view(points_m, run.first, run.count), view(normals, run.first, run.count),
              fat_m, attachments.data() + run.number);
  });
  return attachments;
}

std::vector<SolidId> nearestSolids(const DistanceField& field, std::span<const PointRun> runs,
                                   const VectorArray& points_m) {
  std::vector<SolidId> nearest(pointsOf(runs));
  parallelFor(runs.size(), [&](std::size_t n) {
    const PointRun& run = runs[n];
    NearestSolids flesh(field, kTouch_m);
    flesh.measure(view(points_m, run.first, run.count));
    for (std::size_t i = 0; i < run.count; ++i) nearest[run.number + i] = flesh.solid(i);
  });
  return nearest;
}

}  // namespace fascia
