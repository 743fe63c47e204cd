#include <fascia/fitting/containment.h>

#include <algorithm>
#include <cmath>

#include <fascia/fitting/solid_fitting.h>

namespace fascia {
namespace {

constexpr int kDetail = 20;  // of the tessellation that is tested
constexpr int kMostRounds = 24;
constexpr double kLeastLeft = 0.45;  // of the first size; a thinner rest is no flesh of that part

Box worldBounds(const FittedSolid& solid, double margin_m) {
  const Box local = solid.solid().bounds();
  const Vec3 reach = solid.world.rotation.cwiseAbs() * (0.5 * local.size());
  const Vec3 centre = solid.world.point(local.center()), margin = Vec3::Constant(margin_m);
  return {centre - reach - margin, centre + reach + margin};
}

bool contains(const Box& box, const Vec3& p) {
  return (p.array() >= box.low.array()).all() && (p.array() <= box.high.array()).all();
}

// The least distance of skin (samples and corners) to the solid; at most `margin_m`.
double skinClearance_m(const BodySurface& surface, const FittedSolid& solid, double margin_m) {
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
  double least = margin_m;
  for (const double one : d) least = std::min(least, one);
  return least;
}

// How far the solid's surface is outside of the skin.
double emergence_m(const BodySurface& surface, const FittedSolid& solid) {
  double most = 0;
  for (const Eigen::Vector3f& local : solid.solid().tessellate(kDetail).positions) {
    const Vec3 p = solid.world.point(local.cast<double>());
    const double distance = surface.signedDistance(p);
    if (distance > most && !surface.inside(p)) most = distance;
  }
  return most;
}

// By how much it lacks the margin.
double lack_m(const BodySurface& surface, const FittedSolid& solid, double margin_m) {
  const double emergence = emergence_m(surface, solid);
  const double close = margin_m - skinClearance_m(surface, solid, margin_m);
  return std::max(emergence > 0 ? emergence + margin_m : 0, close);
}

}  // namespace

double deepestOutside_m(const BodySurface& surface, const FittedSolid& solid) {
  return lack_m(surface, solid, 0);
}

bool shrinkInside(const BodySurface& surface, const MirrorPlane* plane, double margin_m,
                  FittedSolid& solid) {
  const Vec3 wanted = kLeastLeft * solid.half_m;
  for (int round = 0; round < kMostRounds; ++round) {
    double lack = lack_m(surface, solid, margin_m);
    if (plane) lack = std::max(lack, lack_m(surface, solid.mirrored(*plane), margin_m));
    if (lack <= 0) return true;
    solid.half_m -= Vec3::Constant(std::max(0.8 * lack, 0.1 * margin_m));
    if ((solid.half_m.array() < wanted.array()).any() || solid.half_m.minCoeff() < 2e-4)
      return false;
  }
  return false;
}

}  // namespace fascia
