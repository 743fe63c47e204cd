#include <fascia/skin/ode_skin.h>

#include <algorithm>
#include <cmath>

#include <fascia/math/ode/integrators.h>

namespace fascia {
namespace {

// Speeds below this do not count as relative errors of the velocity iteration (L8: v_threshold).
constexpr double kSpeedThreshold_m_per_s = 0.1;

StepperOptions optionsOf(const Skin& skin) {
  const SkinSettings& s = skin.settings();
  StepperOptions o;
  o.tolerance = s.position_tolerance_m;
  o.step_min_s = s.min_step_s;
  o.step_max_s = std::max(s.min_step_s, s.max_step_s);
  // Fixed-step methods have no error estimate to find a step with: half of what the material
  // allows.
  o.fixed_step_s = s.step_s > 0 ? s.step_s : 0.5 * skin.defaultStep_s();
  o.correction_limit_m = s.correction_tolerance_m;
  o.move_limit_m = 0.25 * skin.size_m();
  o.integrator.position_scale = {.threshold = 1, .relative = false};
  o.integrator.velocity_scale = {.threshold = kSpeedThreshold_m_per_s};
  o.integrator.velocity_tolerance = s.velocity_tolerance;
  return o;
}

}  // namespace

// One tissue strand at one moment: taut, or without effect.
struct OdeSkin::Strand {
  bool taut = false;
  Vec3 direction;      // from the anchor to the skin, unit
  double length = 0;   // m
  double closing = 0;  // l̇·l/|l|, m/s
};

OdeSkin::OdeSkin(const Skin& skin)
    : skin_(skin),
      stepper_(makeIntegrator(skin.settings().integrator), optionsOf(skin)),
      inverseMass_(3 * skin.pointCount()),
      storage_(skin.pointCount()) {
  for (std::size_t p = 0; p < skin.pointCount(); ++p) {
    const std::size_t k = storage_[p] = skin.storageIndex(p);
    const double inverse = skin.points().free[k] > 0 ? 1.0 / skin.points().mass[k] : 0;
    for (std::size_t c = 0; c < 3; ++c) inverseMass_[3 * p + c] = inverse;
  }
  ode_.resize(inverseMass_.size());
  for (VectorArray* a : {&position_, &velocity_, &force_}) a->resize(skin.layout().storage());
  scratch_.resize(skin.layout());
}

void OdeSkin::load(std::span<const double> r, VectorArray& out) const {
  for (std::size_t p = 0; p < skin_.pointCount(); ++p) {
    const std::size_t k = storage_[p];
    out.x[k] = static_cast<float>(r[3 * p]);
    out.y[k] = static_cast<float>(r[3 * p + 1]);
    out.z[k] = static_cast<float>(r[3 * p + 2]);
  }
  fillPads(skin_.layout(), out);
}

void OdeSkin::advance(SkinPoseSource& poses, double start_s, double end_s, FleshContact& contact,
                      SkinState& state, SkinStats& stats) {
  start_s_ = start_s;
  poses_ = &poses, contact_ = &contact, state_ = &state;
  ode_.t_s = start_s;
  for (std::size_t p = 0; p < skin_.pointCount(); ++p) {
    const std::size_t k = storage_[p];
    const VectorArray* arrays[2] = {&state.position, &state.velocity};
    std::vector<double>* flat[2] = {&ode_.r, &ode_.v};
    for (int a = 0; a < 2; ++a) {
      (*flat[a])[3 * p] = arrays[a]->x[k];
      (*flat[a])[3 * p + 1] = arrays[a]->y[k];
      (*flat[a])[3 * p + 2] = arrays[a]->z[k];
    }
  }
  stepper_.resetStats();
  stepper_.advance(*this, ode_, end_s);
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

OdeSkin::Strand OdeSkin::strand(std::size_t p, double t_s, std::span<const double> r,
                                std::span<const double> v) const {
  const std::size_t k = storage_[p];
  Strand s;
  if (skin_.points().tissueStiffness[k] <= 0) return s;
  const PointSurroundings& around = state_->surroundings;
  const Vec3 speed(around.anchorVelocity.x[k], around.anchorVelocity.y[k],
                   around.anchorVelocity.z[k]);
  const Vec3 anchor =
      Vec3(around.anchor.x[k], around.anchor.y[k], around.anchor.z[k]) + (t_s - start_s_) * speed;
  const Vec3 l = Vec3(r[3 * p], r[3 * p + 1], r[3 * p + 2]) - anchor;
  s.length = l.norm();
  s.taut = s.length > skin_.points().tissueRestLength[k] && s.length > 1e-9;
  if (!s.taut) return s;
  s.direction = l / s.length;
  if (!v.empty()) s.closing = (Vec3(v[3 * p], v[3 * p + 1], v[3 * p + 2]) - speed).dot(s.direction);
  return s;
}

void OdeSkin::addPositionForces(double t_s, std::span<const double> r, std::span<double> f) {
  const PointModel& points = skin_.points();
  load(r, position_);
  gridForces(skin_.layout(), skin_.elastic().coefficients(), position_, force_, scratch_);
  if (skin_.bending().active()) skin_.bending().addForces(position_, force_);
  const Vec3& gravity = skin_.settings().gravity_m_per_s2;
  for (std::size_t p = 0; p < skin_.pointCount(); ++p) {
    const std::size_t k = storage_[p];
    const Strand s = strand(p, t_s, r, {});
    const double pull =
        s.taut ? points.tissueStiffness[k] * (s.length - points.tissueRestLength[k]) : 0;
    const float elastic[3] = {force_.x[k], force_.y[k], force_.z[k]};
    for (int c = 0; c < 3; ++c)
      f[3 * p + static_cast<std::size_t>(c)] +=
          elastic[c] + points.mass[k] * gravity[c] - (s.taut ? pull * s.direction[c] : 0);
  }
}

void OdeSkin::addVelocityForces(double t_s, std::span<const double> r, std::span<const double> v,
                                std::span<double> f) {
  const PointModel& points = skin_.points();
  for (std::size_t p = 0; p < skin_.pointCount(); ++p) {
    const std::size_t k = storage_[p];
    const Strand s = strand(p, t_s, r, v);
    for (int c = 0; c < 3; ++c) {
      const std::size_t i = 3 * p + static_cast<std::size_t>(c);
      f[i] -= points.drag[k] * v[i];
      if (s.taut) f[i] -= points.tissueDamping[k] * s.closing * s.direction[c];
    }
  }
}

void OdeSkin::forceJacobian(double t_s, std::span<const double> r, std::span<const double> v,
                            SparseMatrix& dfdr, SparseMatrix& dfdv) {
  const PointModel& points = skin_.points();
  load(r, position_);
  entries_.clear();
  dampingEntries_.clear();
  skin_.elastic().addForceJacobian(position_, false, entries_);
  if (skin_.bending().active()) skin_.bending().addForceJacobian(position_, entries_);
  for (std::size_t p = 0; p < skin_.pointCount(); ++p) {
    const std::size_t k = storage_[p];
    const Strand s = strand(p, t_s, r, v);
    Mat3 stiffness = Mat3::Zero(), damping = points.drag[k] * Mat3::Identity();
    if (s.taut) {
      const Mat3 along = s.direction * s.direction.transpose();
      const double slack = points.tissueRestLength[k] / s.length;
      stiffness = points.tissueStiffness[k] * (along + (1 - slack) * (Mat3::Identity() - along));
      damping += points.tissueDamping[k] * along;
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
  return contact_->deepest(*poses_->at(t_s).field, skin_.points(), position_);
}

double OdeSkin::project(double t_s, std::span<double> r, std::span<double> v) {
  load(r, position_);
  load(v, velocity_);
  positionBefore_ = position_;
  velocityBefore_ = velocity_;
  const FleshContact::Result result =
      contact_->project(*poses_->at(t_s).field, skin_.points(), 0.f,
                        static_cast<float>(skin_.contactResponse().restitution), position_,
                        velocity_, state_->surroundings);
  // Only what was changed goes back: the rest keeps its double precision.
  for (std::size_t p = 0; p < skin_.pointCount(); ++p) {
    const std::size_t k = storage_[p];
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
