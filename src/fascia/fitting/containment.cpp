#include <fascia/fitting/containment.h>

#include <algorithm>
#include <cmath>

namespace fascia {
namespace {

constexpr int kDetail = 20;  // of the tessellation that is tested
constexpr int kMostRounds = 24;
constexpr double kLeastLeft = 0.45;  // of the fitted size; a thinner rest is no flesh of that part
constexpr int kMostRefits = 4;
constexpr double kViolationWeight = 4;  // of a point in the way, over that of all the skin to reach

Box worldBounds(const FittedSolid& solid, double margin_m) {
  const Box local = solid.solid().bounds();
  const Vec3 reach = solid.world.rotation.cwiseAbs() * (0.5 * local.size());
  const Vec3 centre = solid.world.point(local.center()), margin = Vec3::Constant(margin_m);
  return {centre - reach - margin, centre + reach + margin};
}

bool contains(const Box& box, const Vec3& p) {
  return (p.array() >= box.low.array()).all() && (p.array() <= box.high.array()).all();
}

// How deep skin and solid pass through each other or come nearer than the margin, and the skin
// points where they do.
struct Clash {
  double lack_m = 0;
  std::vector<Vec3> skin;
};

void addSkinWithin(const RestSurface& surface, const FittedSolid& solid, double margin_m,
                   Clash& clash) {
  const Box box = worldBounds(solid, margin_m);
  std::vector<Vec3> near;
  for (const SurfaceSample& s : surface.samples()) {
    if (contains(box, s.position_m)) near.push_back(s.position_m);
  }
  for (const Vec3& corner : surface.corners()) {
    if (contains(box, corner)) near.push_back(corner);
  }
  std::vector<double> d;
  distances(solid, near, d);
  for (std::size_t i = 0; i < d.size(); ++i) {
    if (d[i] >= margin_m) continue;
    clash.lack_m = std::max(clash.lack_m, margin_m - d[i]);
    clash.skin.push_back(near[i]);
  }
}

void addEmerging(const RestSurface& surface, const FittedSolid& solid, double margin_m,
                 Clash& clash) {
  for (const Eigen::Vector3f& local : solid.solid().tessellate(kDetail).positions) {
    const Vec3 p = solid.world.point(local.cast<double>());
    const RestSurface::Nearest nearest = surface.nearest(p);
    if (nearest.distance_m <= 0 || surface.inside(p)) continue;
    clash.lack_m = std::max(clash.lack_m, nearest.distance_m + margin_m);
    clash.skin.push_back(nearest.position_m);
  }
}

Clash findClash(const RestSurface& surface, const MirrorPlane* plane, double margin_m,
                const FittedSolid& solid) {
  Clash clash;
  addSkinWithin(surface, solid, margin_m, clash);
  addEmerging(surface, solid, margin_m, clash);
  if (!plane) return clash;
  Clash image;
  addSkinWithin(surface, solid.mirrored(*plane), margin_m, image);
  addEmerging(surface, solid.mirrored(*plane), margin_m, image);
  clash.lack_m = std::max(clash.lack_m, image.lack_m);
  for (const Vec3& p : image.skin) clash.skin.push_back(plane->point(p));
  return clash;
}

}  // namespace

double deepestOutside_m(const RestSurface& surface, const FittedSolid& solid) {
  return findClash(surface, nullptr, 0, solid).lack_m;
}

bool shrinkInside(const RestSurface& surface, const MirrorPlane* plane, double margin_m,
                  FittedSolid& solid) {
  const Vec3 least = kLeastLeft * solid.half_m;
  for (int round = 0; round < kMostRounds; ++round) {
    const double lack_m = findClash(surface, plane, margin_m, solid).lack_m;
    if (lack_m <= 0) return true;
    solid.half_m -= Vec3::Constant(std::max(0.8 * lack_m, 0.1 * margin_m));
    if ((solid.half_m.array() < least.array()).any() || solid.half_m.minCoeff() < 2e-4)
      return false;
  }
  return false;
}

bool fitInside(const RestSurface& surface, const MirrorPlane* plane, double margin_m,
               SolidTarget target, FittedSolid& solid) {
  constexpr std::size_t kMostAdded = 200;
  FittedSolid guess = solid;
  for (int refit = 0; refit <= kMostRefits; ++refit) {
    solid = fitSolid(target, guess, solid);
    const Clash clash = findClash(surface, plane, margin_m, solid);
    if (clash.skin.empty()) return true;
    const std::size_t step = clash.skin.size() / kMostAdded + 1;
    const std::size_t added = (clash.skin.size() + step - 1) / step;
    const double count = static_cast<double>(added);
    for (std::size_t i = 0; i < clash.skin.size(); i += step)
      target.bounds.push_back(
          {clash.skin[i], 2 * margin_m, kViolationWeight * std::max(1.0, 8 / count)});
  }
  return shrinkInside(surface, plane, margin_m, solid);
}

}  // namespace fascia
