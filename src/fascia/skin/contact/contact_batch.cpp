#include <fascia/skin/contact/contact_batch.h>

#include <algorithm>
#include <cstring>

#include <fascia/base/assert.h>
#include <fascia/skin/contact/way_out.h>

namespace fascia {
namespace {

constexpr std::size_t kGroupLanes = ContactGroup::kLanes;
// A point that was pushed farther than this may have been pushed into another solid.
constexpr float kRetest_m = 1e-5f;
// Bound of how far a point goes when pushed out, over the sum of the depths: along a crease's flank
// the way is longer than the depth.
constexpr float kPushMargin = 8;
// A solid's distance is an estimate whose error grows with the square of the depth: so far out of
// it a point may be pushed without looking again.
constexpr float kSure_m = 1e-3f;

// Solids are looked for at least this far around points: a point that is pushed out by more than a
// part of it has them looked for again, which costs more.
constexpr float kLeastSearch_m = 1e-3f;

SolidId idOf(std::size_t solid) {
  return SolidId(static_cast<std::int64_t>(solid));
}

}  // namespace

void ContactBatch::load(std::span<const ContactGroup> groups, const VectorArray& position,
                        const FloatArray& fat) {
  FASCIA_ASSERT(!groups.empty() && groups.size() <= kGroups, "a batch has room for its groups");
  groups_ = groups;
  if (asked_.size() == 0) {
    lanes_.resize(kGroups);
    constexpr std::size_t kRoom = (kGroups + 1) * kGroupLanes;
    asked_.resize(kRoom), normal_.resize(kRoom), distance_.resize(kRoom), lane_.resize(kRoom);
    some_.reserve(kGroups);
  }
  loadGroups(groups, position, fat, lanes_, boxes_.data());
  pushed_m_.fill(0);
  PerBlock<char> all;
  all.fill(1);
  mark(all);
}

bool ContactBatch::mark(const PerBlock<char>& chosen) {
  marked_ = chosen;
  const auto marked = std::count_if(chosen.begin(), chosen.begin() + blockCount(),
                                    [](char one) { return one != 0; });
  allMarked_ = static_cast<std::size_t>(marked) == blockCount();
  return marked > 0;
}

float ContactBatch::leaveSolids(const DistanceField& field, const CulledSolids& solids,
                                float reach_m, float* gaps) {
  reach_m = std::max(reach_m, kLeastSearch_m);
  searched_m_.fill(reach_m);
  near_.resize(solids.count(), kGroups);
  findNearSolids({boxes_.data(), groups_.size()}, solids, searched_m_.data(), gaps, near_);
  for (int search = 0; search < kSearches; ++search) {
    leaveInTurn(field, solids.padded(), gaps);
    if (!searchFarther(solids, reach_m, gaps)) break;
  }
  float farthest = 0;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const float pushed = pushed_m_[blockOf(g)];
    if (!(pushed > 0)) continue;
    farthest = std::max(farthest, pushed);
    float* row = gaps + g * solids.padded();
    for (std::size_t s = 0; s < solids.count(); ++s) row[s] -= kPushMargin * pushed;
  }
  return farthest;
}

// Looks again around blocks that were pushed so far that solids beyond the search may have come
// near, and marks them.
bool ContactBatch::searchFarther(const CulledSolids& solids, float reach_m, float* gaps) {
  PerBlock<char> far{};
  for (std::size_t g = 0; g < groups_.size(); ++g)
    far[blockOf(g)] = kPushMargin * pushed_m_[blockOf(g)] > searched_m_[g];
  if (!mark(far)) return false;
  std::array<float, kGroups> wide;
  wide.fill(-1);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (!isMarked(g)) continue;
    searched_m_[g] = wide[g] = reach_m + 2 * kPushMargin * pushed_m_[blockOf(g)];
    std::fill_n(gaps + g * solids.padded(), solids.count(), kUnknownGap_m);
  }
  near_.drop([&](std::uint32_t g) { return isMarked(g); });
  findNearSolids({boxes_.data(), groups_.size()}, solids, wide.data(), nullptr, near_);
  return true;
}

// Visits solids until no marked point is inside any; what passes have not brought out leaves all
// solids at once. Adds bounds of how far points went: the sums of the passes' depths.
void ContactBatch::leaveInTurn(const DistanceField& field, std::size_t stride, float* gaps) {
  for (int pass = 0; pass < kPasses; ++pass) {
    visit(field, stride, gaps);
    if (!mustVisitAgain(field)) return;
  }
  leaveTogether(field);
  visit(field, stride, gaps);
}

// Visits every solid near marked groups once, moving points out of it at once.
void ContactBatch::visit(const DistanceField& field, std::size_t stride, float* gaps) {
  some_.clear();
  for (std::uint32_t g = 0; g < groups_.size(); ++g)
    if (isMarked(g)) some_.push_back(g);
  beginVisit(some_, lanes_);
  depth_m_.fill(0);
  for (std::size_t s = 0; s < near_.solidCount(); ++s) {
    const std::span<const std::uint32_t> near = markedNear(s);
    if (near.empty()) continue;
    const ConstVectors normal = ask(field, s, near);
    absorbSolid({static_cast<float>(s), near, distance_.data(), normal}, groups_,
                searched_m_.data(), lanes_, smallest_.data());
    for (std::size_t n = 0; n < near.size(); ++n) {
      gaps[near[n] * stride + s] = smallest_[n];
      float& depth = depth_m_[blockOf(near[n])];
      depth = std::max(depth, -smallest_[n]);
    }
  }
  for (std::size_t b = 0; b < blockCount(); ++b) pushed_m_[b] += depth_m_[b];
}

// The marked ones of the groups near a solid.
std::span<const std::uint32_t> ContactBatch::markedNear(std::size_t solid) {
  const std::span<const std::uint32_t> all = near_.of(solid);
  if (allMarked_) return all;
  some_.clear();
  for (const std::uint32_t g : all)
    if (isMarked(g)) some_.push_back(g);
  return some_;
}

// Writes distance_. Returns the normals.
ConstVectors ContactBatch::ask(const DistanceField& field, std::size_t solid,
                               std::span<const std::uint32_t> near) {
  const std::size_t count = near.size() * kGroupLanes;
  const Vectors normal = view(normal_, 0, count);
  if (near.size() == groups_.size()) {
    field.evaluate(idOf(solid), view(lanes_.place, 0, count), distance_.data(), normal);
    return normal;
  }
  for (const auto axis : VectorArray::kAxes) {
    const float* from = (lanes_.place.*axis).data();
    float* to = (asked_.*axis).data();
    for (const std::uint32_t g : near) {
      std::memcpy(to, from + g * kGroupLanes, kGroupLanes * sizeof(float));
      to += kGroupLanes;
    }
  }
  field.evaluate(idOf(solid), view(asked_, 0, count), distance_.data(), normal);
  return normal;
}

// Marks the blocks whose points may be inside a solid still: because another has pushed them there,
// or because the way out was long.
bool ContactBatch::mustVisitAgain(const DistanceField& field) {
  PerBlock<char> again{}, deep{};
  std::array<char, kGroups> into;
  findPushed(groups_, kRetest_m, lanes_, into.data());
  for (std::size_t g = 0; g < groups_.size(); ++g)
    if (isMarked(g) && into[g] != 0) again[blockOf(g)] = 1;
  for (std::size_t b = 0; b < blockCount(); ++b)
    deep[b] = marked_[b] != 0 && again[b] == 0 && depth_m_[b] > kSure_m;
  if (mark(deep)) {
    measureDepths(field);
    for (std::size_t b = 0; b < blockCount(); ++b)
      if (left_m_[b] > kRetest_m) again[b] = 1;
  }
  return mark(again);
}

// How deep the deepest point of each marked block is where it has come to.
void ContactBatch::measureDepths(const DistanceField& field) {
  left_m_.fill(0);
  for (std::size_t s = 0; s < near_.solidCount(); ++s) {
    const std::span<const std::uint32_t> near = markedNear(s);
    if (near.empty()) continue;
    ask(field, s, near);
    for (std::size_t n = 0; n < near.size(); ++n) {
      float& left = left_m_[blockOf(near[n])];
      for (std::size_t l = 0; l < groups_[near[n]].count; ++l)
        left =
            std::max(left, lanes_.fat[near[n] * kGroupLanes + l] - distance_[n * kGroupLanes + l]);
    }
  }
}

void ContactBatch::leaveTogether(const DistanceField& field) {
  std::vector<std::int32_t> solids;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (!isMarked(g)) continue;
    solids.clear();
    for (std::size_t s = 0; s < near_.solidCount(); ++s)
      if (std::ranges::any_of(near_.of(s),
                              [&](std::uint32_t n) { return blockOf(n) == blockOf(g); }))
        solids.push_back(static_cast<std::int32_t>(s));
    float farthest = 0;
    VectorArray& place = lanes_.place;
    for (std::size_t i = g * kGroupLanes; i < g * kGroupLanes + groups_[g].count; ++i) {
      if (!(lanes_.pushed[i] > kRetest_m)) continue;
      const Eigen::Vector3f from(place.x[i], place.y[i], place.z[i]);
      const Eigen::Vector3f to =
          leaveAll(field, solids, double{lanes_.fat[i]}, from.cast<double>()).cast<float>();
      place.x[i] = to.x(), place.y[i] = to.y(), place.z[i] = to.z();
      farthest = std::max(farthest, (to - from).norm());
    }
    pushed_m_[blockOf(g)] += farthest;
  }
}

float ContactBatch::deepest(const DistanceField& field, const CulledSolids& solids) {
  searched_m_.fill(0);
  near_.resize(solids.count(), kGroups);
  findNearSolids({boxes_.data(), groups_.size()}, solids, searched_m_.data(), nullptr, near_);
  measureDepths(field);
  return *std::ranges::max_element(left_m_);
}

// Each point's from its nearest solid: solids that swell take long to say how fast.
void ContactBatch::readFleshVelocities(const MovingField& field, float reach_m) {
  for (std::size_t s = 0; s < near_.solidCount(); ++s) {
    const std::span<const std::uint32_t> near = near_.of(s);
    if (near.empty()) continue;
    const std::size_t count = packNearest(static_cast<float>(s), near, groups_, reach_m, lanes_,
                                          view(asked_, 0, asked_.size()), lane_.data());
    if (count == 0) continue;
    const Vectors speed = view(normal_, 0, count);
    field.velocity(idOf(s), view(asked_, 0, count), speed);
    for (std::size_t i = 0; i < count; ++i) {
      const auto l = static_cast<std::size_t>(lane_[i]);
      lanes_.fleshVelocity.x[l] = speed.x[i];
      lanes_.fleshVelocity.y[l] = speed.y[i];
      lanes_.fleshVelocity.z[l] = speed.z[i];
    }
  }
}

float ContactBatch::finish(const MovingField& field, float reach_m, float restitution,
                           const PointModel& points, VectorArray& position, VectorArray& velocity,
                           PointSurroundings& around) {
  readFleshVelocities(field, reach_m);
  std::array<char, kGroups> touched{};
  for (std::size_t s = 0; s < near_.solidCount(); ++s)
    for (const std::uint32_t g : near_.of(s)) touched[g] = 1;
  return finishContact(groups_, touched.data(), reach_m, restitution, points, lanes_, position,
                       velocity, around);
}

}  // namespace fascia
