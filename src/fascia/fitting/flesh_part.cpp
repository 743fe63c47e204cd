#include <fascia/fitting/flesh_part.h>

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace fascia {
namespace {

constexpr double kLeastRoom = 1.5;    // local radius over the least fat, for flesh to fit beneath
constexpr double kLeastBlend = 0.05;  // weight from which a neighbour's skin counts as shared
constexpr std::size_t kMostReach = 500, kMostBounds = 600;
constexpr double kBoundWeight = 40;  // of all near skin together; that to be reached weighs 1

template <class T>
double quantile(std::vector<T> values, double share) {
  if (values.empty()) return 0;
  const std::ptrdiff_t rank = std::lround(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

SurfaceSample image(SurfaceSample sample, const MirrorPlane& plane) {
  sample.position_m = plane.point(sample.position_m);
  sample.normal = plane.direction(sample.normal);
  return sample;
}

struct Collector {
  FleshPart& part;
  double leastRadius_m;
  Box box;
  double usable_m2 = 0;

  void collect(const SurfaceSample& s, std::size_t joint) {
    const bool room = s.radius_m >= leastRadius_m;
    if (s.joint[0] == joint && s.weight[0] > 0) {
      part.area_m2 += s.area_m2;
      usable_m2 += room ? s.area_m2 : 0;
      if (room) part.own.push_back(s);
    } else if (s.weightOf(joint) >= kLeastBlend && room) {
      part.blend.push_back(s);
    } else {
      return;
    }
    box.add(s.position_m);
  }
};

void addNear(const RestSurface& surface, const MirrorPlane* plane, Box box, FleshPart& part) {
  const Vec3 margin = Vec3::Constant(part.radius_m);
  box.low -= margin;
  box.high += margin;
  const auto offer = [&](const Vec3& p) {
    if ((p.array() >= box.low.array()).all() && (p.array() <= box.high.array()).all())
      part.near.push_back(p);
  };
  for (const SurfaceSample& s : surface.samples()) {
    offer(s.position_m);
    if (plane) offer(plane->point(s.position_m));
  }
}

// Directions across the axis in which the part is widest and narrowest.
Vec3 widestAcross(const FleshPart& part, const Vec3& centre) {
  Mat3 moment = Mat3::Zero();
  for (const SurfaceSample& s : part.own) {
    Vec3 d = s.position_m - centre;
    d -= d.dot(part.axis) * part.axis;
    moment += s.area_m2 * d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(moment);
  Vec3 widest = solver.eigenvectors().col(2);
  widest -= widest.dot(part.axis) * part.axis;
  return widest.norm() > 1e-6 ? Vec3(widest.normalized()) : part.axis.unitOrthogonal();
}

// Mean of the points half way through the body: on the axis even if the part is only a patch of it.
Vec3 middleOf(const FleshPart& part) {
  Vec3 sum = Vec3::Zero();
  double area_m2 = 0;
  for (const SurfaceSample& s : part.own) {
    sum += s.area_m2 * (s.position_m - s.radius_m * s.normal);
    area_m2 += s.area_m2;
  }
  return area_m2 > 0 ? Vec3(sum / area_m2) : sum;
}

// Size, extent and directions of what `own` holds.
void measureShape(const Symmetry& symmetry, const Vec3& origin, FleshPart& part) {
  std::vector<double> radii, along;
  for (const SurfaceSample& s : part.own) {
    radii.push_back(s.radius_m);
    along.push_back(part.axis.dot(s.position_m - origin));
  }
  part.radius_m = quantile(radii, 0.5);
  part.low_m = quantile(along, 0.03);
  part.high_m = quantile(along, 0.97);
  part.middle_m = middleOf(part);
  if (part.central)
    part.middle_m -= symmetry.plane.distance_m(part.middle_m) * symmetry.plane.normal();
  part.across = part.central ? symmetry.plane.normal()
                             : Vec3(part.axis.cross(widestAcross(part, part.middle_m)));
}

}  // namespace

FleshPart findFleshPart(const RestSurface& surface, const Symmetry& symmetry,
                        const BoneFrame& frame, std::size_t joint) {
  FleshPart part;
  part.joint = joint;
  part.central = symmetry.central(joint);
  part.paired = symmetry.paired(joint);
  part.axis = frame.world.rotation.col(1);
  Collector collector{part, kLeastRoom * surface.leastFat_m(), {}, 0};
  for (const SurfaceSample& s : surface.samples()) {
    collector.collect(s, joint);
    if (part.central || part.paired)
      collector.collect(image(s, symmetry.plane),
                        static_cast<std::size_t>(symmetry.partner[joint]));
  }
  if (part.own.empty()) return part;
  part.usable = collector.usable_m2 / part.area_m2;
  measureShape(symmetry, frame.world.translation_m, part);
  const bool doubled = part.central || part.paired;
  if (doubled) part.area_m2 *= 0.5;
  addNear(surface, doubled ? &symmetry.plane : nullptr, collector.box, part);
  return part;
}

FleshPart subPart(const Symmetry& symmetry, const BoneFrame& frame, const FleshPart& whole,
                  std::vector<SurfaceSample> own, bool central) {
  FleshPart part = whole;
  part.central = central;
  part.own = std::move(own);
  part.blend.clear();
  measureShape(symmetry, frame.world.translation_m, part);
  return part;
}

SolidTarget surfaceTarget(const RestSurface& surface, const FleshPart& part) {
  SolidTarget target;
  target.size_m = part.radius_m;
  target.symmetric = part.central;
  const std::size_t step = (part.own.size() + part.blend.size()) / kMostReach + 1;
  for (std::size_t i = 0; i < part.own.size(); i += step) {
    const SurfaceSample& s = part.own[i];
    target.reach.push_back({s.position_m, s.fat_m, s.area_m2});
  }
  for (std::size_t i = 0; i < part.blend.size(); i += step) {
    const SurfaceSample& s = part.blend[i];
    target.reach.push_back({s.position_m, s.fat_m, s.area_m2 * s.weightOf(part.joint)});
  }
  const std::size_t boundStep = part.near.size() / kMostBounds + 1;
  const double weight =
      kBoundWeight * static_cast<double>(boundStep) / static_cast<double>(part.near.size() + 1);
  for (std::size_t i = 0; i < part.near.size(); i += boundStep)
    target.bounds.push_back({part.near[i], surface.leastFat_m(), weight});
  return target;
}

double depth_m(const RestSurface& surface, const Vec3& p) {
  if (!surface.inside(p)) return 0;
  const double deep_m = -surface.signedDistance(p);
  return std::max(0.0, deep_m - surface.fat_m(deep_m));
}

SolidTarget wholeTarget(const RestSurface& surface, const FleshPart& part, const BoneFrame& frame) {
  SolidTarget target = surfaceTarget(surface, part);
  for (const Vec3& pin : {frame.world.translation_m, frame.end_m}) {
    const double wanted_m = 0.5 * depth_m(surface, pin);
    if (wanted_m > 0) target.pins.push_back({pin, std::min(wanted_m, part.radius_m), 1});
  }
  return target;
}

FittedSolid wholeGuess(const RestSurface& surface, const FleshPart& part, const BoneFrame& frame) {
  FittedSolid guess;
  const Vec3 y = (part.across - part.across.dot(part.axis) * part.axis).normalized();
  const Vec3 x = y.cross(part.axis);
  guess.world.rotation << x, y, part.axis;
  // The middle of the part along the axis, the middle of its section across.
  const Vec3& centre = part.middle_m;
  const double middle_m = 0.5 * (part.low_m + part.high_m);
  const double now_m = part.axis.dot(centre - frame.world.translation_m);
  guess.world.translation_m = centre + (middle_m - now_m) * part.axis;
  Vec3 square = Vec3::Zero();
  double area_m2 = 0;
  for (const SurfaceSample& s : part.own) {
    const Vec3 d = guess.world.rotation.transpose() * (s.position_m - centre);
    square += s.area_m2 * d.cwiseAbs2();
    area_m2 += s.area_m2;
  }
  const double fat_m = surface.fat_m(part.radius_m), least_m = 0.25 * part.radius_m;
  // A tube's mean square across is half the square of its radius.
  guess.half_m = {std::sqrt(2 * square.x() / area_m2) - fat_m,
                  std::sqrt(2 * square.y() / area_m2) - fat_m, 0.5 * (part.high_m - part.low_m)};
  guess.half_m = guess.half_m.cwiseMax(least_m);
  guess.half_m.z() = std::max(guess.half_m.z(), 0.7 * part.radius_m);
  guess.exponent_e1 = 0.8;
  guess.exponent_e2 = 0.9;
  return guess;
}

}  // namespace fascia
