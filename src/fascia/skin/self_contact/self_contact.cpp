#include <fascia/skin/self_contact/self_contact.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>
#include <fascia/math/points.h>

namespace fascia {
namespace {

// Patches handed to a thread at once.
constexpr std::size_t kPatchesPerTask = 8;
// Each halves, at least, what is left where only one of two sides has a contact of its own.
constexpr int kPasses = 4;
constexpr int kVelocityPasses = 2;
// The strength of a contact reaches 1 where the cosine of the normals is this much below its limit:
// a point that turns away is let go gradually, not dropped and caught again.
constexpr float kFacingFade = 0.3f;
// A deep point comes up over several intervals, this share of the edges around it in each. At once
// it would be flung, and the elastic skin torn along.
constexpr float kMostWay = 0.25f;
// A point that is moved may stand out from its neighbours' mean by this share of the edges around
// it, beyond what it does at rest. More, and triangles turn over and find contacts of their own:
// dense skin melts.
constexpr float kMostRough = 0.35f;
// Cosine of a contact's normal and the flesh's from which on it pushes off the flesh.
constexpr float kMostOutward = 0.2f;
// Skin that lies face down goes this share of the way to its neighbours' mean, so often.
constexpr float kFlatShare = 0.5f;
constexpr int kFlatPasses = 6;
constexpr float kMostFlatWay = 1;  // edges around it, per interval
// Within this share of the gap sheets touch: approaching is over.
constexpr float kTouching = 0.05f;
// By how many gaps another sheet must be more urgent than the flesh to take its half space: less
// than a resting point trembles, and it would go to and fro between the two.
constexpr float kMoreUrgent = 0.05f;

void put(VectorArray& a, std::size_t k, const Eigen::Vector3f& v) {
  a.x[k] = v.x(), a.y[k] = v.y(), a.z[k] = v.z();
}

Eigen::Vector3f blend(const VectorArray& a, const std::array<std::uint32_t, 3>& corners,
                      const Eigen::Vector3f& weights) {
  return weights[0] * floatPointAt(a, corners[0]) + weights[1] * floatPointAt(a, corners[1]) +
         weights[2] * floatPointAt(a, corners[2]);
}

// Square metres per kilogram: how readily a piece of skin gives way. 0 for what cannot.
float mobility(const SelfContactModel& model, const PointModel& points, std::size_t k) {
  if (points.free[k] == 0 || !(points.mass[k] > 0)) return 0;
  return model.area_m2[k] / points.mass[k];
}

float keptDistance(const SelfContactModel& model, std::uint32_t point, std::uint32_t group) {
  for (const SelfContactModel::RestDistance& r : model.restDistances[point])
    if (r.group == group) return std::min(r.keep_m, model.pointGap_m[point]);
  return model.pointGap_m[point];
}

}  // namespace

float SelfContact::Contact::distance(const VectorArray& position) const {
  return normal.dot(floatPointAt(position, point) - blend(position, corners, weights));
}

float SelfContact::Contact::approach(const VectorArray& velocity) const {
  return distance(velocity);
}

SelfContact::SelfContact(const SelfContactModel& model)
    : model_(&model),
      search_(model),
      found_(model.patches.size() * SelfContactModel::Patch::kCapacity),
      foundCounts_(model.patches.size()),
      hasContact_(model.points),
      pushingMass_(model.points),
      change_(model.points),
      start_(model.points) {
  contacts_.reserve(found_.size());
  pushed_.reserve(model.points);
}

SelfContact::Result SelfContact::separate(const PointModel& points, float reach_m,
                                          VectorArray& position, VectorArray& velocity,
                                          float interval_s, const VectorArray& fleshNormal) {
  FASCIA_ASSERT(fleshNormal.x.empty() || fleshNormal.size() == position.size(),
                "a normal for each point");
  find({points, reach_m, position, velocity, interval_s, fleshNormal});
  shareOut(points);
  const Result result = limitWays(position);
  if (result.contacts > 0) {
    start_ = position;
    moveApart(points, position);
    keepSmooth(position);
  }
  removeApproach(points, position, velocity);
  for (Contact& c : contacts_) placePlane(c, position, velocity);
  forget();
  return result;
}

void SelfContact::find(const Inputs& in) {
  search_.update(in.position, in.velocity, in.interval_s);
  const std::size_t patches = model_->patches.size();
  parallelFor((patches + kPatchesPerTask - 1) / kPatchesPerTask, [&](std::size_t task) {
    const std::size_t end = std::min(patches, (task + 1) * kPatchesPerTask);
    for (std::size_t p = task * kPatchesPerTask; p < end; ++p) findOfPatch(p, in);
  });
  contacts_.clear();
  for (std::size_t p = 0; p < patches; ++p) {
    const auto first =
        found_.begin() + static_cast<std::ptrdiff_t>(p * SelfContactModel::Patch::kCapacity);
    contacts_.insert(contacts_.end(), first, first + foundCounts_[p]);
  }
}

// The nearest contact of each of a patch's points.
void SelfContact::findOfPatch(std::size_t patch, const Inputs& in) {
  struct Best {
    std::uint32_t group;
    Touch touch;
  };
  std::array<Best, SelfContactModel::Patch::kCapacity> best;
  std::uint32_t any = 0;  // bit by bit: lanes with a touch
  PointLanes lanes;
  const auto consider = [&](std::uint32_t group, const Touch& touch) {
    const std::uint32_t lane = touch.lane, bit = 1u << lane;
    // Equally near triangles share an edge: the choice must not depend on the order of the search.
    if ((any & bit) && touch.nearest_m == best[lane].touch.nearest_m &&
        touch.triangle > best[lane].touch.triangle)
      return;
    any |= bit;
    best[lane] = {group, touch};
    lanes.nearest_m[lane] = touch.nearest_m;
  };
  search_.search(patch, {model_->gap_m + in.reach_m, 1, in.position, in.velocity}, lanes,
                 std::cref(consider));
  std::uint32_t& count = foundCounts_[patch] = 0;
  for (; any != 0; any &= any - 1) {
    const auto& [group, touch] = best[static_cast<std::size_t>(std::countr_zero(any))];
    const auto point = static_cast<std::uint32_t>(model_->patches[patch].points[touch.lane]);
    if (in.points.free[point] == 0) continue;
    const Contact contact{point,
                          model_->triangle(touch.triangle),
                          touch.weights(),
                          Eigen::Vector3f(touch.normal[0], touch.normal[1], touch.normal[2]),
                          keptDistance(*model_, point, group),
                          std::min(1.f, -touch.facing / kFacingFade),
                          1,
                          0,
                          Eigen::Vector3f::Zero()};
    if (leavesFlesh(contact, in.fleshNormal)) continue;
    const float approach_m = -in.interval_s * contact.approach(in.velocity);
    if (touch.distance_m - contact.keep_m > in.reach_m + std::max(0.f, approach_m)) continue;
    found_[patch * SelfContactModel::Patch::kCapacity + count++] = contact;
  }
}

bool SelfContact::leavesFlesh(const Contact& c, const VectorArray& fleshNormal) {
  if (fleshNormal.x.empty()) return false;
  return c.normal.dot(floatPointAt(fleshNormal, c.point)) > kMostOutward ||
         c.normal.dot(blend(fleshNormal, c.corners, c.weights)) < -kMostOutward;
}

// How two sides share the way apart: by their mobility, as two sheets of skin do that collide,
// m v conserved. A corner of the triangle gives way as far as the skin around it is in contact.
void SelfContact::shareOut(const PointModel& points) {
  for (const Contact& c : contacts_) hasContact_[c.point] = 1;
  for (const Contact& c : contacts_) {
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t k = c.corners[static_cast<std::size_t>(i)];
      if (hasContact_[k] || points.free[k] == 0 || !(c.weights[i] > 0)) continue;
      if (pushingMass_[k] == 0) pushed_.push_back(k);
      pushingMass_[k] += c.weights[i] * points.mass[c.point];
    }
  }
  for (Contact& c : contacts_) {
    const float own = mobility(*model_, points, c.point);
    float other = 0;
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t k = c.corners[static_cast<std::size_t>(i)];
      const float covered = hasContact_[k] ? 1.f : std::min(1.f, pushingMass_[k] / points.mass[k]);
      const float corner = mobility(*model_, points, k);
      if (corner > 0) other += c.weights[i] * covered * corner;
    }
    c.share = own > 0 ? own / (own + other) : 0.f;
  }
}

SelfContact::Result SelfContact::limitWays(const VectorArray& position) {
  Result result;
  for (Contact& c : contacts_) {
    const float distance = c.distance(position), missing = c.keep_m - distance;
    if (!(missing > 0)) continue;
    ++result.contacts;
    result.deepest_m = std::max(result.deepest_m, missing);
    c.keep_m = std::min(c.keep_m, distance + kMostWay * model_->edge_m[c.point]);
  }
  return result;
}

// Gives every contact what it wants, wanted(contact) ≥ 0 along its normal. Points with a contact of
// their own move by their share; other corners are pushed by the mass of what pushes them. All see
// the same state, so that nothing depends on the order.
template <class Wanted>
void SelfContact::balance(const PointModel& points, const Wanted& wanted, VectorArray& values) {
  const auto add = [](VectorArray& a, std::size_t k, const Eigen::Vector3f& v) {
    put(a, k, floatPointAt(a, k) + v);
  };
  for (const Contact& c : contacts_) {
    const float amount = c.strength * c.share * wanted(c);
    if (!(amount > 0)) continue;
    add(change_, c.point, amount * c.normal);
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t k = c.corners[static_cast<std::size_t>(i)];
      if (hasContact_[k] || pushingMass_[k] == 0) continue;
      const float mass = std::max(points.mass[k], pushingMass_[k]);
      add(change_, k, -amount * c.weights[i] * points.mass[c.point] / mass * c.normal);
    }
  }
  const auto apply = [&](std::size_t k) {
    const Eigen::Vector3f change = floatPointAt(change_, k);
    if (change.squaredNorm() > 0) add(values, k, change);
    put(change_, k, Eigen::Vector3f::Zero());
  };
  for (const Contact& c : contacts_) apply(c.point);
  for (const std::uint32_t k : pushed_) apply(k);
}

void SelfContact::moveApart(const PointModel& points, VectorArray& position) {
  for (int pass = 0; pass < kPasses; ++pass)
    balance(
        points, [&](const Contact& c) { return c.keep_m - c.distance(position); }, position);
}

template <class Visit>
void SelfContact::forEachMoved(const Visit& visit) const {
  for (const Contact& c : contacts_) visit(c.point);
  for (const std::uint32_t k : pushed_) visit(k);
}

// From the mean of a point's neighbours to the point.
Eigen::Vector3f SelfContact::standingOut(const VectorArray& position, std::size_t k) const {
  const std::span<const std::uint32_t> neighbors = model_->neighbors[k];
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const std::uint32_t n : neighbors) sum += floatPointAt(position, n);
  return floatPointAt(position, k) - sum / static_cast<float>(neighbors.size());
}

// Takes back what would make the surface rougher than kMostRough allows, whatever the contacts
// want: whole patches may move far, single points may not be torn out of them.
void SelfContact::keepSmooth(VectorArray& position) {
  forEachMoved([&](std::size_t k) {
    const Eigen::Vector3f now = standingOut(position, k);
    const float most = std::max(standingOut(start_, k).norm(),
                                model_->roughAtRest_m[k] + kMostRough * model_->edge_m[k]);
    const float length = now.norm();
    if (length > most) put(change_, k, (most / length - 1) * now);
  });
  forEachMoved([&](std::size_t k) {
    const Eigen::Vector3f change = floatPointAt(change_, k);
    put(change_, k, Eigen::Vector3f::Zero());
    put(position, k, floatPointAt(position, k) + change);
    goNoFarther(k, kMostWay, position);
  });
}

// From where the point was at the start.
void SelfContact::goNoFarther(std::size_t k, float edges, VectorArray& position) const {
  const Eigen::Vector3f before = floatPointAt(start_, k);
  const Eigen::Vector3f way = floatPointAt(position, k) - before;
  const float most = edges * model_->edge_m[k], length = way.norm();
  if (length > most) put(position, k, before + most / length * way);
}

void SelfContact::removeApproach(const PointModel& points, const VectorArray& position,
                                 VectorArray& velocity) {
  const float touching_m = kTouching * model_->gap_m;
  for (int pass = 0; pass < kVelocityPasses; ++pass)
    balance(
        points,
        [&](const Contact& c) {
          const bool touches = c.distance(position) - c.keep_m <= touching_m;
          return touches ? -c.approach(velocity) : 0.f;
        },
        velocity);
}

// The half space ends where the two sides meet if nothing else acts on them: it moves with the
// velocity that they have in common then, and starts from where their shares of the way meet.
void SelfContact::placePlane(Contact& c, const VectorArray& position,
                             const VectorArray& velocity) const {
  const Eigen::Vector3f own = floatPointAt(velocity, c.point);
  c.planeVelocity = own + c.share * (blend(velocity, c.corners, c.weights) - own);
  c.offset_m = c.normal.dot(floatPointAt(position, c.point)) -
               c.share * (c.distance(position) - c.keep_m) - (1 - c.strength) * model_->gap_m;
}

std::size_t SelfContact::flatten(const PointModel& points, const VectorArray& fleshNormal,
                                 VectorArray& position, VectorArray& velocity) {
  std::size_t moved = 0;
  start_ = position;
  for (int pass = 0; pass < kFlatPasses; ++pass) {
    findFaceDown(points, fleshNormal, position);
    if (faceDown_.empty()) break;
    moved = std::max(moved, faceDown_.size());
    for (VectorArray* values : {&position, &velocity}) {
      for (const std::uint32_t k : faceDown_)
        put(change_, k, -kFlatShare * standingOut(*values, k));
      for (const std::uint32_t k : faceDown_) {
        put(*values, k, floatPointAt(*values, k) + floatPointAt(change_, k));
        put(change_, k, Eigen::Vector3f::Zero());
      }
    }
    for (const std::uint32_t k : faceDown_) goNoFarther(k, kMostFlatWay, position);
  }
  return moved;
}

// The free corners of triangles that look into the flesh, and the free points beside them; each
// once, increasing.
void SelfContact::findFaceDown(const PointModel& points, const VectorArray& fleshNormal,
                               const VectorArray& position) {
  faceDown_.clear();
  for (std::size_t t = 0; t < model_->triangleCount(); ++t) {
    const auto [a, b, c] = model_->triangle(t);
    const Eigen::Vector3f outward =
        floatPointAt(fleshNormal, a) + floatPointAt(fleshNormal, b) + floatPointAt(fleshNormal, c);
    const Eigen::Vector3f at = floatPointAt(position, a);
    const Eigen::Vector3f normal =
        (floatPointAt(position, b) - at).cross(floatPointAt(position, c) - at);
    if (normal.dot(outward) >= 0) continue;
    for (const std::uint32_t corner : {a, b, c}) {
      faceDown_.push_back(corner);
      const auto beside = model_->neighbors[corner];
      faceDown_.insert(faceDown_.end(), beside.begin(), beside.end());
    }
  }
  std::ranges::sort(faceDown_);
  faceDown_.erase(std::unique(faceDown_.begin(), faceDown_.end()), faceDown_.end());
  std::erase_if(faceDown_, [&](std::uint32_t k) { return points.free[k] == 0; });
}

void SelfContact::writeHalfSpaces(const VectorArray& position, const VectorArray& velocity,
                                  float interval_s, PointSurroundings& around) const {
  for (const Contact& c : contacts_) {
    const std::size_t k = c.point;
    const Eigen::Vector3f place = floatPointAt(position, k), own = floatPointAt(velocity, k);
    const float way_m = std::max(0.f, c.normal.dot(place) - c.offset_m);
    const Eigen::Vector3f flesh = floatPointAt(around.normal, k);
    if (flesh.squaredNorm() > 0) {
      const float then = way_m + interval_s * c.normal.dot(own - c.planeVelocity);
      const float fleshThen = flesh.dot(place) - around.offset[k] +
                              interval_s * flesh.dot(own - floatPointAt(around.fleshVelocity, k));
      if (fleshThen < 0 || then > fleshThen - kMoreUrgent * model_->gap_m) continue;
    }
    put(around.normal, k, c.normal);
    put(around.fleshVelocity, k, c.planeVelocity);
    around.offset[k] = c.normal.dot(place) - way_m;
  }
}

void SelfContact::forget() {
  for (const Contact& c : contacts_) hasContact_[c.point] = 0;
  for (const std::uint32_t k : pushed_) pushingMass_[k] = 0;
  pushed_.clear();
}

}  // namespace fascia
