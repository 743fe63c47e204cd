#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <fascia/deformable/bases/basis.h>
#include <fascia/deformable/matter/matter.h>
#include <fascia/deformable/matter/strain_energy.h>

namespace fascia {

struct SlopeTable;

struct BodyDef {
  BasisPtr basis;
  Matter matter;
  BodyMaterial material;
  Crushing crushing = Crushing::free;
};

// A kind of linear deformable body, constant; any number of bodies of a system may be of one kind.
//
// The paper's equation of motion is R̈ M = Q with the constant M = Σ m p pᵀ (eq. 4), and it inverts
// M once (eq. 5). Here M = L Lᵀ goes into the coordinates, once and for all: with
//     q = R L,   s(X) = L⁻¹ p(X)   it is   x = R p(X) = q s(X),   Σ m s sᵀ = I,   q̈ = Q,
// so that W = I. q is a dimension × k matrix stored column by column, in m √kg; point weights s are
// in 1/√kg. All functions below take and give these coordinates: coordinateCount() numbers each.
class BodyShape {
 public:
  // Throws Error if a number is out of its range, if the mass leaves some shape without inertia, or
  // if the basis cannot represent the undeformed body.
  explicit BodyShape(const BodyDef& def);

  int dimension() const { return dimension_; }
  int shapeCount() const { return shapeCount_; }                    // k
  int coordinateCount() const { return dimension_ * shapeCount_; }  // length of q
  double mass_kg() const { return mass_kg_; }
  double volume_m3() const { return volume_m3_; }
  const Vec3& center_m() const { return center_m_; }  // of mass, undeformed
  double size_m() const { return size_m_; }           // largest extent of the undeformed mass
  const BodyMaterial& material() const { return material_; }
  const Basis& basis() const { return *basis_; }

  // s(X): k weights, so that x = Σ_j q.col(j) s_j.
  Eigen::VectorXd pointWeights(const Vec3& X) const;
  void pointWeights(const Vec3& X, Eigen::Ref<Eigen::VectorXd> s) const;  // the same into `s`
  // Σ m s: the weights of the momentum, Σ_j q̇.col(j) momentumWeights_j = ∫ ẋ dm.
  const Eigen::VectorXd& momentumWeights() const { return momentumWeights_; }

  // The paper's R, dimension × k, and back.
  Eigen::MatrixXd shapeMatrix(std::span<const double> q) const;
  void writeShapeMatrix(std::span<const double> q, Eigen::Ref<Eigen::MatrixXd> R) const;
  void setShapeMatrix(const Eigen::MatrixXd& R, std::span<double> q) const;
  // The undeformed body moved rigidly.
  void setRest(const Transform& place, std::span<double> q) const;
  // Velocities of a rigid motion of a body at q.
  void setRigidVelocity(std::span<const double> q, const Twist& twist,
                        std::span<double> velocity) const;

  Vec3 point(std::span<const double> q, const Vec3& X) const;
  Mat3 deformationGradient(std::span<const double> q, const Vec3& X) const;  // ∂x/∂X

  // How much of the volume is left, det F, at worst among the energy's points and on average. 1 at
  // rest; not positive where the body is flat or inside out.
  double leastGrowth(std::span<const double> q) const;
  double meanGrowth(std::span<const double> q) const;

  // Elastic energy V(q) = Σ volume ψ(F), J.
  double energy(std::span<const double> q) const;
  // force −= ∂V/∂q.
  void addElasticForce(std::span<const double> q, std::span<double> force) const;
  // H += factor ∂²V/∂q∂q, coordinateCount() squared.
  void addStiffness(std::span<const double> q, double factor, Curvature curvature,
                    Eigen::Ref<Eigen::MatrixXd> H) const;

  // All damping of BodyMaterial is −D(q) q̇ with a symmetric D that is nowhere negative.
  bool damped() const;
  void addDampingForce(std::span<const double> q, std::span<const double> velocity,
                       std::span<double> force) const;
  // D += factor D(q); `scratch` is any room for coordinateCount() numbers.
  void addDampingMatrix(std::span<const double> q, double factor, Eigen::Ref<Eigen::MatrixXd> D,
                        std::span<double> scratch) const;

 private:
  void factorMass(const BodyDef& def);
  void findRest(const BodyDef& def);
  void prepareEnergy(const BodyDef& def);
  template <int D>
  struct Sums;  // over energy points
  bool hasManyFunctions() const { return table_ != nullptr; }
  const double* slopes(std::size_t point) const {
    return slopes_.data() + point * static_cast<std::size_t>(shapeCount_ * dimension_);
  }

  BasisPtr basis_;
  BodyMaterial material_;
  Crushing crushing_;
  int dimension_ = 3, shapeCount_ = 0;
  double mass_kg_ = 0, volume_m3_ = 0, size_m_ = 0;
  Vec3 center_m_ = Vec3::Zero();
  Eigen::MatrixXd massRoot_;         // L, k × k, lower triangular
  Eigen::MatrixXd rest_;             // q of the undeformed body, dimension × k
  Eigen::VectorXd momentumWeights_;  // k
  std::vector<double> volumes_;      // per energy point
  std::vector<double> slopes_;       // per energy point: ∂s/∂X, k × dimension, row by row
  std::shared_ptr<const SlopeTable> table_;  // the same, of bodies of many functions
};

}  // namespace fascia
