#pragma once

#include <fascia/math/ode/adaptive_stepper.h>
#include <fascia/math/ode/system.h>
#include <fascia/skin/skin.h>

namespace fascia {

// The longest step with which the settings' integrator keeps the skin from swinging up by itself:
// of its stiffest point, damped by the least drag of any. 0: none is short enough.
double longestOdeStep_s(const Skin& skin);

// A skin as the solver library sees it: the paper's equation of motion with all its forces, and
// non-penetration after every accepted step (Turner & Gobbetti 1998, §4.2). Coordinate 3p + c for
// point p.
class OdeSkin final : public SecondOrderSystem {
 public:
  explicit OdeSkin(const Skin& skin);

  void advance(SkinPoseSource& poses, double start_s, double end_s, SkinContact& contact,
               SkinState& state, SkinStats& stats);

  std::size_t size() const override { return inverseMass_.size(); }
  std::span<const double> inverseMass() const override { return inverseMass_; }
  void addPositionForces(double t_s, std::span<const double> r, std::span<double> f) override;
  void addVelocityForces(double t_s, std::span<const double> r, std::span<const double> v,
                         std::span<double> f) override;
  bool hasVelocityForces() const override { return true; }
  bool forcesDependOnTime() const override { return true; }
  void forceJacobian(double t_s, std::span<const double> r, std::span<const double> v,
                     SparseMatrix& dfdr, SparseMatrix& dfdv) override;
  MatrixKind jacobianKind() const override { return MatrixKind::symmetric; }
  double violation(double t_s, std::span<const double> r) override;
  double project(double t_s, std::span<double> r, std::span<double> v) override;

 private:
  // A point's own constants, flat for the inner loops.
  struct Point {
    std::size_t storage;
    double mass, drag, stiffness, damping, restLength;
  };
  struct Anchor {
    Vec3 position, velocity;  // at the interval's start
  };
  // From the anchor to the point; its squared length is 0 if the strand is slack or there is none.
  struct Strand {
    Vec3 way;
    double squared;
  };
  Strand strand(std::size_t p, double t_s, std::span<const double> r) const {
    const Point& point = points_[p];
    const Anchor& a = anchors_[p];
    const Vec3 way =
        Vec3(r[3 * p], r[3 * p + 1], r[3 * p + 2]) - (a.position + (t_s - start_s_) * a.velocity);
    const double squared = way.squaredNorm();
    const bool taut =
        point.stiffness > 0 && squared > 1e-18 && squared > point.restLength * point.restLength;
    return {way, taut ? squared : 0};
  }
  void load(std::span<const double> r, VectorArray& out) const;
  Mat3 dampingOf(const Point& point, const Strand& strand) const;
  void prepareDamping(double t_s, std::span<const double> r);

  Skin skin_;
  AdaptiveStepper stepper_;
  std::vector<double> inverseMass_;
  std::vector<Point> points_;
  std::vector<Anchor> anchors_;
  std::unique_ptr<SurfaceStepper> surface_;
  // Damping of the strands for the positions below: f −= C (v − v_anchor). Leapfrog's inner
  // iteration asks for velocity forces several times at one place.
  std::vector<Mat3> strandDamping_;
  std::vector<double> dampingPlace_;
  double dampingTime_s_ = 0;
  OdeState ode_;
  VectorArray position_, velocity_, positionBefore_, velocityBefore_, force_;
  std::vector<Eigen::Triplet<double>> entries_, dampingEntries_;

  // The interval being integrated.
  double start_s_ = 0;
  SkinPoseSource* poses_ = nullptr;
  SkinContact* contact_ = nullptr;
  SkinState* state_ = nullptr;
};

}  // namespace fascia
