#include <algorithm>
#include <cmath>

#include <fascia/deformable/body/for_each_body.h>
#include <fascia/deformable/solve/body_newton.h>

// What contacts add to BodyNewton: normal forces that friction goes by, and the linear equations of
// bodies that touch each other.

namespace fascia {
namespace {

constexpr std::size_t kContactEquationsPerTask = 32;
// Friction goes by the normal forces of the iteration at hand. Should they chase each other, they
// stay from here on, and what is left is one convex problem.
constexpr int kFollowingIterations = 10;
// Of the first guess's error, in the norm of the equations. Smaller: fewer of Newton's steps, each
// dearer.
constexpr double kCgTolerance = 0.02;
constexpr int kMaxCgIterations = 100;

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

void BodyNewton::findContacts(const OdeState& from, double h_s, double lead_s) {
  contacts_ = nullptr;
  BodyContacts* contacts = conserving_ ? nullptr : system_.contacts();
  if (!contacts) return;
  ContactSet& set = contacts->find({from.r, from.v, way_, h_s, lead_s});
  if (set.empty()) return;
  contacts_ = &set;
  for (auto* x : {&cgResidual_, &cgAnswer_, &cgDirection_, &cgImage_, &cgProduct_})
    x->resize(way_.size());
  if (!set.hasPairs()) return;
  for (Work& work : work_) {
    const Eigen::Index n = work.residual.size();
    work.inverse.resize(n, paddedColumns(n));
    work.trial.resize(n, n);
  }
}

void BodyNewton::evaluateContacts(int iteration) {
  contacts_->evaluate(way_, iteration == 1                      ? ContactSet::Loads::bound
                            : iteration <= kFollowingIterations ? ContactSet::Loads::follow
                                                                : ContactSet::Loads::keep);
}

// Adds to A. False if A is not positive without it: A with its own contacts may be, and the
// equations of all bodies not, as bodies that touch may move together.
bool BodyNewton::addContacts(BodyId body) {
  if (!contacts_) return true;
  Work& work = work_[body.index()];
  if (contacts_->hasPairs()) {
    work.trial = work.matrix;
    if (!choleskyInPlace(work.trial)) return false;
  }
  contacts_->addCurvature(body, work.matrix);
  return true;
}

// The correction so far solves the equations without C, the contacts' coupling of bodies. From
// there conjugate gradients go on, within the constraints: their preconditioner is those equations
// (Gould, Hribar & Nocedal 2001, algorithm 2.1). K p is kept as the sum of what the preconditioner
// was given, K p = Σ ρ + C p up to forces Jᵀ λ, which no legal p feels.
void BodyNewton::coupleContacts() {
  const std::size_t n = way_.size();
  forEachBody(work_.size(), kContactEquationsPerTask, [&](BodyId body) {
    Work& work = work_[body.index()];
    work.inverse.setIdentity();
    choleskySolveInPlace(work.matrix, work.inverse);
  });
  std::ranges::fill(cgResidual_, 0.0);
  contacts_->addCoupling(correction_, cgResidual_);
  for (double& x : cgResidual_) x = -x;
  double start = 0;  // the squared norm of the first guess
  for (std::size_t b = 0; b < work_.size(); ++b) {
    const auto part = system_.model().part(BodyId(b), std::span<const double>(correction_));
    start -= dot(part, {work_[b].residual.data(), part.size()});
  }
  precondition(cgResidual_, cgAnswer_);
  double error = dot(cgResidual_, cgAnswer_);
  const double wanted = kCgTolerance * kCgTolerance * std::max(std::abs(start), error);
  cgDirection_ = cgAnswer_, cgImage_ = cgResidual_;
  for (int k = 0; k < kMaxCgIterations && error > wanted; ++k) {
    cgProduct_ = cgImage_;
    contacts_->addCoupling(cgDirection_, cgProduct_);
    const double curvature = dot(cgDirection_, cgProduct_);
    if (!(curvature > 0)) return;
    const double step = error / curvature;
    for (std::size_t i = 0; i < n; ++i) {
      correction_[i] += step * cgDirection_[i];
      cgResidual_[i] -= step * cgProduct_[i];
    }
    precondition(cgResidual_, cgAnswer_);
    const double before = error;
    error = dot(cgResidual_, cgAnswer_);
    const double share = error / before;
    for (std::size_t i = 0; i < n; ++i) {
      cgDirection_[i] = cgAnswer_[i] + share * cgDirection_[i];
      cgImage_[i] = cgResidual_[i] + share * cgImage_[i];
    }
  }
}

// z with A z = residual + Jᵀ µ and J z = 0 (−µ/K where constraints are soft).
void BodyNewton::precondition(std::span<const double> residual, std::span<double> z) {
  const BodyModel& model = system_.model();
  std::ranges::copy(residual, z.begin());
  forEachBody(work_.size(), kContactEquationsPerTask, [&](BodyId body) {
    const std::span<double> part = model.part(body, z);
    const auto isZero = [](double x) { return x == 0; };
    if (std::ranges::all_of(part, isZero)) return;  // it touches nobody
    const auto n = static_cast<Eigen::Index>(part.size());
    Work& work = work_[body.index()];
    work.force = Eigen::Map<const Eigen::VectorXd>(part.data(), n);
    Eigen::Map<Eigen::VectorXd>(part.data(), n).noalias() =
        work.inverse.topLeftCorner(n, n) * work.force;
  });
  if (constraints_.size() == 0) return;
  for (std::size_t i = 0; i < lambda_.size(); ++i) lambda_[i] = -constraints_.jacobianTimes(i, z);
  matrix_.solve(lambda_);
  const int d = model.dimension();
  forEachBody(work_.size(), kContactEquationsPerTask, [&](BodyId body) {
    const Work& work = work_[body.index()];
    const std::span<double> part = model.part(body, z);
    Eigen::Map<Eigen::VectorXd> target(part.data(), static_cast<Eigen::Index>(part.size()));
    for (std::size_t a = 0; a < work.terms.size(); ++a) {
      const auto term = static_cast<std::size_t>(work.terms[a]);
      const auto i = static_cast<std::size_t>(constraints_.terms()[term].constraint);
      const Vec3 force = constraints_.derivative(work.terms[a]).transpose() * lambda_[i];
      const Eigen::Index first = 1 + static_cast<Eigen::Index>(a) * d;
      for (int row = 0; row < d; ++row) target += force[row] * work.response.col(first + row);
    }
  });
}

}  // namespace fascia
