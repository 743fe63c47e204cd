#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <fascia/deformable/body/body_model.h>
#include <fascia/deformable/solve/constraint_solver.h>
#include <fascia/math/ode/system.h>

namespace fascia {

class BodyContacts;
struct ContactSettings;
using PointForceId = Id<struct PointForceTag>;

// A constraint that pulls instead of holding: force Jᵀ(−k c − d ċ). An attachment so softened is a
// spring between two points, a trajectory the handle by which a person drags a body.
struct SoftConstraint {
  ConstraintPtr constraint;
  double stiffness_N_per_m = 100;  // k, (0, 1e12]
  double damping_Ns_per_m = 0;     // d, [0, 1e12]
};

struct BodySettings {
  Vec3 gravity_m_per_s2{0, -9.81, 0};
  // Time in which BodySystem's feedback takes drift away: c̈ + (2/τ) ċ + c/τ² = 0. Steps of explicit
  // methods must be shorter; a larger one lets more drift stand. The steppers of body_stepper.h
  // need none.
  double feedback_s = 0.02;  // (0, 1e3]
};

// Bodies, what acts on them and what holds them: M q̈ = Q with M = I, plus constraint forces
// (Witkin & Welch 1990, §3). As a SecondOrderSystem every method of the solver library integrates
// it; for the methods made for it see body_stepper.h. Constraints may come and go between steps.
class BodySystem final : public SecondOrderSystem {
 public:
  // Throws Error if a number is out of its range.
  explicit BodySystem(BodyModel model, const BodySettings& settings = {});
  ~BodySystem() override;
  BodySystem(const BodySystem&) = delete;
  BodySystem& operator=(const BodySystem&) = delete;

  const BodyModel& model() const { return model_; }
  const BodySettings& settings() const { return settings_; }

  // Throw Error if a point's body does not exist or a number is out of its range.
  ConstraintId hold(ConstraintPtr constraint);
  ConstraintId pull(const SoftConstraint& constraint);
  void release(ConstraintId constraint);  // nothing happens if it is gone already
  bool holds(ConstraintId constraint) const;
  // A force that acts on a point until it is cleared, N. For forces that change every step.
  PointForceId addPointForce(const BodyPoint& point, const Vec3& force_N);
  void removePointForce(PointForceId force);  // nothing happens if it is gone already
  void clearPointForces();

  // Lets bodies collide from now on (body_contact.h), in place of what was set before. To be called
  // before the stepper is made; contacts are no part of the forces and energies below.
  BodyContacts& setContacts(const ContactSettings& settings);
  BodyContacts* contacts();  // nullptr: there are none

  // Rows of the constraints held that follow from others or contradict them, at the given state.
  std::vector<Redundancy> redundancies(const OdeState& state);

  // Velocity jumps (§3.2): the smallest change of q̇, as measured by kinetic energy, after which all
  // constraints' velocities agree, J q̇ + ∂c/∂t = 0. Call it after holding a moving point
  // (velocity-matching connection), after a jump of a path's velocity, and before a run starts.
  void matchVelocities(OdeState& state);
  // A blow on a point, N s, and what the constraints answer.
  void applyImpulse(const BodyPoint& point, const Vec3& impulse_Ns, OdeState& state);
  // Moves the bodies into a legal state, c = 0, by the smallest way, as measured by the mass.
  void satisfyConstraints(OdeState& state);

  double potentialEnergy_J(std::span<const double> q, double t_s);  // elastic, gravity, springs
  double energy_J(const OdeState& state);
  // Largest |c| of the constraints held, m.
  double drift_m(const OdeState& state);

  // SecondOrderSystem
  std::size_t size() const override { return model_.size(); }
  std::span<const double> inverseMass() const override { return inverseMass_; }
  bool hasVelocityForces() const override { return true; }
  bool forcesDependOnTime() const override { return true; }
  void addPositionForces(double t_s, std::span<const double> r, std::span<double> f) override;
  void addVelocityForces(double t_s, std::span<const double> r, std::span<const double> v,
                         std::span<double> f) override;
  void forceJacobian(double t_s, std::span<const double> r, std::span<const double> v,
                     SparseMatrix& dfdr, SparseMatrix& dfdv) override;
  double project(double t_s, std::span<double> r, std::span<double> v) override;

  // For steppers. Forces of bodies on themselves, gravity and point forces; not of constraints.
  void addBodyForces(std::span<const double> q, std::span<double> f) const;
  void addDampingForces(std::span<const double> q, std::span<const double> v,
                        std::span<double> f) const;
  std::span<const double> constantForces();  // gravity and point forces, kept until they change
  // f = everything but the forces of the constraints held.
  void evaluateFreeForces(const OdeState& state, std::span<double> f);
  ConstraintSolver& constraints();  // of those held, up to date with hold() and release()
  ConstraintList& softList();
  struct Softness {
    double stiffness_N_per_m, damping_Ns_per_m;
  };
  Softness softness(std::size_t softIndex) const { return softness_[softIndex]; }
  bool damped() const { return damped_; }
  int constraintVersion() const { return version_; }  // grows with every hold() and release()

 private:
  struct Held {
    ConstraintId id;
    ConstraintPtr constraint;
    std::optional<Softness> softness;
  };
  struct PointForce {
    PointForceId id;
    BodyPoint point;
    Vec3 force_N;
    Eigen::VectorXd weights;
  };
  void checkPoints(const Constraint& constraint) const;
  ConstraintId keep(Held held);
  void refresh();
  void addSoftPositionForces(double t_s, std::span<const double> q, std::span<double> f);
  void addSoftVelocityForces(double t_s, std::span<const double> q, std::span<const double> v,
                             std::span<double> f);

  BodyModel model_;
  BodySettings settings_;
  std::vector<double> inverseMass_, constantForces_, work_;
  std::vector<PointForce> pointForces_;
  std::vector<Held> held_;
  int nextConstraint_ = 0, nextForce_ = 0, version_ = 0;
  bool changed_ = false, forcesChanged_ = true, damped_ = false;
  int tiesVersion_ = -1;  // of constraints, when the contacts were told of them
  ConstraintSolver hard_;
  ConstraintList soft_;
  std::vector<Softness> softness_;
  std::vector<Vec3> curvature_;  // of constraints that are not linear, at rest
  std::unique_ptr<BodyContacts> contacts_;
};

}  // namespace fascia
