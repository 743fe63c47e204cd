#include <fascia/skin/ode_skin.h>

#include <algorithm>
#include <cmath>

#include <fascia/math/ode/integrators.h>
#include <fascia/math/ode/stability.h>
#include <fascia/math/points.h>

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
      inverseMasses_(skin.topology().storage(), 0.f),
      surface_(skin.topology().makeStepper()) {
  const PointModel& model = skin.points();
  for (std::size_t p = 0; p < skin.pointCount(); ++p) {
    const std::size_t k = skin.storageIndex(p);
    if (!(model.free[k] > 0)) continue;
    inverseMasses_[k] = 1 / model.mass[k];
    for (std::size_t c = 0; c < 3; ++c) inverseMass_[3 * p + c] = 1.0 / model.mass[k];
  }
  ode_.resize(inverseMass_.size());
  for (VectorArray* a : {&position_, &velocity_, &force_, &change_})
    a->resize(skin.topology().storage());
}

void OdeSkin::load(std::span<const double> r, VectorArray& out) const {
  loadCoordinates(skin_.topology().ranges(), r, out);
}

void OdeSkin::advance(SkinPoseSource& poses, double start_s, double end_s, SkinContact& contact,
                      SkinState& state, SkinStats& stats) {
  start_s_ = start_s;
  poses_ = &poses, contact_ = &contact, state_ = &state;
  ode_.t_s = start_s;
  for (std::size_t p = 0; p < skin_.pointCount(); ++p) {
    const std::size_t k = skin_.storageIndex(p);
    const VectorArray* arrays[2] = {&state.position, &state.velocity};
    std::vector<double>* flat[2] = {&ode_.r, &ode_.v};
    for (int a = 0; a < 2; ++a) {
      (*flat[a])[3 * p] = arrays[a]->x[k];
      (*flat[a])[3 * p + 1] = arrays[a]->y[k];
      (*flat[a])[3 * p + 2] = arrays[a]->z[k];
    }
  }
  // All that goes on is in the state, so that copies of it go on alike.
  if (state.odeStep_s > 0)
    stepper_.resume(state.odeStep_s);
  else
    stepper_.reset();
  stepper_.resetStats();
  stepper_.advance(*this, ode_, end_s);
  state.odeStep_s = stepper_.nextStep_s();
  for (VectorArray* a : {&state.position, &state.velocity}) {
    load(a == &state.position ? ode_.r : ode_.v, *a);
    skin_.topology().complete(*a);
  }

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

StrandScene OdeSkin::sceneAt(double t_s) const {
  StrandScene scene{skin_.topology().ranges(),
                    &skin_.points(),
                    &state_->surroundings,
                    static_cast<float>(t_s - start_s_),
                    {}};
  for (int a = 0; a < 3; ++a)
    scene.gravity[a] = static_cast<float>(skin_.settings().gravity_m_per_s2[a]);
  return scene;
}

// Of position_, which it loads.
void OdeSkin::positionForces(const StrandScene& scene, std::span<const double> r) {
  load(r, position_);
  skin_.topology().complete(position_);
  surface_->forces(position_, force_);
  addStrandForces(scene, position_, force_);
}

void OdeSkin::addPositionForces(double t_s, std::span<const double> r, std::span<double> f) {
  const StrandScene scene = sceneAt(t_s);
  positionForces(scene, r);
  addCoordinates(scene.ranges, force_, f, f);
}

void OdeSkin::addVelocityForces(double t_s, std::span<const double> r, std::span<const double> v,
                                std::span<double> f) {
  const StrandScene scene = sceneAt(t_s);
  load(r, position_);
  load(v, velocity_);
  dampingForces(scene, position_, velocity_, force_);
  addCoordinates(scene.ranges, force_, f, f);
}

bool OdeSkin::midpointKick(double t_s, std::span<const double> r, std::span<const double> v,
                           double h_s, std::span<double> out) {
  const StrandScene scene = sceneAt(t_s);
  positionForces(scene, r);
  load(v, velocity_);
  midpointKicks(scene, inverseMasses_, static_cast<float>(h_s), position_, velocity_, force_,
                change_);
  addCoordinates(scene.ranges, change_, v, out);
  return true;
}

OdeSkin::Strand OdeSkin::strand(std::size_t k, double t_s, const double* r) const {
  const PointModel& points = skin_.points();
  const PointSurroundings& around = state_->surroundings;
  const Vec3 way = Vec3(r[0], r[1], r[2]) - pointAt(around.anchor, k) -
                   (t_s - start_s_) * pointAt(around.anchorVelocity, k);
  const double squared = way.squaredNorm(), rest = points.tissueRestLength[k];
  const bool taut = points.tissueStiffness[k] > 0 && squared > 1e-18 && squared > rest * rest;
  return {way, taut ? squared : 0};
}

// Strands damp along themselves; without a rest length they hold a point from all sides, and damp
// so.
Mat3 OdeSkin::dampingOf(std::size_t k, const Strand& strand) const {
  const double damping = skin_.points().tissueDamping[k];
  if (!(strand.squared > 0)) return Mat3::Zero();
  if (skin_.points().tissueRestLength[k] == 0) return damping * Mat3::Identity();
  return damping / strand.squared * strand.way * strand.way.transpose();
}

void OdeSkin::forceJacobian(double t_s, std::span<const double> r, std::span<const double>,
                            SparseMatrix& dfdr, SparseMatrix& dfdv) {
  load(r, position_);
  skin_.topology().complete(position_);
  entries_.clear();
  dampingEntries_.clear();
  skin_.topology().addForceJacobian(position_, entries_);
  const PointModel& points = skin_.points();
  for (std::size_t p = 0; p < skin_.pointCount(); ++p) {
    const std::size_t k = skin_.storageIndex(p);
    const Strand s = strand(k, t_s, r.data() + 3 * p);
    // Slack strands keep their zeros, so that the pattern stays and is analysed once.
    const Mat3 damping = points.drag[k] * Mat3::Identity() + dampingOf(k, s);
    Mat3 stiffness = Mat3::Zero();
    if (s.squared > 0) {
      const Mat3 along = s.way * s.way.transpose() / s.squared;
      const double stretched = 1 - points.tissueRestLength[k] / std::sqrt(s.squared);
      stiffness = points.tissueStiffness[k] * (along + stretched * (Mat3::Identity() - along));
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
  const Field& field = *poses_->at(t_s).field;
  const SkinContact::Result result = contact_->project(
      field, skin_.points(), 0.f, static_cast<float>(skin_.contactResponse().restitution),
      position_, velocity_, state_->surroundings);
  const std::span<const SkinTopology::Range> ranges = skin_.topology().ranges();
  takeChanges(ranges, position_, r);
  takeChanges(ranges, velocity_, v);
  return result.maxCorrection_m;
}

}  // namespace fascia
