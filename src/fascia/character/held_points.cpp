#include <cmath>

#include <fascia/character/soft_flesh.h>

namespace fascia {
namespace {

// How far out the end is that is held, as a part of the way from the solid's middle to its end; and
// how far out the points are there, as a part of the way to the surface. Farther out would hold the
// whole end stiff, less would hold it at one spot.
constexpr double kEndShare = 0.5, kRimShare = 0.7;
constexpr int kBisections = 40;

double distanceAt(const Solid& solid, const Vec3& p) {
  const Eigen::Vector3f x = p.cast<float>();
  Eigen::Vector3f n;
  float d = 0;
  solid.evaluate({&x.x(), &x.y(), &x.z(), 1}, &d, {&n.x(), &n.y(), &n.z(), 1});
  return d;
}

// How far the surface is from a point inside, along a unit direction.
double wayOut_m(const Solid& solid, const Vec3& from, const Vec3& direction) {
  double inside_m = 0, outside_m = solid.bounds().size().norm();
  for (int i = 0; i < kBisections; ++i) {
    const double middle_m = 0.5 * (inside_m + outside_m);
    (distanceAt(solid, from + middle_m * direction) < 0 ? inside_m : outside_m) = middle_m;
  }
  return inside_m;
}

}  // namespace

std::vector<Vec3> usualHeldPoints(const Solid& solid, const Vec3& joint_solid, bool bends) {
  const Vec3 middle = solid.deformedFromShape(Vec3::Zero());
  const Vec3 toJoint = joint_solid - middle;
  const double size_m = solid.bounds().size().norm();
  const Vec3 axis =
      toJoint.norm() > 1e-3 * size_m ? Vec3(toJoint.normalized()) : Vec3(-Vec3::UnitZ());
  const Vec3 base = middle + kEndShare * wayOut_m(solid, middle, axis) * axis;
  const Vec3 across = axis.unitOrthogonal(), other = axis.cross(across);
  const int around = bends ? 5 : 3;
  std::vector<Vec3> points;
  for (int i = 0; i < around; ++i) {
    const double angle = 2 * kPi * i / around;
    const Vec3 direction = std::cos(angle) * across + std::sin(angle) * other;
    points.emplace_back(base + kRimShare * wayOut_m(solid, base, direction) * direction);
  }
  if (bends) points.push_back(base);
  return points;
}

}  // namespace fascia
