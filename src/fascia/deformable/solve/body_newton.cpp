#include <fascia/deformable/solve/body_newton.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <fascia/deformable/body/for_each_body.h>

namespace fascia {
namespace {

// Where along the way the force counts, and how much. The mean is by Gauss & Legendre's rule of
// three points: exact along a straight way for forces of degree 5 in it, and so for both energies
// of BodyMaterial, of degree 4 and 6.
LineRule forceRule(BodyScheme scheme) {
  return scheme == BodyScheme::energyConserving ? gaussRule(3) : LineRule{{1.0}, {1.0}};
}

constexpr std::size_t kEquationsPerTask = 16;

// Corrections of contacts below this part of a body's size, a tenth of their margin, may be the
// last.
constexpr double kNearEnough = 1e-3;

// A factorisation is kept while corrections shrink to this part at least. Larger: more iterations,
// each cheaper by what a factorisation takes.
constexpr double kGoodShrink = 0.1;

Eigen::Map<const Eigen::VectorXd> vectorOf(std::span<const double> x) {
  return {x.data(), static_cast<Eigen::Index>(x.size())};
}
Eigen::Map<Eigen::VectorXd> vectorOf(std::span<double> x) {
  return {x.data(), static_cast<Eigen::Index>(x.size())};
}
std::span<double> spanOf(Eigen::VectorXd& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}

}  // namespace

BodyNewton::BodyNewton(BodySystem& system, const BodyStepperOptions& options)
    : system_(system),
      options_(options),
      conserving_(options.scheme == BodyScheme::energyConserving),
      rule_(forceRule(options.scheme)),
      constraints_(system.model()),
      work_(system.model().bodyCount()),
      way_(system.size()),
      correction_(system.size()),
      place_(system.size()) {
  for (std::size_t b = 0; b < work_.size(); ++b) {
    const Eigen::Index n = system.model().shape(BodyId(b)).coordinateCount();
    Work& work = work_[b];
    work.matrix.resize(n, n), work.damping.setZero(n, n);
    work.residual.resize(n), work.q.resize(n), work.force.resize(n);
  }
}

// Takes over the system's constraints after they have changed.
void BodyNewton::refresh() {
  if (version_ == system_.constraintVersion()) return;
  version_ = system_.constraintVersion();
  const ConstraintList& hard = system_.constraints().list();
  const ConstraintList& soft = system_.softList();
  constraints_.clear();
  for (std::size_t i = 0; i < hard.size(); ++i) constraints_.add(hard.constraint(i));
  for (std::size_t i = 0; i < soft.size(); ++i) constraints_.add(soft.constraint(i));
  hardCount_ = hard.size();
  matrix_.setPattern(constraints_.size(), constraints_.coupledPairs());
  lambda_.resize(constraints_.size());
  startValue_.resize(constraints_.size()), endValue_.resize(constraints_.size());
  for (std::size_t b = 0; b < work_.size(); ++b) {
    Work& work = work_[b];
    work.terms.clear();
    if (b < constraints_.termsOfBodies().size()) work.terms = constraints_.termsOfBodies()[b];
    const auto count = static_cast<Eigen::Index>(work.terms.size());
    const int d = system_.model().dimension();
    const Eigen::Index columns = paddedColumns(1 + count * d);
    work.response.resize(work.residual.size(), columns);
    work.atTerms.resize(count * d, columns);
  }
}

BodyNewton::Result BodyNewton::solve(const OdeState& from, double h_s, double lead_s,
                                     OdeState& to) {
  refresh();
  constantForces_ = system_.constantForces();
  guess(from, h_s, to.t_s);
  for (Work& work : work_) work.factored = false, work.correction = HUGE_VAL;
  lastMerit_.reset();
  findContacts(from, h_s, lead_s);
  Result result;
  const double tolerance = contacts_ ? options_.contact_tolerance : options_.tolerance;
  while (result.iterations < options_.max_iterations && !result.converged) {
    ++result.iterations;
    if (contacts_) evaluateContacts(result.iterations);
    result.correction = iterate(from, h_s, to.t_s);
    if (!std::isfinite(result.correction)) return result;
    result.converged = result.correction <= tolerance;
    if (contacts_ && result.iterations >= options_.contact_patience &&
        result.correction <= kNearEnough)
      break;
  }
  result.near = contacts_ && result.correction <= kNearEnough;
  if (contacts_) contacts_->evaluate(way_, ContactSet::Loads::follow);
  result.sound = true;
  for (std::size_t i = 0; i < way_.size(); ++i) {
    to.r[i] = from.r[i] + way_[i];
    to.v[i] = conserving_ ? 2 * way_[i] / h_s - from.v[i] : way_[i] / h_s;
  }
  return result;
}

// One of Newton's steps. Returns its largest correction as a part of a body's size; not finite if
// there is none.
double BodyNewton::iterate(const OdeState& from, double h_s, double t_s) {
  evaluateConstraints(from, t_s);
  forEachBody(work_.size(), kEquationsPerTask, [&](BodyId body) { linearize(body, from, h_s); });
  const bool sound = std::ranges::all_of(work_, &Work::sound);
  if (!sound || !solveConstraints(h_s)) return std::numeric_limits<double>::quiet_NaN();
  forEachBody(work_.size(), kEquationsPerTask, [&](BodyId body) { correct(body); });
  if (contacts_ && contacts_->pairsPress()) coupleContacts();
  forEachBody(work_.size(), kEquationsPerTask, [&](BodyId body) { measure(body); });
  applyCorrections(from, h_s, t_s);
  double largest = 0;
  for (const Work& work : work_) {
    if (!std::isfinite(work.correction)) return work.correction;
    largest = std::max(largest, work.correction);
  }
  return largest;
}

// A first way that is legal as far as constraints are linear: the search then stays among legal
// ones.
void BodyNewton::guess(const OdeState& from, double h_s, double t_s) {
  for (std::size_t i = 0; i < way_.size(); ++i) way_[i] = h_s * from.v[i];
  ConstraintSolver& hard = system_.constraints();
  hard.update(t_s, from.r, from.v);
  hard.project(way_, [&](std::size_t i) -> Vec3 { return -hard.list().rows(i).value; });
  for (std::size_t i = 0; i < hardCount_; ++i) matrix_.setDropped(i, hard.matrix().dropped()[i]);
  constraints_.evaluate(from.t_s, from.r, {});
  for (std::size_t i = 0; i < constraints_.size(); ++i) startValue_[i] = constraints_.rows(i).value;
  if (!system_.damped()) return;
  const BodyModel& model = system_.model();
  forEachBody(work_.size(), kEquationsPerTask, [&](BodyId body) {
    Work& work = work_[body.index()];
    work.damping.setZero();
    model.shape(body).addDampingMatrix(model.part(body, from.r), 1, work.damping,
                                       spanOf(work.force));
  });
}

// Values at the end of the way, and Jacobians: there, or half-way, where they make the way's change
// of a quadratic c exact, c(q⁺) − c(q) = J Δ.
void BodyNewton::evaluateConstraints(const OdeState& from, double t_s) {
  for (std::size_t i = 0; i < way_.size(); ++i) place_[i] = from.r[i] + way_[i];
  constraints_.evaluate(t_s, place_, {});
  for (std::size_t i = 0; i < constraints_.size(); ++i) endValue_[i] = constraints_.rows(i).value;
  if (!conserving_ || constraints_.hasConstantJacobian()) return;
  for (std::size_t i = 0; i < way_.size(); ++i) place_[i] = from.r[i] + 0.5 * way_[i];
  constraints_.evaluate(0.5 * (from.t_s + t_s), place_, {});
}

// At q + place Δ.
void BodyNewton::moveTo(BodyId body, const OdeState& from, double place) {
  const BodyModel& model = system_.model();
  work_[body.index()].q = vectorOf(model.part(body, std::span<const double>(from.r))) +
                          place * vectorOf(model.part(body, std::span<const double>(way_)));
}

void BodyNewton::linearize(BodyId body, const OdeState& from, double h_s) {
  const BodyModel& model = system_.model();
  Work& work = work_[body.index()];
  const auto way = vectorOf(model.part(body, std::span<const double>(way_)));
  const auto v = vectorOf(model.part(body, from.v));
  // (v⁺ − v)/h with v⁺ = Δ/h, or 2 Δ/h − v where v̄ is the mean.
  work.residual = (conserving_ ? 2 : 1) / h_s * (way / h_s - v);
  work.residual -= vectorOf(model.part(body, constantForces_));
  for (std::size_t i = 0; i < rule_.nodes.size(); ++i) {
    moveTo(body, from, rule_.nodes[i]);
    work.force.setZero();
    model.shape(body).addElasticForce(spanOf(work.q), spanOf(work.force));
    work.residual -= rule_.weights[i] * work.force;
  }
  if (system_.damped()) work.residual.noalias() += work.damping * way / h_s;
  if (contacts_) contacts_->addGradient(body, work.residual);
  work.sound = work.residual.allFinite();
  if (!work.sound) return;
  if (mayKeep(work))
    respondToResidual(work);
  else
    work.sound = work.factored = factor(body, from, h_s);
}

// Contacts change A more than shapes do.
bool BodyNewton::mayKeep(const Work& work) const {
  return work.factored && !contacts_ && work.residual.size() >= kManyCoordinates &&
         work.correction <= kGoodShrink * work.correctionBefore;
}

// A, its factorisation, and what the constraints' points answer to unit forces. Where A is not
// positive the energy's concave parts are left out: then it is, and the way goes downhill.
bool BodyNewton::factor(BodyId body, const OdeState& from, double h_s) {
  const BodyShape& shape = system_.model().shape(body);
  Work& work = work_[body.index()];
  for (const Curvature curvature : {Curvature::exact, Curvature::positive}) {
    work.matrix.setIdentity();
    work.matrix *= (conserving_ ? 2 : 1) / (h_s * h_s);
    if (system_.damped()) work.matrix += work.damping / h_s;
    for (std::size_t i = 0; i < rule_.nodes.size(); ++i) {
      moveTo(body, from, rule_.nodes[i]);
      const double weight = rule_.weights[i] * rule_.nodes[i];  // ∂(q + place Δ)/∂Δ = place
      shape.addStiffness(spanOf(work.q), weight, curvature, work.matrix);
    }
    if (!addContacts(body)) continue;
    if (!choleskyInPlace(work.matrix)) continue;
    respond(work);
    return true;
  }
  return false;
}

void BodyNewton::respond(Work& work) const {
  const int d = system_.model().dimension();
  const Eigen::Index shapes = work.residual.size() / d, columns = work.response.cols();
  work.response.setZero();
  work.response.col(0) = work.residual;
  for (std::size_t a = 0; a < work.terms.size(); ++a) {
    const double* s =
        constraints_.weights(constraints_.terms()[static_cast<std::size_t>(work.terms[a])]);
    const Eigen::Index first = 1 + static_cast<Eigen::Index>(a) * d;
    for (Eigen::Index j = 0; j < shapes; ++j)
      for (int row = 0; row < d; ++row) work.response(j * d + row, first + row) = s[j];
  }
  choleskySolveInPlace(work.matrix, work.response);
  work.atTerms.setZero();
  for (std::size_t a = 0; a < work.terms.size(); ++a) {
    const double* s =
        constraints_.weights(constraints_.terms()[static_cast<std::size_t>(work.terms[a])]);
    double* target = work.atTerms.data() + static_cast<Eigen::Index>(a) * d * columns;
    for (Eigen::Index j = 0; j < shapes; ++j) {
      addScaledRow(s[j], work.response.data() + j * d * columns, target, d * columns);
    }
  }
}

// respond() with the factorisation of an earlier iteration.
void BodyNewton::respondToResidual(Work& work) const {
  const int d = system_.model().dimension();
  work.force = work.residual;
  choleskySolveInPlace(work.matrix, work.force);
  work.response.col(0) = work.force;
  for (std::size_t a = 0; a < work.terms.size(); ++a) {
    const double* s =
        constraints_.weights(constraints_.terms()[static_cast<std::size_t>(work.terms[a])]);
    for (int row = 0; row < d; ++row) {
      double sum = 0;
      for (Eigen::Index j = 0; j < work.force.size() / d; ++j)
        sum += s[j] * work.force[j * d + row];
      work.atTerms(static_cast<Eigen::Index>(a) * d + row, 0) = sum;
    }
  }
}

double BodyNewton::gain(std::size_t softIndex, double h_s) const {
  const BodySystem::Softness softness = system_.softness(softIndex);
  return (conserving_ ? 0.5 : 1) * softness.stiffness_N_per_m + softness.damping_Ns_per_m / h_s;
}

// What J δ has to be: c is to vanish; a soft constraint's force −(k c + d ċ), of the mean or the
// end's c, is to agree with its λ.
Vec3 BodyNewton::wanted(std::size_t i, double h_s) const {
  if (isHard(i)) return -endValue_[i];
  const BodySystem::Softness softness = system_.softness(i - hardCount_);
  const Vec3 value = conserving_ ? Vec3(0.5 * (startValue_[i] + endValue_[i])) : endValue_[i];
  const Vec3 pull = softness.stiffness_N_per_m * value +
                    softness.damping_Ns_per_m / h_s * (endValue_[i] - startValue_[i]);
  return -pull / gain(i - hardCount_, h_s);
}

bool BodyNewton::solveConstraints(double h_s) {
  if (constraints_.size() == 0) return true;
  const std::span<const ConstraintTerm> terms = constraints_.terms();
  for (std::size_t i = 0; i < lambda_.size(); ++i) lambda_[i] = wanted(i, h_s);
  const ConstraintSolver& hard = system_.constraints();
  if (constraints_.hasConstantJacobian())
    hard.dependences().makeSolvable(std::span(lambda_).first(hardCount_));
  matrix_.setZero();
  for (std::size_t i = 0; i < lambda_.size(); ++i) {
    Mat3 diagonal = Mat3::Zero();
    const int rows = constraints_.rowCount(i);
    for (int row = 0; row < 3; ++row)
      diagonal(row, row) = row >= rows ? 1 : isHard(i) ? 0 : 1 / gain(i - hardCount_, h_s);
    matrix_.add(static_cast<int>(i), static_cast<int>(i), diagonal);
  }
  const int d = system_.model().dimension();
  for (const Work& work : work_) {
    for (std::size_t a = 0; a < work.terms.size(); ++a) {
      const int termA = work.terms[a];
      const int i = terms[static_cast<std::size_t>(termA)].constraint;
      const Eigen::Index row = static_cast<Eigen::Index>(a) * d;
      const Mat3& derivative = constraints_.derivative(termA);
      lambda_[static_cast<std::size_t>(i)] +=
          derivative.leftCols(d) * work.atTerms.block(row, 0, d, 1);
      for (std::size_t b = 0; b < work.terms.size(); ++b) {
        const int termB = work.terms[b], j = terms[static_cast<std::size_t>(termB)].constraint;
        if (i < j) continue;
        Mat3 coupling = Mat3::Zero();
        coupling.topLeftCorner(d, d) =
            work.atTerms.block(row, 1 + static_cast<Eigen::Index>(b) * d, d, d);
        matrix_.add(i, j, derivative * coupling * constraints_.derivative(termB).transpose());
      }
    }
  }
  if (!matrix_.factorize()) return false;
  matrix_.solve(lambda_);
  return true;
}

// δ = −A⁻¹ residual + A⁻¹ Jᵀ λ.
void BodyNewton::correct(BodyId body) {
  const BodyModel& model = system_.model();
  Work& work = work_[body.index()];
  auto correction = vectorOf(model.part(body, std::span(correction_)));
  const int d = model.dimension();
  correction = -work.response.col(0);
  for (std::size_t a = 0; a < work.terms.size(); ++a) {
    const auto term = static_cast<std::size_t>(work.terms[a]);
    const auto i = static_cast<std::size_t>(constraints_.terms()[term].constraint);
    const Vec3 force = constraints_.derivative(work.terms[a]).transpose() * lambda_[i];
    const Eigen::Index first = 1 + static_cast<Eigen::Index>(a) * d;
    for (int row = 0; row < d; ++row) correction += force[row] * work.response.col(first + row);
  }
}

void BodyNewton::measure(BodyId body) {
  const BodyModel& model = system_.model();
  const BodyShape& shape = model.shape(body);
  const auto correction = vectorOf(model.part(body, std::span<const double>(correction_)));
  Work& work = work_[body.index()];
  work.correctionBefore = work.correction;
  work.correction = correction.norm() / (shape.size_m() * std::sqrt(shape.mass_kg()));
}

// Δ += δ. Implicit Euler's step is the minimum of a merit (Martin et al. 2011, eq. 5): where all is
// linear but the energies, δ is shortened until the merit falls, so that no stiffness can throw the
// search off.
void BodyNewton::applyCorrections(const OdeState& from, double h_s, double t_s) {
  constexpr int kMaxHalvings = 12;
  double step = 1;
  if (contacts_) contacts_->setDirection(correction_);
  // A single iteration is a linearly implicit step: there is nothing to compare it with.
  if (!conserving_ && constraints_.hasConstantJacobian() && options_.max_iterations > 1) {
    const double before = lastMerit_ ? *lastMerit_ : merit(from, h_s, t_s, 0);
    lastMerit_.reset();
    // The sum's rounding must not stop the last iterations.
    const double allowed = before + 1e-12 * std::abs(before);
    for (int halving = 0; halving < kMaxHalvings; ++halving) {
      const double next = merit(from, h_s, t_s, step);
      // Soft constraints and contacts may round otherwise once the way is longer.
      if (next <= allowed && !contacts_ && constraints_.size() == hardCount_) lastMerit_ = next;
      if (next <= allowed) break;
      step *= 0.5;
    }
    if (step < 1)
      for (Work& work : work_) work.factored = false;
  }
  if (contacts_) contacts_->setStep(step);
  for (std::size_t i = 0; i < way_.size(); ++i) way_[i] += step * correction_[i];
}

double BodyNewton::bodyMerit(BodyId body, const OdeState& from, double h_s, double step) {
  const BodyModel& model = system_.model();
  Work& work = work_[body.index()];
  const auto way = vectorOf(model.part(body, std::span(way_)));
  const auto correction = vectorOf(model.part(body, std::span(correction_)));
  work.force = way + step * correction;
  work.q = vectorOf(model.part(body, from.r)) + work.force;
  double merit = model.shape(body).energy(spanOf(work.q));
  merit += 0.5 * (work.force / h_s - vectorOf(model.part(body, from.v))).squaredNorm();
  merit -= work.force.dot(vectorOf(model.part(body, constantForces_)));
  if (system_.damped()) {
    work.q.noalias() = work.damping * work.force;
    merit += 0.5 / h_s * work.force.dot(work.q);
  }
  return merit;
}

double BodyNewton::merit(const OdeState& from, double h_s, double t_s, double step) {
  forEachBody(work_.size(), kEquationsPerTask,
              [&](BodyId body) { work_[body.index()].merit_J = bodyMerit(body, from, h_s, step); });
  double sum = 0;
  for (const Work& work : work_) sum += work.merit_J;
  if (contacts_) sum += contacts_->merit_J(step);
  if (constraints_.size() == hardCount_) return sum;
  for (std::size_t i = 0; i < way_.size(); ++i)
    place_[i] = from.r[i] + way_[i] + step * correction_[i];
  constraints_.evaluate(t_s, place_, {});
  for (std::size_t i = hardCount_; i < constraints_.size(); ++i) {
    const BodySystem::Softness softness = system_.softness(i - hardCount_);
    const Vec3& value = constraints_.rows(i).value;
    sum += 0.5 * softness.stiffness_N_per_m * value.squaredNorm();
    sum += 0.5 * softness.damping_Ns_per_m / h_s * (value - startValue_[i]).squaredNorm();
  }
  return sum;
}

}  // namespace fascia
