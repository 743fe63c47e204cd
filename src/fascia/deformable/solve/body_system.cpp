#include <fascia/deformable/solve/body_system.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/base/error.h>
#include <fascia/deformable/bases/check_range.h>
#include <fascia/deformable/body/for_each_body.h>
#include <fascia/deformable/contact/body_contact.h>

namespace fascia {
namespace {

constexpr std::size_t kForcesPerTask = 64;

}  // namespace

BodySystem::BodySystem(BodyModel model, const BodySettings& settings)
    : model_(std::move(model)), settings_(settings), hard_(model_), soft_(model_) {
  checkRange("body system", "feedback_s", settings.feedback_s, 1e-9, 1e3);
  checkRange("body system", "gravity_m_per_s2", settings.gravity_m_per_s2.norm(), 0, 1e6);
  inverseMass_.assign(model_.size(), 1.0);
  work_.resize(model_.size());
  for (std::size_t b = 0; b < model_.bodyCount(); ++b)
    damped_ = damped_ || model_.shape(BodyId(b)).damped();
}

BodySystem::~BodySystem() = default;

BodyContacts& BodySystem::setContacts(const ContactSettings& settings) {
  contacts_ = std::make_unique<BodyContacts>(model_, settings_.gravity_m_per_s2, settings);
  tiesVersion_ = -1;
  return *contacts_;
}

BodyContacts* BodySystem::contacts() {
  if (!contacts_ || tiesVersion_ == version_) return contacts_.get();
  tiesVersion_ = version_;
  std::vector<BodyContacts::Pair> ties;
  for (const Held& held : held_)
    for (const BodyPoint& a : held.constraint->points())
      for (const BodyPoint& b : held.constraint->points())
        if (a.body < b.body) ties.emplace_back(a.body, b.body);
  std::ranges::sort(ties);
  contacts_->setTies(std::move(ties));
  return contacts_.get();
}

void BodySystem::checkPoints(const Constraint& constraint) const {
  const std::size_t count = constraint.points().size();
  bool sound = count >= 1 && count <= kMaxConstraintPoints;
  for (const BodyPoint& point : constraint.points()) sound = sound && model_.contains(point.body);
  if (sound) return;
  Issue issue{{},
              "constraint '" + constraint.name() + "': found a point of no body, expected " +
                  "points of the system's " + std::to_string(model_.bodyCount()) + " bodies",
              {}};
  throw Error(issue);
}

ConstraintId BodySystem::keep(Held held) {
  checkPoints(*held.constraint);
  held.id = ConstraintId(nextConstraint_++);
  held_.push_back(std::move(held));
  changed_ = true, ++version_;
  return held_.back().id;
}

ConstraintId BodySystem::hold(ConstraintPtr constraint) {
  return keep({{}, std::move(constraint), std::nullopt});
}

ConstraintId BodySystem::pull(const SoftConstraint& soft) {
  checkRange("body system", "stiffness_N_per_m", soft.stiffness_N_per_m, 1e-12, 1e12);
  checkRange("body system", "damping_Ns_per_m", soft.damping_Ns_per_m, 0, 1e12);
  return keep({{}, soft.constraint, Softness{soft.stiffness_N_per_m, soft.damping_Ns_per_m}});
}

void BodySystem::release(ConstraintId id) {
  if (std::erase_if(held_, [&](const Held& held) { return held.id == id; }) == 0) return;
  changed_ = true, ++version_;
}

bool BodySystem::holds(ConstraintId id) const {
  return std::ranges::any_of(held_, [&](const Held& held) { return held.id == id; });
}

PointForceId BodySystem::addPointForce(const BodyPoint& point, const Vec3& force_N) {
  if (!model_.contains(point.body)) throw Error("point force: found a point of no body");
  const PointForceId id(nextForce_++);
  pointForces_.push_back({id, point, force_N, model_.shape(point.body).pointWeights(point.X_m)});
  forcesChanged_ = true;
  return id;
}

void BodySystem::removePointForce(PointForceId id) {
  if (std::erase_if(pointForces_, [&](const PointForce& force) { return force.id == id; }) > 0)
    forcesChanged_ = true;
}

void BodySystem::clearPointForces() {
  pointForces_.clear();
  forcesChanged_ = true;
}

// Gathers the constraints anew after hold() or release().
void BodySystem::refresh() {
  if (!changed_) return;
  changed_ = false;
  std::vector<ConstraintPtr> hard;
  soft_.clear(), softness_.clear();
  for (const Held& held : held_) {
    if (held.softness) {
      soft_.add(*held.constraint), softness_.push_back(*held.softness);
    } else {
      hard.push_back(held.constraint);
    }
  }
  hard_.setConstraints(hard);
  FASCIA_ASSERT(soft_.size() == softness_.size(), "every spring has its softness");
}

ConstraintSolver& BodySystem::constraints() {
  refresh();
  return hard_;
}

ConstraintList& BodySystem::softList() {
  refresh();
  return soft_;
}

std::vector<Redundancy> BodySystem::redundancies(const OdeState& state) {
  FASCIA_ASSERT(state.r.size() == size() && state.v.size() == size(),
                "the state is of these bodies");
  refresh();
  hard_.update(state.t_s, state.r, state.v);
  return hard_.redundancies();
}

std::span<const double> BodySystem::constantForces() {
  if (!forcesChanged_) return constantForces_;
  forcesChanged_ = false;
  constantForces_.assign(model_.size(), 0.0);
  const int d = model_.dimension();
  for (std::size_t b = 0; b < model_.bodyCount(); ++b) {
    const Eigen::VectorXd& weights = model_.shape(BodyId(b)).momentumWeights();
    double* f = constantForces_.data() + model_.offset(BodyId(b));
    for (int j = 0; j < weights.size(); ++j)
      for (int row = 0; row < d; ++row)
        f[j * d + row] = settings_.gravity_m_per_s2[row] * weights[j];
  }
  for (const PointForce& force : pointForces_) {
    double* f = constantForces_.data() + model_.offset(force.point.body);
    for (int j = 0; j < force.weights.size(); ++j)  // Q_rs = f_r p_s (§2.2)
      for (int row = 0; row < d; ++row) f[j * d + row] += force.force_N[row] * force.weights[j];
  }
  return constantForces_;
}

void BodySystem::addBodyForces(std::span<const double> q, std::span<double> f) const {
  FASCIA_ASSERT(q.size() == model_.size() && f.size() == q.size(), "the state is of these bodies");
  forEachBody(model_.bodyCount(), kForcesPerTask, [&](BodyId body) {
    model_.shape(body).addElasticForce(model_.part(body, q), model_.part(body, f));
  });
}

void BodySystem::addDampingForces(std::span<const double> q, std::span<const double> v,
                                  std::span<double> f) const {
  FASCIA_ASSERT(q.size() == model_.size() && v.size() == q.size() && f.size() == q.size(),
                "the state is of these bodies");
  if (!damped_) return;
  forEachBody(model_.bodyCount(), kForcesPerTask, [&](BodyId body) {
    const BodyShape& shape = model_.shape(body);
    if (shape.damped())
      shape.addDampingForce(model_.part(body, q), model_.part(body, v), model_.part(body, f));
  });
}

void BodySystem::addSoftPositionForces(double t_s, std::span<const double> q, std::span<double> f) {
  FASCIA_ASSERT(q.size() == model_.size() && f.size() == q.size(), "the state is of these bodies");
  soft_.evaluate(t_s, q, {});
  for (std::size_t i = 0; i < soft_.size(); ++i) {
    const Vec3 pull = softness_[i].stiffness_N_per_m * soft_.rows(i).value +
                      softness_[i].damping_Ns_per_m * soft_.rows(i).rate_m_per_s;
    soft_.addTransposed(i, -pull, f);
  }
}

void BodySystem::addSoftVelocityForces(double t_s, std::span<const double> q,
                                       std::span<const double> v, std::span<double> f) {
  soft_.evaluate(t_s, q, {});
  for (std::size_t i = 0; i < soft_.size(); ++i)
    soft_.addTransposed(i, -softness_[i].damping_Ns_per_m * soft_.jacobianTimes(i, v), f);
}

void BodySystem::evaluateFreeForces(const OdeState& state, std::span<double> f) {
  FASCIA_ASSERT(state.r.size() == size() && state.v.size() == size() && f.size() == size(),
                "the state is of these bodies");
  refresh();
  std::ranges::copy(constantForces(), f.begin());
  addBodyForces(state.r, f);
  addDampingForces(state.r, state.v, f);
  if (soft_.size() == 0) return;
  addSoftPositionForces(state.t_s, state.r, f);
  addSoftVelocityForces(state.t_s, state.r, state.v, f);
}

double BodySystem::potentialEnergy_J(std::span<const double> q, double t_s) {
  FASCIA_ASSERT(q.size() == size(), "the state is of these bodies");
  refresh();
  const std::span<const double> constant = constantForces();
  double sum = model_.elasticEnergy_J(q);
  for (std::size_t i = 0; i < q.size(); ++i) sum -= constant[i] * q[i];
  soft_.evaluate(t_s, q, {});
  for (std::size_t i = 0; i < soft_.size(); ++i)
    sum += 0.5 * softness_[i].stiffness_N_per_m * soft_.rows(i).value.squaredNorm();
  return sum;
}

double BodySystem::energy_J(const OdeState& state) {
  return potentialEnergy_J(state.r, state.t_s) + model_.kineticEnergy_J(state.v);
}

double BodySystem::drift_m(const OdeState& state) {
  refresh();
  hard_.update(state.t_s, state.r, state.v);
  double largest = 0;
  for (std::size_t i = 0; i < hard_.list().size(); ++i)
    largest = std::max(largest, hard_.list().rows(i).value.norm());
  return largest;
}

}  // namespace fascia
