#include <fascia/skin/ode_skin.h>

#include <algorithm>
#include <cmath>

#include <fascia/math/ode/integrators.h>
#include <fascia/math/ode/stability.h>

namespace fascia {
namespace {

// Speeds below this do not count as relative errors of the velocity iteration: v^threshold
// of Turner & Gobbetti 1998, eq. 8.
constexpr double kSpeedThreshold_m_per_s = 0.1;

// Error control alone lets a method swing up where it is barely stable.
constexpr double kShareOfStable = 0.7;

StepperOptions optionsOf(const Skin& skin) {
  const SkinSettings& s = skin.settings();
  const double stable_s = std::max(kShareOfStable * longestOdeStep_s(skin), 1e-9);
  StepperOptions o;
  o.tolerance = s.position_tolerance_m;
  o.step_min_s = std::min(s.min_step_s, stable_s);
  o.step_max_s = std::min(std::max(s.min_step_s, s.max_step_s), stable_s);
  // Fixed-step methods have no error estimate to find a step with: half of what the material
  // allows.
  o.fixed_step_s = std::min(s.step_s > 0 ? s.step_s : 0.5 * skin.defaultStep_s(), stable_s);
  o.correction_limit_m = s.correction_tolerance_m;
  o.move_limit_m = 0.25 * skin.size_m();
  o.integrator.position_scale = {.threshold = 1, .relative = false};
  o.integrator.velocity_scale = {.threshold = kSpeedThreshold_m_per_s};
  o.integrator.velocity_tolerance = s.velocity_tolerance;
  return o;
}

}  // namespace

double longestOdeStep_s(const Skin& skin) {
  const PointModel& points = skin.points();
  double stiffest_per_s2 = 0, leastDrag_per_s = HUGE_VAL;
  for (std::size_t k = 0; k < points.mass.size(); ++k) {
    if (points.free[k] == 0 || !(points.mass[k] > 0)) continue;
    stiffest_per_s2 = std::max(stiffest_per_s2, double{points.stiffnessBound[k]} / points.mass[k]);
    leastDrag_per_s = std::min(leastDrag_per_s, double{points.drag[k]} / points.mass[k]);
  }
  if (!(stiffest_per_s2 > 0)) return HUGE_VAL;
  return longestStableStep_s(*makeIntegrator(skin.settings().integrator),
                             std::sqrt(stiffest_per_s2), leastDrag_per_s);
}

OdeSkin::OdeSkin(const Skin& skin)
    : skin_(skin),
      stepper_(makeIntegrator(skin.settings().integrator), optionsOf(skin)),
      inverseMass_(3 * skin.pointCount()),
      points_(skin.pointCount()),
      anchors_(skin.pointCount()),
      surface_(skin.topology().makeStepper()) {
  const PointModel& model = skin.points();
  for (std::size_t p = 0; p < skin.pointCount(); ++p) {
    const std::size_t k = skin.storageIndex(p);
    points_[p] = {k,
                  model.mass[k],
                  model.drag[k],
                  model.tissueStiffness[k],
                  model.tissueDamping[k],
                  model.tissueRestLength[k]};
    const double inverse = model.free[k] > 0 ? 1.0 / model.mass[k] : 0;
    for (std::size_t c = 0; c < 3; ++c) inverseMass_[3 * p + c] = inverse;
  }
  ode_.resize(inverseMass_.size());
  strandDamping_.resize(points_.size());
  dampingPlace_.reserve(inverseMass_.size());
  for (VectorArray* a : {&position_, &velocity_, &force_}) a->resize(skin.topology().storage());
}

void OdeSkin::load(std::span<const double> r, VectorArray& out) const {
  for (std::size_t p = 0; p < skin_.pointCount(); ++p) {
    const std::size_t k = points_[p].storage;
    out.x[k] = static_cast<float>(r[3 * p]);
    out.y[k] = static_cast<float>(r[3 * p + 1]);
    out.z[k] = static_cast<float>(r[3 * p + 2]);
  }
  skin_.topology().complete(out);
}

void OdeSkin::advance(SkinPoseSource& poses, double start_s, double end_s, SkinContact& contact,
                      SkinState& state, SkinStats& stats) {
  start_s_ = start_s;
  poses_ = &poses, contact_ = &contact, state_ = &state;
  ode_.t_s = start_s;
  for (std::size_t p = 0; p < skin_.pointCount(); ++p) {
    const std::size_t k = points_[p].storage;
    const VectorArray* arrays[2] = {&state.position, &state.velocity};
    std::vector<double>* flat[2] = {&ode_.r, &ode_.v};
    for (int a = 0; a < 2; ++a) {
      (*flat[a])[3 * p] = arrays[a]->x[k];
      (*flat[a])[3 * p + 1] = arrays[a]->y[k];
      (*flat[a])[3 * p + 2] = arrays[a]->z[k];
    }
  }
  const PointSurroundings& around = state.surroundings;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const std::size_t k = points_[p].storage;
    anchors_[p] = {
        {around.anchor.x[k], around.anchor.y[k], around.anchor.z[k]},
        {around.anchorVelocity.x[k], around.anchorVelocity.y[k], around.anchorVelocity.z[k]}};
  }
  dampingPlace_.clear();  // the anchors are others now
  // All that goes on is in the state, so that copies of it go on alike.
  if (state.odeStep_s > 0)
    stepper_.resume(state.odeStep_s);
  else
    stepper_.reset();
  stepper_.resetStats();
  stepper_.advance(*this, ode_, end_s);
  state.odeStep_s = stepper_.nextStep_s();
  load(ode_.r, state.position);
  load(ode_.v, state.velocity);

  const StepperStats& s = stepper_.stats();
  stats.steps += s.steps;
  stats.rejected_steps += s.rejected();
  stats.step_min_s = std::min(stats.step_min_s, s.step_min_s);
  stats.step_max_s = std::max(stats.step_max_s, s.step_max_s);
  stats.forces_s += s.cost.forces_s;
  stats.constraints_s += s.cost.constraints_s;
  stats.other_s += s.total_s - s.cost.forces_s - s.cost.constraints_s;
  stats.repaired_points += s.repaired_coordinates / 3;
}

void OdeSkin::addPositionForces(double t_s, std::span<const double> r, std::span<double> f) {
  load(r, position_);
  surface_->forces(position_, force_);
  const Vec3& gravity = skin_.settings().gravity_m_per_s2;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const Point& point = points_[p];
    Vec3 force = Vec3(force_.x[point.storage], force_.y[point.storage], force_.z[point.storage]) +
                 point.mass * gravity;
    const Strand s = strand(p, t_s, r);
    if (s.squared > 0)
      force -= point.stiffness * (1 - point.restLength / std::sqrt(s.squared)) * s.way;
    for (std::size_t c = 0; c < 3; ++c) f[3 * p + c] += force[static_cast<Eigen::Index>(c)];
  }
}

// Strands damp along themselves; without a rest length they hold a point from all sides, and damp
// so.
Mat3 OdeSkin::dampingOf(const Point& point, const Strand& strand) const {
  if (!(strand.squared > 0)) return Mat3::Zero();
  if (point.restLength == 0) return point.damping * Mat3::Identity();
  return point.damping / strand.squared * strand.way * strand.way.transpose();
}

void OdeSkin::prepareDamping(double t_s, std::span<const double> r) {
  if (t_s == dampingTime_s_ && std::ranges::equal(r, dampingPlace_)) return;
  dampingTime_s_ = t_s;
  dampingPlace_.assign(r.begin(), r.end());
  for (std::size_t p = 0; p < points_.size(); ++p) {
    strandDamping_[p] = dampingOf(points_[p], strand(p, t_s, r));
  }
}

void OdeSkin::addVelocityForces(double t_s, std::span<const double> r, std::span<const double> v,
                                std::span<double> f) {
  prepareDamping(t_s, r);
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const Vec3 speed(v[3 * p], v[3 * p + 1], v[3 * p + 2]);
    const Vec3 force = points_[p].drag * speed + strandDamping_[p] * (speed - anchors_[p].velocity);
    for (std::size_t c = 0; c < 3; ++c) f[3 * p + c] -= force[static_cast<Eigen::Index>(c)];
  }
}

void OdeSkin::forceJacobian(double t_s, std::span<const double> r, std::span<const double>,
                            SparseMatrix& dfdr, SparseMatrix& dfdv) {
  load(r, position_);
  entries_.clear();
  dampingEntries_.clear();
  skin_.topology().addForceJacobian(position_, entries_);
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const Point& point = points_[p];
    const Strand s = strand(p, t_s, r);
    // Slack strands keep their zeros, so that the pattern stays and is analysed once.
    const Mat3 damping = point.drag * Mat3::Identity() + dampingOf(point, s);
    Mat3 stiffness = Mat3::Zero();
    if (s.squared > 0) {
      const Mat3 along = s.way * s.way.transpose() / s.squared;
      const double stretched = 1 - point.restLength / std::sqrt(s.squared);
      stiffness = point.stiffness * (along + stretched * (Mat3::Identity() - along));
    }
    const int row = static_cast<int>(3 * p);
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) {
        entries_.emplace_back(row + a, row + b, -stiffness(a, b));
        dampingEntries_.emplace_back(row + a, row + b, -damping(a, b));
      }
    }
  }
  const auto n = static_cast<Eigen::Index>(size());
  dfdr.resize(n, n);
  dfdv.resize(n, n);
  dfdr.setFromTriplets(entries_.begin(), entries_.end());
  dfdv.setFromTriplets(dampingEntries_.begin(), dampingEntries_.end());
}

double OdeSkin::violation(double t_s, std::span<const double> r) {
  load(r, position_);
  const Field& field = *poses_->at(t_s).field;
  return contact_->deepest(field, skin_.points(), position_);
}

double OdeSkin::project(double t_s, std::span<double> r, std::span<double> v) {
  load(r, position_);
  load(v, velocity_);
  positionBefore_ = position_;
  velocityBefore_ = velocity_;
  const Field& field = *poses_->at(t_s).field;
  const SkinContact::Result result = contact_->project(
      field, skin_.points(), 0.f, static_cast<float>(skin_.contactResponse().restitution),
      position_, velocity_, state_->surroundings);
  // Only what was changed goes back: the rest keeps its double precision.
  for (std::size_t p = 0; p < skin_.pointCount(); ++p) {
    const std::size_t k = points_[p].storage;
    const VectorArray* now[2] = {&position_, &velocity_};
    const VectorArray* old[2] = {&positionBefore_, &velocityBefore_};
    const std::span<double> flat[2] = {r, v};
    for (int a = 0; a < 2; ++a) {
      flat[a][3 * p] += double{now[a]->x[k]} - old[a]->x[k];
      flat[a][3 * p + 1] += double{now[a]->y[k]} - old[a]->y[k];
      flat[a][3 * p + 2] += double{now[a]->z[k]} - old[a]->z[k];
    }
  }
  return result.maxCorrection_m;
}

}  // namespace fascia
