#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include <fascia/base/ids.h>
#include <fascia/math/types.h>

namespace fascia {

using BodyId = Id<struct BodyTag>;
using ConstraintId = Id<struct ConstraintTag>;

// A material point of a body, by its place in the undeformed body.
struct BodyPoint {
  BodyId body;
  Vec3 X_m = Vec3::Zero();
};

inline constexpr int kMaxConstraintPoints = 4;

// What a constraint c(x₁ … x_n, t) = 0 of n points says at one moment: up to three rows. Only the
// first rowCount() entries and the first two columns of a plane system are read. Zeros at first.
struct ConstraintRows {
  Vec3 value = Vec3::Zero();                  // c, m
  Vec3 rate_m_per_s = Vec3::Zero();           // ∂c/∂t
  Vec3 acceleration_m_per_s2 = Vec3::Zero();  // c̈ without its ∂c/∂x ẍ (Witkin & Welch 1990, eq. 6)
  // ∂c/∂x of each point, row by row of c; empty where nobody asks for it.
  std::span<Mat3> jacobian;
};

// A condition on points of bodies. The points are linear in the bodies' coordinates, so a
// constraint that is linear in its points has a constant Jacobian, and the matrix J W Jᵀ of a
// system of such is factored once (§3.3). Others work all the same, and cost a factorisation each
// time. evaluate() must not throw or allocate, and be smooth in x.
class Constraint {
 public:
  explicit Constraint(std::string name) : name_(std::move(name)) {}
  virtual ~Constraint() = default;

  const std::string& name() const { return name_; }       // for messages
  virtual std::span<const BodyPoint> points() const = 0;  // 1 to kMaxConstraintPoints
  virtual int rowCount(int dimension) const = 0;          // 1 to 3
  virtual bool hasConstantJacobian() const = 0;
  // x, v: place (m) and velocity (m/s) of each point. Writes what is not 0 to `rows`.
  virtual void evaluate(double t_s, std::span<const Vec3> x, std::span<const Vec3> v,
                        ConstraintRows& rows) const = 0;

 private:
  std::string name_;
};

using ConstraintPtr = std::shared_ptr<const Constraint>;

// A moving place, twice differentiable but for finitely many jumps of its velocity.
struct PathPoint {
  Vec3 position_m = Vec3::Zero(), velocity_m_per_s = Vec3::Zero(),
       acceleration_m_per_s2 = Vec3::Zero();
};
using PointPath = std::function<PathPoint(double t_s)>;
PointPath fixedAt(const Vec3& place_m);

// Linear: constant Jacobians.
ConstraintPtr makeAttachment(std::string name, const BodyPoint& a, const BodyPoint& b);
ConstraintPtr makeNail(std::string name, const BodyPoint& point, const Vec3& place_m);
ConstraintPtr makeTrajectory(std::string name, const BodyPoint& point, PointPath path);
// The line through `place_m` along `direction` (any length but 0; throws Error).
ConstraintPtr makePointOnLine(std::string name, const BodyPoint& point, const Vec3& place_m,
                              const Vec3& direction);
// The plane through `place_m`, in two dimensions a line.
ConstraintPtr makePointOnPlane(std::string name, const BodyPoint& point, const Vec3& place_m,
                               const Vec3& normal);

// Not linear: the two points keep their distance, (|a − b|² − l²)/(2 l) = 0; or one point keeps it
// from a fixed place. length_m > 0.
ConstraintPtr makeRod(std::string name, const BodyPoint& a, const BodyPoint& b, double length_m);
ConstraintPtr makeTether(std::string name, const BodyPoint& point, const Vec3& place_m,
                         double length_m);

}  // namespace fascia
