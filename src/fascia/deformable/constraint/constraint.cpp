#include <fascia/deformable/constraint/constraint.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <fascia/base/error.h>

namespace fascia {
namespace {

class Attachment final : public Constraint {
 public:
  Attachment(std::string name, const BodyPoint& a, const BodyPoint& b)
      : Constraint(std::move(name)), points_{a, b} {}
  std::span<const BodyPoint> points() const override { return points_; }
  int rowCount(int dimension) const override { return dimension; }
  bool hasConstantJacobian() const override { return true; }
  void evaluate(double, std::span<const Vec3> x, std::span<const Vec3>,
                ConstraintRows& rows) const override {
    rows.value = x[0] - x[1];
    if (rows.jacobian.empty()) return;
    rows.jacobian[0] = Mat3::Identity();
    rows.jacobian[1] = -Mat3::Identity();
  }

 private:
  std::array<BodyPoint, 2> points_;
};

// A c of one point with the constant Jacobian `axes_`: c = axes (x − n(t)).
class GuidedPoint final : public Constraint {
 public:
  GuidedPoint(std::string name, const BodyPoint& point, std::vector<Vec3> axes, PointPath path)
      : Constraint(std::move(name)), point_{point}, path_(std::move(path)) {
    axes_.setZero();
    for (std::size_t i = 0; i < axes.size(); ++i) axes_.row(static_cast<int>(i)) = axes[i];
    axisCount_ = static_cast<int>(axes.size());
  }
  std::span<const BodyPoint> points() const override { return point_; }
  // The plane has one direction less to hold: a point and a line lose a row, a plane does not.
  int rowCount(int dimension) const override { return std::max(1, axisCount_ - (3 - dimension)); }
  bool hasConstantJacobian() const override { return true; }
  void evaluate(double t_s, std::span<const Vec3> x, std::span<const Vec3>,
                ConstraintRows& rows) const override {
    const PathPoint n = path_(t_s);
    rows.value = axes_ * (x[0] - n.position_m);
    rows.rate_m_per_s = -(axes_ * n.velocity_m_per_s);
    rows.acceleration_m_per_s2 = -(axes_ * n.acceleration_m_per_s2);
    if (!rows.jacobian.empty()) rows.jacobian[0] = axes_;
  }

 private:
  std::array<BodyPoint, 1> point_;
  PointPath path_;
  Mat3 axes_;
  int axisCount_ = 0;
};

Vec3 unit(const std::string& name, const char* what, const Vec3& v) {
  const double length = v.norm();
  if (length > 0 && std::isfinite(length)) return v / length;
  Issue issue{
      {}, "constraint '" + name + "': found a " + what + " without length, expected one", {}};
  throw Error(issue);
}

double checkedLength(const std::string& name, double length_m) {
  if (length_m > 0 && std::isfinite(length_m)) return length_m;
  Issue issue{{},
              "constraint '" + name + "': found the length " + std::to_string(length_m) +
                  " m, expected a positive number",
              {}};
  throw Error(issue);
}

// c = (d·d − l²)/(2 l) with d = x_a − x_b: zero where the length is l, and there with a gradient of
// unit length.
class Rod final : public Constraint {
 public:
  Rod(std::string name, std::vector<BodyPoint> points, const Vec3& place_m, double length_m)
      : Constraint(std::move(name)),
        points_(std::move(points)),
        place_m_(place_m),
        length_m_(length_m) {}
  std::span<const BodyPoint> points() const override { return points_; }
  int rowCount(int) const override { return 1; }
  bool hasConstantJacobian() const override { return false; }
  void evaluate(double, std::span<const Vec3> x, std::span<const Vec3> v,
                ConstraintRows& rows) const override {
    const bool both = points_.size() == 2;
    const Vec3 d = x[0] - (both ? x[1] : place_m_);
    const Vec3 rate = both ? Vec3(v[0] - v[1]) : v[0];
    rows.value[0] = (d.squaredNorm() - length_m_ * length_m_) / (2 * length_m_);
    rows.acceleration_m_per_s2[0] = rate.squaredNorm() / length_m_;
    if (rows.jacobian.empty()) return;
    rows.jacobian[0].row(0) = d / length_m_;
    if (both) rows.jacobian[1].row(0) = -d / length_m_;
  }

 private:
  std::vector<BodyPoint> points_;
  Vec3 place_m_;
  double length_m_;
};

}  // namespace

PointPath fixedAt(const Vec3& place_m) {
  return [place_m](double) { return PathPoint{.position_m = place_m}; };
}

ConstraintPtr makeAttachment(std::string name, const BodyPoint& a, const BodyPoint& b) {
  return std::make_shared<Attachment>(std::move(name), a, b);
}

ConstraintPtr makeNail(std::string name, const BodyPoint& point, const Vec3& place_m) {
  return makeTrajectory(std::move(name), point, fixedAt(place_m));
}

ConstraintPtr makeTrajectory(std::string name, const BodyPoint& point, PointPath path) {
  if (!path) throw Error("constraint '" + name + "': found no path, expected one");
  const std::vector<Vec3> axes{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  return std::make_shared<GuidedPoint>(std::move(name), point, axes, std::move(path));
}

ConstraintPtr makePointOnLine(std::string name, const BodyPoint& point, const Vec3& place_m,
                              const Vec3& direction) {
  const Vec3 along = unit(name, "direction", direction);
  // In the plane the first normal is the one that lies in it.
  const Vec3 flat(-along.y(), along.x(), 0);
  const Vec3 first = flat.norm() > 0.5 ? flat.normalized() : along.unitOrthogonal();
  const std::vector<Vec3> axes{first, along.cross(first)};
  return std::make_shared<GuidedPoint>(std::move(name), point, axes, fixedAt(place_m));
}

ConstraintPtr makePointOnPlane(std::string name, const BodyPoint& point, const Vec3& place_m,
                               const Vec3& normal) {
  const std::vector<Vec3> axes{unit(name, "normal", normal)};
  return std::make_shared<GuidedPoint>(std::move(name), point, axes, fixedAt(place_m));
}

ConstraintPtr makeRod(std::string name, const BodyPoint& a, const BodyPoint& b, double length_m) {
  length_m = checkedLength(name, length_m);
  return std::make_shared<Rod>(std::move(name), std::vector{a, b}, Vec3::Zero(), length_m);
}

ConstraintPtr makeTether(std::string name, const BodyPoint& point, const Vec3& place_m,
                         double length_m) {
  length_m = checkedLength(name, length_m);
  return std::make_shared<Rod>(std::move(name), std::vector{point}, place_m, length_m);
}

}  // namespace fascia
