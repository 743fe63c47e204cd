#include <fascia/deformable/contact/contact_search.h>

#include <algorithm>
#include <cmath>

#include <fascia/deformable/body/for_each_body.h>
#include <fascia/math/points.h>

namespace fascia {
namespace {

constexpr std::size_t kSearchesPerTask = 8;
// Ways shorter than so many margins are not traced: nothing gets lost in them.
constexpr double kShortWay = 4;
// Who begins inside of something is let out by so much of its size per second, not shot.
constexpr double kRecovery_per_s = 1;
// Of m_eff/h², see BodyContacts. Larger: smaller gaps and more iterations between bodies.
constexpr double kStiffness = 30;
constexpr double kLoadStiffness = 0.25;
// With a point that is deeper inside of another body than this part of the smaller one's size a
// body does not touch the other, it is tangled with it: pushed out of the nearest sides, one would
// burst the other. They go apart as wholes.
constexpr double kDeep = 0.15;
// In two dimensions a surface that faces the plane less than this cannot push within it.
constexpr double kFlat = 0.2;

Vec3 rounded(const Vec3& v) {
  return v.cast<float>().cast<double>();
}

}  // namespace

void ContactSearch::resize() {
  work_.resize(contacts_.bodies_.size());
  for (std::size_t b = 0; b < work_.size(); ++b) {
    const auto& points = contacts_.bodies_[b].points;
    const std::size_t count = points ? points->size() : 0;
    Work& work = work_[b];
    work.start.resize(3, static_cast<Eigen::Index>(count));
    work.way.resize(3, static_cast<Eigen::Index>(count));
    for (VectorArray* array : {&work.place, &work.normal, &work.endNormal, &work.velocity})
      array->resize(count);
    work.distance_m.resize(count), work.endDistance_m.resize(count), work.depth_m.resize(count);
    work.picked.reserve(count), work.found.reserve(count);
  }
  boxes_.resize(work_.size());
}

void ContactSearch::find(const BodyContacts::Step& step, const BodyField& bodies, ContactSet& set) {
  step_ = step;
  bodyField_ = &bodies;
  forEachBody(work_.size(), kSearchesPerTask, [&](BodyId body) { movePoints(body); });
  if (contacts_.settings_.bodies_collide) {
    std::ranges::transform(work_, boxes_.begin(), &Work::box);
    bodies_.update(boxes_);
  }
  forEachBody(work_.size(), kSearchesPerTask, [&](BodyId body) { findContacts(body); });
  set.clear();
  for (Work& work : work_) {
    for (Found& found : work.found) {
      if (found.contact.b.count > 0)
        found.contact.b.weights = work.weights.data() + found.firstWeight;
      set.add(found.contact);
    }
  }
  set.finish();
}

double ContactSearch::marginOf(BodyId body, double otherSize_m) const {
  constexpr double kMarginShare = 0.01;
  if (contacts_.settings_.margin_m > 0) return contacts_.settings_.margin_m;
  return kMarginShare * std::min(contacts_.model_.shape(body).size_m(), otherSize_m);
}

double ContactSearch::stiffnessOf(BodyId body, const Contact& contact, const Target& target) const {
  const double margin_m = contact.energy.margin;
  const double forLoad =
      kLoadStiffness * contacts_.heaviest_kg_ * contacts_.gravity_m_per_s2_ / margin_m;
  if (!target.obstacle || !target.obstacle->padding)
    return std::max(kStiffness * contact.inertia_N_per_m, forLoad);
  const double area_m2 = contacts_.bodies_[body.index()].points->area_m2;
  return std::max(target.obstacle->modulus_Pa * area_m2 / margin_m, forLoad);
}

// Where the points are at the beginning of the step, and their first guess of a way.
void ContactSearch::movePoints(BodyId body) {
  Work& work = work_[body.index()];
  work.found.clear(), work.weights.clear(), work.near.clear();
  work.box = {};
  if (work.start.cols() == 0) return;
  const BodyModel& model = contacts_.model_;
  const int d = model.dimension(), k = model.shape(body).shapeCount();
  const Eigen::MatrixXd& weights = contacts_.bodies_[body.index()].points->weights;
  const auto moved = [&](std::span<const double> all, Eigen::Matrix3Xd& out) {
    out.setZero();
    const double* x = model.part(body, all).data();
    for (Eigen::Index i = 0; i < out.cols(); ++i)
      for (int j = 0; j < k; ++j)
        for (int row = 0; row < d; ++row) out(row, i) += x[d * j + row] * weights(j, i);
  };
  moved(step_.q, work.start);
  moved(step_.way, work.way);
  for (Eigen::Index i = 0; i < work.start.cols(); ++i) {
    work.box.add(Vec3(work.start.col(i)));
    work.box.add(Vec3(work.start.col(i) + work.way.col(i)));
  }
  work.box = inflated(work.box, marginOf(body, model.shape(body).size_m()));
}

void ContactSearch::findContacts(BodyId body) {
  Work& work = work_[body.index()];
  if (work.start.cols() == 0) return;
  meetGround(body);
  contacts_.obstacles_.find(work.box, work.near);
  for (const std::uint32_t number : work.near) {
    const Obstacles::Part& part = contacts_.obstacles_.parts()[number];
    meet(body, {part.obstacle->field, part.solid, part.bounds, part.obstacle->friction, HUGE_VAL,
                BodyId(), part.obstacle});
  }
  if (!contacts_.settings_.bodies_collide) return;
  bodies_.find(work.box, work.near);
  for (const std::uint32_t number : work.near) {
    const BodyId other(number);
    if (other == body || !contacts_.collides(body, other)) continue;
    const BodyContacts::Body& b = contacts_.bodies_[number];
    meet(body, {bodyField_, b.solid, work_[number].box, b.friction,
                contacts_.model_.shape(other).size_m(), other});
  }
}

void ContactSearch::meetGround(BodyId body) {
  if (!contacts_.settings_.ground_m) return;
  const Work& work = work_[body.index()];
  const double ground_m = *contacts_.settings_.ground_m;
  if (work.box.low.y() > ground_m + marginOf(body, HUGE_VAL)) return;
  const Target target{nullptr, {}, {}, contacts_.settings_.friction, HUGE_VAL, BodyId()};
  for (int i = 0; i < work.start.cols(); ++i) {
    const Vec3 start = work.start.col(i), way = work.way.col(i);
    addContact(body, i, {{start, start.y() - ground_m, Vec3::UnitY()}}, start, way, Vec3::Zero(),
               target);
  }
}

bool ContactSearch::pick(Work& work, const Box& bounds) const {
  work.picked.clear();
  for (int i = 0; i < work.start.cols(); ++i) {
    Box box;
    box.add(Vec3(work.start.col(i)));
    box.add(Vec3(work.start.col(i) + work.way.col(i)));
    if (meets(box, bounds)) work.picked.push_back(i);
  }
  return !work.picked.empty();
}

// Seen from the target, a point's way begins where the target's matter would carry it.
void ContactSearch::meet(BodyId body, const Target& target) {
  Work& work = work_[body.index()];
  const double margin_m = marginOf(body, target.size_m);
  if (!pick(work, inflated(target.bounds, margin_m))) return;
  const std::size_t count = work.picked.size();
  for (std::size_t i = 0; i < count; ++i) setPoint(work.place, i, work.start.col(work.picked[i]));
  const auto first = [&](VectorArray& array) { return view(array, 0, count); };
  target.field->velocity(target.solid, first(work.place), first(work.velocity));
  const auto start = [&](std::size_t i) {
    return Vec3(work.start.col(work.picked[i]) +
                shift_s(target) * pointAt(first(work.velocity), i));
  };
  const auto way = [&](std::size_t i) {
    return Vec3(work.way.col(work.picked[i]) - step_.h_s * pointAt(first(work.velocity), i));
  };
  for (std::size_t i = 0; i < count; ++i) setPoint(work.place, i, start(i));
  target.field->evaluate(target.solid, first(work.place), work.distance_m.data(),
                         first(work.normal));
  for (std::size_t i = 0; i < count; ++i) setPoint(work.place, i, start(i) + way(i));
  target.field->evaluate(target.solid, first(work.place), work.endDistance_m.data(),
                         first(work.endNormal));
  const SurfaceField* padding = target.obstacle ? target.obstacle->padding : nullptr;
  if (padding) padding->softness(first(work.place), work.depth_m.data());
  const double size_m = std::min(contacts_.model_.shape(body).size_m(), target.size_m);
  const bool tangled = target.body.valid() &&
                       std::any_of(work.distance_m.begin(),
                                   work.distance_m.begin() + static_cast<std::ptrdiff_t>(count),
                                   [&](float d) { return d < -kDeep * size_m; });
  const double steepness = target.field->lipschitz(target.solid);
  for (std::size_t i = 0; i < count; ++i) {
    const Nearness begin{rounded(start(i)), work.distance_m[i], pointAt(first(work.normal), i)};
    const Nearness end{rounded(start(i) + way(i)), work.endDistance_m[i],
                       pointAt(first(work.endNormal), i)};
    const double length_m = way(i).norm();
    const bool covered =
        begin.distance_m + end.distance_m >= steepness * length_m && end.distance_m >= 0;
    Plane plane{tangled ? begin : end, 0, tangled};
    if (!tangled && !covered && length_m > kShortWay * margin_m)
      plane.at = trace(*target.field, target.solid, begin, end.place_m - begin.place_m, margin_m)
                     .value_or(end);
    if (tangled && plane.at.distance_m >= 0) continue;
    if (padding) plane.depth_m = work.depth_m[i];
    const Vec3 drift = step_.h_s * pointAt(first(work.velocity), i);
    addContact(body, work.picked[i], plane, start(i), way(i),
               target.body.valid() ? Vec3(Vec3::Zero()) : drift, target);
  }
}

// From one body's middle to the other's: all deep points of both go the same way.
Vec3 ContactSearch::wayApart(BodyId body, BodyId other) const {
  Vec3 way = work_[body.index()].box.center() - work_[other.index()].box.center();
  if (contacts_.model_.dimension() == 2) way.z() = 0;
  const double length_m = way.norm();
  if (length_m > 0) return way / length_m;
  return body < other ? Vec3(-Vec3::UnitY()) : Vec3(Vec3::UnitY());
}

void ContactSearch::addContact(BodyId body, int point, Plane plane, const Vec3& start,
                               const Vec3& way, const Vec3& drift_m, const Target& target) {
  const BodyModel& model = contacts_.model_;
  const double facing =
      model.dimension() == 3 ? plane.at.normal.norm() : plane.at.normal.head<2>().norm();
  if (facing < kFlat) return;
  Contact contact;
  contact.normal = plane.at.normal / facing;
  if (model.dimension() == 2) contact.normal.z() = 0;
  contact.drift_m = drift_m;
  contact.gap_m =
      plane.at.distance_m / facing + contact.normal.dot(start - plane.at.place_m) + plane.depth_m;
  const bool padded = target.obstacle && target.obstacle->padding;
  contact.energy.margin = padded ? plane.depth_m : marginOf(body, target.size_m);
  const double end_m = contact.gap_m + contact.normal.dot(way);
  // Beyond this nothing will come near that is not on its way already.
  const double reach_m = 2 * contact.energy.margin + 0.25 * way.norm() +
                         contacts_.gravity_m_per_s2_ * step_.h_s * step_.h_s;
  if (!(std::min(contact.gap_m, end_m) < reach_m)) return;
  const double size_m = std::min(model.shape(body).size_m(), target.size_m);
  if (plane.deep) contact.normal = wayApart(body, target.body);
  contact.gap_m -= std::min(0.0, contact.gap_m + kRecovery_per_s * size_m * step_.h_s);
  const ContactPoints& points = *contacts_.bodies_[body.index()].points;
  const int k = model.shape(body).shapeCount();
  contact.a = {body, model.offset(body), points.weights.col(point).data(), k};
  double mobility_per_kg = points.weights.col(point).squaredNorm();
  Work& work = work_[body.index()];
  const std::size_t firstWeight = work.weights.size();
  if (target.body.valid()) {
    const BodyShape& other = model.shape(target.body);
    const Vec3 touched = plane.deep
                             ? plane.at.place_m
                             : Vec3(plane.at.place_m - plane.at.distance_m * plane.at.normal);
    work.weights.resize(firstWeight + static_cast<std::size_t>(other.shapeCount()));
    Eigen::Map<Eigen::VectorXd> s(work.weights.data() + firstWeight, other.shapeCount());
    other.pointWeights(bodyField_->materialFromWorld(target.solid, touched), s);
    contact.b = {target.body, model.offset(target.body), nullptr, other.shapeCount()};
    mobility_per_kg += s.squaredNorm();
  }
  contact.inertia_N_per_m = 1 / (mobility_per_kg * step_.h_s * step_.h_s);
  contact.energy.stiffness = stiffnessOf(body, contact, target);
  contact.friction = std::sqrt(contacts_.bodies_[body.index()].friction * target.friction);
  contact.smoothing_m = contacts_.settings_.creep_per_s * size_m * step_.h_s;
  work.found.push_back({contact, firstWeight});
}

}  // namespace fascia
