#include "compare/places.h"

#include <algorithm>
#include <cmath>

#include <fascia/geometry/triangle_hierarchy.h>

namespace fascia {
namespace {

using Points = std::vector<Eigen::Vector3f>;

// Of the figure's size (the diagonal of its box).
constexpr double kClusterRadius = 0.04;  // larger: neighbouring joints melt into one place
constexpr double kSeenRadius = 0.055;    // larger: the fault is small in its picture
constexpr double kLeastApart = 2.0;      // of kSeenRadius, so that no two pictures show the same
constexpr double kLeastShare = 0.12;     // of the worst place's badness: less is not worth a look
constexpr std::size_t kMostTriangles = 3000;  // that are looked at; the worst ones
constexpr std::size_t kMostRays = 80;         // per place, side and direction
constexpr double kOffTheSkin = 1e-4;          // of the figure's size: where rays start
constexpr int kAzimuths = 12;
constexpr double kElevations_deg[] = {4, 22, 45};

Vec3 centroid(const RiggedModel& model, const Points& points, std::uint32_t triangle) {
  const auto& t = model.triangles[triangle];
  return ((points[t[0]] + points[t[1]] + points[t[2]]) / 3).cast<double>();
}

struct Spot {
  std::uint32_t triangle;
  double weight;
  Vec3 at_m;
};

std::vector<Spot> spotsOf(const RiggedModel& model, const Moment& moment,
                          const Both<Points>& points) {
  std::vector<Spot> spots;
  for (std::uint32_t t = 0; t < moment.weights.size(); ++t) {
    if (!(moment.weights[t] > 0)) continue;
    const Vec3 at_m = 0.5 * (centroid(model, points.plain, t) + centroid(model, points.ours, t));
    if (at_m.allFinite()) spots.push_back({t, moment.weights[t], at_m});
  }
  std::stable_sort(spots.begin(), spots.end(),
                   [](const Spot& a, const Spot& b) { return a.weight > b.weight; });
  if (spots.size() > kMostTriangles) spots.resize(kMostTriangles);
  return spots;
}

// Weight near a point, less with distance: (1 − (r/R)²)².
double density(std::span<const Spot> spots, const Vec3& at_m, double radius_m) {
  double sum = 0;
  for (const Spot& spot : spots) {
    const double s = 1 - (spot.at_m - at_m).squaredNorm() / (radius_m * radius_m);
    if (s > 0) sum += spot.weight * s * s;
  }
  return sum;
}

Place placeAt(std::span<const Spot> spots, const Vec3& at_m, double radius_m) {
  Place place;
  double sum = 0;
  for (const Spot& spot : spots) {
    const double s = 1 - (spot.at_m - at_m).squaredNorm() / (radius_m * radius_m);
    if (s <= 0) continue;
    place.parts.push_back({spot.triangle, spot.weight * s * s});
    sum += place.parts.back().weight;
  }
  for (Place::Part& part : place.parts) part.weight /= sum;
  return place;
}

Vec3 direction(double azimuth_rad, double elevation_rad) {
  return {std::cos(elevation_rad) * std::sin(azimuth_rad), std::sin(elevation_rad),
          std::cos(elevation_rad) * std::cos(azimuth_rad)};
}

// How much of places is seen from afar.
class Onlooker {
 public:
  Onlooker(const RiggedModel& model, const Both<Points>& points)
      : model_(model), offTheSkin_m_(kOffTheSkin * model.size_m()) {
    for (const Side side : kSides) {
      meshes_[side].positions = points[side];
      meshes_[side].triangles = model.triangles;
      trees_[side] = std::make_unique<TriangleHierarchy>(meshes_[side]);
    }
  }

  // [0, 1]: all of it, facing the onlooker.
  double seen(const Place& place, const Vec3& towards) const {
    double sum = 0;
    std::size_t rays = 0;
    for (const Place::Part& part : place.parts) {
      if (++rays > kMostRays) break;
      for (const Side side : kSides) sum += 0.5 * part.weight * seen(side, part.triangle, towards);
    }
    return sum;
  }

 private:
  double seen(Side side, std::uint32_t triangle, const Vec3& towards) const {
    const Points& p = meshes_[side].positions;
    const auto& t = model_.triangles[triangle];
    const Vec3 normal = (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).cast<double>().normalized();
    const double facing = normal.dot(towards);
    if (!(std::abs(facing) > 0)) return 0;
    const Vec3 from = centroid(model_, p, triangle) + offTheSkin_m_ * towards;
    return trees_[side]->firstHit(from, towards) ? 0 : std::abs(facing);
  }

  const RiggedModel& model_;
  double offTheSkin_m_;
  Both<TriangleMesh> meshes_;
  Both<std::unique_ptr<TriangleHierarchy>> trees_;
};

}  // namespace

Vec3 Place::middle(const RiggedModel& model, const Both<Points>& points) const {
  Vec3 sum = Vec3::Zero();
  for (const Part& part : parts)
    for (const Side side : kSides)
      sum += 0.5 * part.weight * centroid(model, points[side], part.triangle);
  return sum;
}

std::vector<Place> findPlaces(const RiggedModel& model, const Moment& moment,
                              const Both<Points>& points, std::size_t most) {
  const double size_m = model.size_m();
  std::vector<Spot> spots = spotsOf(model, moment, points);
  std::vector<Place> places;
  double worst = 0;
  while (places.size() < most && !spots.empty()) {
    double thickest = 0;
    Vec3 there = Vec3::Zero();
    for (const Spot& spot : spots) {
      const double here = density(spots, spot.at_m, kClusterRadius * size_m);
      if (here > thickest) thickest = here, there = spot.at_m;
    }
    worst = std::max(worst, thickest);
    if (!(thickest > kLeastShare * worst)) break;
    places.push_back(placeAt(spots, there, kClusterRadius * size_m));
    places.back().radius_m = kSeenRadius * size_m;
    std::erase_if(spots, [&](const Spot& spot) {
      return (spot.at_m - there).norm() < kLeastApart * kSeenRadius * size_m;
    });
  }
  return places;
}

void chooseViews(const RiggedModel& model, const Both<Points>& points, const Vec3& preferred,
                 std::vector<Place>& places) {
  const Onlooker onlooker(model, points);
  for (Place& place : places) {
    double best = -1;
    for (int a = 0; a < kAzimuths; ++a)
      for (const double elevation_deg : kElevations_deg) {
        const Vec3 towards = direction(2 * kPi * a / kAzimuths, radians(elevation_deg));
        // What is seen from the other side is hard to find again on the whole figure.
        const double kindred = 0.55 + 0.45 * towards.dot(preferred);
        const double here = (1e-3 + onlooker.seen(place, towards)) * kindred;
        if (here > best) best = here, place.towards = towards;
      }
  }
}

std::size_t chooseView(const RiggedModel& model, const Both<Points>& points,
                       std::span<const Place> places, std::span<const Vec3> directions) {
  const Onlooker onlooker(model, points);
  std::size_t choice = 0;
  double best = -1;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    double here = 0;
    for (const Place& place : places) here += onlooker.seen(place, directions[i]);
    if (here > 1.15 * best) best = here, choice = i;
  }
  return choice;
}

}  // namespace fascia
