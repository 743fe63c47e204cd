#include <algorithm>

#include <fascia/deformable/solve/body_system.h>

#include <fascia/base/assert.h>

// What the constraints add to a BodySystem: forces, impulses and corrections.

namespace fascia {

void BodySystem::matchVelocities(OdeState& state) {
  FASCIA_ASSERT(state.r.size() == size() && state.v.size() == size(),
                "the state is of these bodies");
  refresh();
  hard_.update(state.t_s, state.r, state.v);
  hard_.project(state.v, [&](std::size_t i) -> Vec3 { return -hard_.list().rows(i).rate_m_per_s; });
}

void BodySystem::applyImpulse(const BodyPoint& point, const Vec3& impulse_Ns, OdeState& state) {
  FASCIA_ASSERT(model_.contains(point.body) && impulse_Ns.allFinite(), "a body's point is pushed");
  const Eigen::VectorXd s = model_.shape(point.body).pointWeights(point.X_m);
  const int d = model_.dimension();
  double* v = state.v.data() + model_.offset(point.body);
  for (int j = 0; j < s.size(); ++j)  // Δq̇ = W I (§3.2) with W = 1
    for (int row = 0; row < d; ++row) v[j * d + row] += impulse_Ns[row] * s[j];
  matchVelocities(state);
}

void BodySystem::satisfyConstraints(OdeState& state) {
  FASCIA_ASSERT(state.r.size() == size(), "the state is of these bodies");
  // One step does for linear constraints; others take Newton's, which converge quadratically.
  constexpr int kMaxSteps = 20;
  constexpr double kLegal_m = 1e-12;
  refresh();
  for (int step = 0; step < kMaxSteps; ++step) {
    hard_.update(state.t_s, state.r, state.v);
    double largest = 0;
    for (std::size_t i = 0; i < hard_.list().size(); ++i)
      largest = std::max(largest, hard_.list().rows(i).value.norm());
    if (largest <= kLegal_m) return;
    std::ranges::fill(work_, 0.0);
    hard_.project(work_, [&](std::size_t i) -> Vec3 { return -hard_.list().rows(i).value; });
    for (std::size_t i = 0; i < work_.size(); ++i) state.r[i] += work_[i];
    if (hard_.list().hasConstantJacobian()) return;
  }
}

// The force of eq. 8, plus feedback. The paper adds Jᵀ(α c + β ċ) to the forces; here it is part of
// the acceleration that λ makes, c̈ = −c/τ² − 2ċ/τ, so that drift decays in one time and without
// overshoot, whatever the masses (Baumgarte 1972).
void BodySystem::addPositionForces(double t_s, std::span<const double> r, std::span<double> f) {
  FASCIA_ASSERT(r.size() == size() && f.size() == r.size(), "the state is of these bodies");
  refresh();
  const std::span<const double> constant = constantForces();
  std::ranges::copy(constant, work_.begin());
  addBodyForces(r, work_);
  addSoftPositionForces(t_s, r, work_);
  hard_.update(t_s, r, {});
  const double rate = 1 / settings_.feedback_s;
  hard_.project(work_, [&](std::size_t i) -> Vec3 {
    const ConstraintRows& rows = hard_.list().rows(i);
    return -rows.acceleration_m_per_s2 - rate * rate * rows.value - 2 * rate * rows.rate_m_per_s;
  });
  for (std::size_t i = 0; i < f.size(); ++i) f[i] += work_[i];
}

// What is left is linear in the forces, so that both parts may be made legal one by one.
void BodySystem::addVelocityForces(double t_s, std::span<const double> r, std::span<const double> v,
                                   std::span<double> f) {
  FASCIA_ASSERT(r.size() == size() && v.size() == r.size() && f.size() == r.size(),
                "the state is of these bodies");
  refresh();
  std::ranges::fill(work_, 0.0);
  addDampingForces(r, v, work_);
  addSoftVelocityForces(t_s, r, v, work_);
  const bool constant = hard_.list().hasConstantJacobian();
  hard_.update(t_s, r, {});
  const double rate = 1 / settings_.feedback_s;
  if (constant) {
    hard_.project(
        work_, [&](std::size_t i) -> Vec3 { return -2 * rate * hard_.list().jacobianTimes(i, v); });
  } else {
    curvature_.resize(hard_.list().size());
    for (std::size_t i = 0; i < curvature_.size(); ++i)
      curvature_[i] = hard_.list().rows(i).acceleration_m_per_s2;
    hard_.update(t_s, r, v);  // with J̇ q̇ this time
    hard_.project(work_, [&](std::size_t i) -> Vec3 {
      return curvature_[i] - hard_.list().rows(i).acceleration_m_per_s2 -
             2 * rate * hard_.list().jacobianTimes(i, v);
    });
  }
  for (std::size_t i = 0; i < f.size(); ++i) f[i] += work_[i];
}

double BodySystem::project(double t_s, std::span<double> r, std::span<double> v) {
  FASCIA_ASSERT(r.size() == size() && v.size() == r.size(), "the state is of these bodies");
  refresh();
  if (hard_.empty()) return 0;
  hard_.update(t_s, r, v);
  double largest = 0;
  for (std::size_t i = 0; i < hard_.list().size(); ++i)
    largest = std::max(largest, hard_.list().rows(i).value.cwiseAbs().maxCoeff());
  std::ranges::fill(work_, 0.0);
  hard_.project(work_, [&](std::size_t i) -> Vec3 { return -hard_.list().rows(i).value; });
  for (std::size_t i = 0; i < r.size(); ++i) r[i] += work_[i];
  hard_.update(t_s, r, v);
  hard_.project(v, [&](std::size_t i) -> Vec3 { return -hard_.list().rows(i).rate_m_per_s; });
  return largest;
}

// Columns of P K with the projection P of the constraints. Dense, as one force anywhere is felt by
// all bodies that hang together: for small systems, and to check others by.
void BodySystem::forceJacobian(double t_s, std::span<const double> r, std::span<const double> v,
                               SparseMatrix& dfdr, SparseMatrix& dfdv) {
  refresh();
  bool analytic = hard_.list().hasConstantJacobian() && soft_.hasConstantJacobian();
  for (std::size_t b = 0; b < model_.bodyCount(); ++b)
    analytic = analytic && !(model_.shape(BodyId(b)).damped());
  if (!analytic) return SecondOrderSystem::forceJacobian(t_s, r, v, dfdr, dfdv);
  const auto n = static_cast<Eigen::Index>(size());
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n), D = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t b = 0; b < model_.bodyCount(); ++b) {
    const auto at = static_cast<Eigen::Index>(model_.offset(BodyId(b)));
    const auto count = static_cast<Eigen::Index>(model_.shape(BodyId(b)).coordinateCount());
    model_.shape(BodyId(b)).addStiffness(model_.part(BodyId(b), r), -1, Curvature::exact,
                                         K.block(at, at, count, count));
  }
  hard_.update(t_s, r, v);
  soft_.evaluate(t_s, r, v);
  const double rate = 1 / settings_.feedback_s;
  std::vector<double> unit(size(), 0.0);
  for (Eigen::Index j = 0; j < n; ++j) {
    unit[static_cast<std::size_t>(j)] = 1;
    const std::span<double> k(K.col(j).data(), size()), d(D.col(j).data(), size());
    for (std::size_t i = 0; i < soft_.size(); ++i) {
      const Vec3 moved = soft_.jacobianTimes(i, unit);
      soft_.addTransposed(i, -softness_[i].stiffness_N_per_m * moved, k);
      soft_.addTransposed(i, -softness_[i].damping_Ns_per_m * moved, d);
    }
    const auto moved = [&](std::size_t i) { return hard_.list().jacobianTimes(i, unit); };
    hard_.project(k, [&](std::size_t i) -> Vec3 { return -rate * rate * moved(i); });
    hard_.project(d, [&](std::size_t i) -> Vec3 { return -2 * rate * moved(i); });
    unit[static_cast<std::size_t>(j)] = 0;
  }
  dfdr = K.sparseView(), dfdv = D.sparseView();
}

}  // namespace fascia
