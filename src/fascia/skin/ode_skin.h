#pragma once

#include <fascia/math/ode/adaptive_stepper.h>
#include <fascia/math/ode/system.h>
#include <fascia/skin/ode_kernels.h>
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
  bool midpointKick(double t_s, std::span<const double> r, std::span<const double> v, double h_s,
                    std::span<double> out) override;
  bool hasVelocityForces() const override { return true; }
  bool forcesDependOnTime() const override { return true; }
  void forceJacobian(double t_s, std::span<const double> r, std::span<const double> v,
                     SparseMatrix& dfdr, SparseMatrix& dfdv) override;
  MatrixKind jacobianKind() const override { return MatrixKind::symmetric; }
  double violation(double t_s, std::span<const double> r) override;
  double project(double t_s, std::span<double> r, std::span<double> v) override;

 private:
  // From the anchor to the point; its squared length is 0 if the strand is slack or there is none.
  struct Strand {
    Vec3 way;
    double squared;
  };
  Strand strand(std::size_t storage, double t_s, const double* r) const;
  Mat3 dampingOf(std::size_t storage, const Strand& strand) const;
  StrandScene sceneAt(double t_s) const;
  void load(std::span<const double> r, VectorArray& out) const;
  void positionForces(const StrandScene& scene, std::span<const double> r);

  Skin skin_;
  AdaptiveStepper stepper_;
  std::vector<double> inverseMass_;  // per coordinate
  FloatArray inverseMasses_;         // per point, in storage order
  std::unique_ptr<SurfaceStepper> surface_;
  OdeState ode_;
  VectorArray position_, velocity_, force_, change_;
  std::vector<Eigen::Triplet<double>> entries_, dampingEntries_;

  // The interval being integrated.
  double start_s_ = 0;
  SkinPoseSource* poses_ = nullptr;
  SkinContact* contact_ = nullptr;
  SkinState* state_ = nullptr;
};

}  // namespace fascia
