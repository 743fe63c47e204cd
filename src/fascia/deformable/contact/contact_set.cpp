#include <fascia/deformable/contact/contact_set.h>

#include <algorithm>

#include <fascia/base/parallel.h>

namespace fascia {
namespace {

// Friction's own curvature along a slide is 0, and Newton's method jumps over the point of rest; a
// bound of it from above, f'/y, never does but comes near in small steps. So much of the bound.
constexpr double kCurvatureShare = 0.6;

constexpr std::size_t kContactsPerTask = 256;

template <class Visit>
void forEachContact(std::size_t count, Visit&& visit) {
  parallelFor((count + kContactsPerTask - 1) / kContactsPerTask, [&](std::size_t task) {
    const std::size_t last = std::min(count, (task + 1) * kContactsPerTask);
    for (std::size_t i = task * kContactsPerTask; i < last; ++i) visit(i);
  });
}

}  // namespace

ContactSet::ContactSet(const BodyModel& model) : model_(&model), dimension_(model.dimension()) {}

// Sorts the contacts' sides by body, in the order of contacts within each.
void ContactSet::finish() {
  states_.resize(contacts_.size());
  pressing_.reserve(contacts_.size());
  first_.assign(model_->bodyCount() + 1, 0);
  hasPairs_ = false;
  for (const Contact& contact : contacts_) {
    ++first_[contact.a.body.index() + 1];
    if (contact.b.count == 0) continue;
    ++first_[contact.b.body.index() + 1];
    hasPairs_ = true;
  }
  for (std::size_t b = 1; b < first_.size(); ++b) first_[b] += first_[b - 1];
  entries_.resize(first_.back());
  // Filling moves each start to its end; backwards they come out at the starts again.
  for (std::size_t b = first_.size() - 1; b > 0; --b) first_[b] = first_[b - 1];
  const auto put = [&](const Contact::Side& side, std::size_t i, bool isB) {
    entries_[first_[side.body.index() + 1]++] = {static_cast<std::uint32_t>(i), isB};
  };
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    put(contacts_[i].a, i, false);
    if (contacts_[i].b.count > 0) put(contacts_[i].b, i, true);
  }
}

Vec3 ContactSet::moved(const Contact::Side& side, std::span<const double> x) const {
  Vec3 sum = Vec3::Zero();
  const double* at = x.data() + side.offset;
  if (dimension_ == 3) {
    for (int j = 0; j < side.count; ++j)
      for (int row = 0; row < 3; ++row) sum[row] += at[3 * j + row] * side.weights[j];
  } else {
    for (int j = 0; j < side.count; ++j)
      for (int row = 0; row < 2; ++row) sum[row] += at[2 * j + row] * side.weights[j];
  }
  return sum;
}

void ContactSet::evaluate(std::span<const double> way, Loads loads) {
  forEachContact(contacts_.size(), [&](std::size_t i) { evaluateOne(i, way, loads); });
  pressing_.clear();
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    if (contacts_[i].b.count > 0 && !states_[i].curvature_N_per_m.isZero(0)) pressing_.push_back(i);
}

void ContactSet::evaluateOne(std::size_t i, std::span<const double> way, Loads loads) {
  const Contact& contact = contacts_[i];
  State& state = states_[i];
  const Vec3& n = contact.normal;
  state.slide_m = moved(contact.a, way) - moved(contact.b, way) - contact.drift_m;
  state.gap_m = contact.gap_m + n.dot(state.slide_m);
  const double normal_N = contact.energy.force(state.gap_m);
  if (loads == Loads::bound) {
    const double stop_N = contact.inertia_N_per_m * (contact.energy.margin - state.gap_m);
    const double rest_N = contact.energy.force(std::max(contact.gap_m, 0.0));
    state.mostLoad_N = rest_N + std::max(stop_N, 0.0);
    state.load_N = std::min(normal_N, state.mostLoad_N);
  } else if (loads == Loads::follow) {
    state.load_N = std::min(state.nextLoad_N, state.mostLoad_N);
  }
  state.force_N = normal_N * n;
  state.curvature_N_per_m = contact.energy.curvature(state.gap_m) * (n * n.transpose());
  const double friction_N = contact.friction * state.load_N;
  if (friction_N == 0) return;
  const Vec3 along = state.slide_m - n.dot(state.slide_m) * n;
  const double y = along.norm();
  const SlideEnergy slide{contact.smoothing_m};
  const double slope = slide.slopeOverWay_per_m(y);
  state.force_N -= friction_N * slope * along;
  Mat3 across = Mat3::Identity() - n * n.transpose();
  if (dimension_ == 2) across(2, 2) = 0;
  Mat3 curvature = slope * across;
  if (y > 0) {
    const double least = kCurvatureShare * slope;
    const double alongCurvature = std::max(slide.curvature_per_m(y), least);
    curvature += (alongCurvature - slope) / (y * y) * (along * along.transpose());
  }
  state.curvature_N_per_m += friction_N * curvature;
}

void ContactSet::addGradient(BodyId body, Eigen::Ref<Eigen::VectorXd> residual) const {
  for (const Entry& entry : entriesOf(body)) {
    const Contact& contact = contacts_[entry.contact];
    const Contact::Side& side = entry.isB ? contact.b : contact.a;
    const Vec3 force = (entry.isB ? -1 : 1) * states_[entry.contact].force_N;
    for (int j = 0; j < side.count; ++j)
      for (int row = 0; row < dimension_; ++row)
        residual[dimension_ * j + row] -= force[row] * side.weights[j];
  }
}

void ContactSet::addCurvature(BodyId body, Eigen::Ref<Eigen::MatrixXd> matrix) const {
  const int d = dimension_;
  for (const Entry& entry : entriesOf(body)) {
    const Contact& contact = contacts_[entry.contact];
    const State& state = states_[entry.contact];
    if (state.curvature_N_per_m.isZero(0)) continue;
    const Contact::Side& side = entry.isB ? contact.b : contact.a;
    const Mat3& H = state.curvature_N_per_m;
    for (int j = 0; j < side.count; ++j) {
      for (int column = 0; column < d; ++column) {
        double* target = &matrix(0, d * j + column);
        for (int i = j; i < side.count; ++i) {
          const double weight = side.weights[i] * side.weights[j];
          for (int row = 0; row < d; ++row) target[d * i + row] += weight * H(row, column);
        }
      }
    }
  }
}

void ContactSet::addCoupling(std::span<const double> x, std::span<double> out) const {
  const auto subtract = [&](const Contact::Side& side, const Vec3& force) {
    double* target = out.data() + side.offset;
    for (int j = 0; j < side.count; ++j)
      for (int row = 0; row < dimension_; ++row)
        target[dimension_ * j + row] -= side.weights[j] * force[row];
  };
  for (const std::size_t i : pressing_) {
    const Contact& contact = contacts_[i];
    const Mat3& H = states_[i].curvature_N_per_m;
    const Vec3 onA = H * moved(contact.b, x), onB = H * moved(contact.a, x);
    subtract(contact.a, onA);
    subtract(contact.b, onB);
  }
}

void ContactSet::setDirection(std::span<const double> direction) {
  forEachContact(contacts_.size(), [&](std::size_t i) {
    const Contact& contact = contacts_[i];
    State& state = states_[i];
    state.directionSlide_m = moved(contact.a, direction) - moved(contact.b, direction);
    const double rise_m = contact.normal.dot(state.directionSlide_m);
    state.nextLoad_N = std::max(
        0.0, contact.energy.force(state.gap_m) - contact.energy.curvature(state.gap_m) * rise_m);
  });
}

void ContactSet::setStep(double step) {
  for (State& state : states_)
    state.nextLoad_N = state.load_N + step * (state.nextLoad_N - state.load_N);
}

double ContactSet::merit_J(double step) const {
  double sum = 0;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Contact& contact = contacts_[i];
    const State& state = states_[i];
    const Vec3 slide = state.slide_m + step * state.directionSlide_m;
    const double normal = contact.normal.dot(slide);
    sum += contact.energy.value(contact.gap_m + normal);
    const double friction_N = contact.friction * state.load_N;
    if (friction_N > 0)
      sum += friction_N *
             SlideEnergy{contact.smoothing_m}.value_m((slide - normal * contact.normal).norm());
  }
  return sum;
}

double ContactSet::gapEnergy_J() const {
  double sum = 0;
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    sum += contacts_[i].energy.value(states_[i].gap_m);
  return sum;
}

}  // namespace fascia
