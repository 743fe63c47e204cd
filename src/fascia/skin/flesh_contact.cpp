#include <fascia/skin/flesh_contact.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <fascia/base/parallel.h>

namespace fascia {
namespace {

// Only a projection larger than this makes a block with several solids be tested again.
constexpr float kRetest_m = 1e-5f;
// Bound of how far a point goes when pushed out, over the sum of the depths: along a crease's flank
// the way is longer than the depth.
constexpr float kPushMargin = 8;
// Gap of a block and a solid that have not been tested yet.
constexpr float kUnknown = -1e30f;
// Blocks handed to a thread at once; smaller skins are not worth waking threads for.
constexpr std::size_t kBlocksPerTask = 128;

bool near(const BlockBox& a, const Box& b, float reach) {
  for (int k = 0; k < 3; ++k)
    if (a.low[k] - reach > b.high[k] || a.high[k] + reach < b.low[k]) return false;
  return true;
}

// Of what is not felt: far away.
constexpr float kFarAway = 1e30f;

// One block of points against the solids of a field.
struct BlockTest {
  const Field& field;
  const PointBlock& block;
  ContactLanes& lanes;
  std::span<std::int32_t> nearby;  // scratch for as many as the field has solids
  std::span<float> gaps = {};      // per solid: no point is nearer than this; updated by visits
  const std::uint32_t* felt = nullptr;        // per solid: which points feel it; null: all do
  const std::uint32_t* yielding = nullptr;    // per solid: see FleshSense
  std::span<float> yields = {};               // scratch: per solid and point; empty: none known
  std::uint32_t* deep = nullptr;              // per solid: written with the yields
  const std::uint32_t* overlooked = nullptr;  // per solid: points that do not feel it now
  std::size_t nearbyCount = 0;

  bool findSolids(const BlockBox& box, std::span<const Box> boxes, float reach) {
    nearbyCount = 0;
    for (std::size_t s = 0; s < boxes.size(); ++s)
      if ((gaps.empty() || gaps[s] <= reach) && (!felt || felt[s] != 0) &&
          near(box, boxes[s], reach))
        nearby[nearbyCount++] = static_cast<std::int32_t>(s);
    return nearbyCount > 0;
  }

  // Visits every nearby solid once, moving points out of it at once. Returns the largest depth.
  float visit(bool move) {
    lanes.nearest.fill(1e30f);
    lanes.clearance.fill(1e30f);
    lanes.pushed.fill(0.f);
    float deepest = 0;
    for (const std::int32_t s : nearby.first(nearbyCount)) {
      field.evaluate(SolidId(s), lanes.place.view(block.count), lanes.distance.data(),
                     lanes.normal.view(block.count));
      const float yielded = felt ? soften(static_cast<std::size_t>(s)) : 0;
      const float gap = absorbSolid(static_cast<float>(s), move, block.count, lanes);
      if (!gaps.empty()) gaps[static_cast<std::size_t>(s)] = gap - yielded;
      deepest = std::max(deepest, -gap);
    }
    return deepest;
  }

  // What a solid is to points that do not feel it, or yield to it: farther away. Returns the most
  // by which it was moved away from a point that feels it.
  float soften(std::size_t solid) {
    const std::uint32_t feeling = felt[solid] & ~(overlooked ? overlooked[solid] : 0);
    const std::uint32_t yielded = yields.empty() ? 0 : yielding[solid];
    if (feeling == ~std::uint32_t{0} && yielded == 0) return 0;
    const float* yield = yieldsOf(solid);
    float most = 0;
    for (std::size_t l = 0; l < block.count; ++l) {
      if (!(feeling >> l & 1u)) {
        lanes.distance[l] = kFarAway;
      } else if (yielded >> l & 1u) {
        lanes.distance[l] += yield[l];
        most = std::max(most, yield[l]);
      }
    }
    return overlooked && overlooked[solid] != 0 ? kFarAway : most;  // felt again at any time
  }

  // How far each point yields to the nearby solids, see FleshSense.
  using Role = FleshContact::Role;
  void findYields(const VectorArray& carried, const FloatArray& yield_m, Role role) {
    for (const std::int32_t n : nearby.first(nearbyCount)) {
      const auto s = static_cast<std::size_t>(n);
      if (yielding[s] == 0) continue;
      field.evaluate(SolidId(n), view(carried, block.first, block.count), lanes.distance.data(),
                     lanes.normal.view(block.count));
      float* ofPoint = yieldsOf(s);
      std::uint32_t beyond = 0;
      for (std::size_t l = 0; l < block.count; ++l) {
        const float depth = lanes.fat[l] - lanes.distance[l], yield = yield_m[block.first + l];
        beyond |= depth > yield ? std::uint32_t{1} << l : 0;
        const float push = yield - 0.5f * (depth - yield);
        ofPoint[l] = depth <= yield                      ? 0
                     : role == Role::anchors && push > 0 ? depth - push
                                                         : kFarAway;
      }
      if (deep) deep[s] = beyond & yielding[s];
    }
  }
  float* yieldsOf(std::size_t solid) { return yields.data() + solid * PointBlock::kCapacity; }

  // Like visit(true), until no point is inside any solid or `passes` are used up. Returns the sum
  // of the passes' depths.
  float leaveSolids(int passes) {
    float moved = 0;
    for (int pass = 0; pass < passes; ++pass) {
      const float depth = visit(true);
      moved += depth;
      if (nearbyCount == 1 || !mustRetest()) break;
    }
    return moved;
  }

  // Whether a point that was pushed out of one solid may have been pushed into another.
  bool mustRetest() const {
    bool must = false;
    for (std::size_t l = 0; l < block.count; ++l)
      must |= lanes.pushed[l] > kRetest_m && lanes.clearance[l] < lanes.pushed[l];
    return must;
  }

  // Each point's from its nearest solid: solids that swell take long to say how fast.
  void readFleshVelocities() {
    ContactLanes::Lanes3 place, velocity;
    std::array<std::size_t, PointBlock::kCapacity> lane;
    for (const std::int32_t s : nearby.first(nearbyCount)) {
      std::size_t count = 0;
      for (std::size_t l = 0; l < block.count; ++l) {
        if (lanes.nearestSolid[l] != static_cast<float>(s)) continue;
        place.x[count] = lanes.place.x[l];
        place.y[count] = lanes.place.y[l];
        place.z[count] = lanes.place.z[l];
        lane[count++] = l;
      }
      if (count == 0) continue;
      field.velocity(SolidId(s), place.view(count), velocity.view(count));
      for (std::size_t i = 0; i < count; ++i) {
        lanes.fleshVelocity.x[lane[i]] = velocity.x[i];
        lanes.fleshVelocity.y[lane[i]] = velocity.y[i];
        lanes.fleshVelocity.z[lane[i]] = velocity.z[i];
      }
    }
  }
};

constexpr std::size_t kCorners = 8;

Eigen::Vector3f get(const VectorArray& a, std::size_t k) {
  return {a.x[k], a.y[k], a.z[k]};
}
void put(VectorArray& a, std::size_t k, const Eigen::Vector3f& p) {
  a.x[k] = p.x(), a.y[k] = p.y(), a.z[k] = p.z();
}

void readBoxes(const Field& field, std::vector<Box>& boxes) {
  boxes.resize(field.solidCount());
  for (std::size_t s = 0; s < boxes.size(); ++s)
    boxes[s] = field.bounds(SolidId(static_cast<std::int64_t>(s)));
}

}  // namespace

FleshContact::FleshContact(std::vector<PointBlock> blocks, const FleshSense* sense, Role role)
    : blocks_(std::move(blocks)), sense_(sense), role_(role), results_(blocks_.size()) {}

FleshContact::Result FleshContact::project(const Field& field, const PointModel& points,
                                           float reach_m, float restitution, VectorArray& position,
                                           VectorArray& velocity, PointSurroundings& around) {
  readBoxes(field, boxes_);
  followSolids(field);
  last_.resize(position.size());
  const std::size_t solids = boxes_.size();
  const std::size_t tasks = (blocks_.size() + kBlocksPerTask - 1) / kBlocksPerTask;
  nearby_.resize(tasks * solids);
  const std::size_t yieldsPerTask = sense_ && !anchors_ ? solids * PointBlock::kCapacity : 0;
  if (role_ == Role::anchors) deep_.assign(blocks_.size() * solids, 0);
  yields_.resize(tasks * yieldsPerTask);
  parallelFor(tasks, [&](std::size_t t) {
    ContactLanes lanes{};
    const std::span scratch(nearby_.data() + t * solids, solids);
    const std::size_t end = std::min(blocks_.size(), (t + 1) * kBlocksPerTask);
    for (std::size_t b = t * kBlocksPerTask; b < end; ++b) {
      BlockMotion motion;
      const BlockBox box =
          loadContactLanes(blocks_[b], position, points.fat, lanes, &last_, &motion);
      const std::span gaps(gaps_.data() + b * solids, solids);
      for (std::size_t s = 0; s < solids; ++s) {
        // Also what is not a number makes a gap unknown.
        const float nearer = approach(motion, motions_[s]);
        gaps[s] = nearer < -kUnknown ? gaps[s] - nearer : kUnknown;
      }
      BlockTest test{field, blocks_[b], lanes, scratch, gaps};
      if (sense_) {
        const std::size_t first = b * solids;
        test.felt = (role_ == Role::anchors ? sense_->yielding : sense_->felt).data() + first;
        test.yielding = sense_->yielding.data() + first;
        if (anchors_) test.overlooked = anchors_->deep_.data() + first;
        if (role_ == Role::anchors) test.deep = deep_.data() + first;
        if (yieldsPerTask > 0)
          test.yields = std::span(yields_).subspan(t * yieldsPerTask, yieldsPerTask);
      }
      float searched = reach_m, pushed = 0;
      bool any = test.findSolids(box, boxes_, searched);
      for (int search = 0; any && search < kSearches; ++search) {
        if (yieldsPerTask > 0) test.findYields(around.carried, sense_->yield_m, role_);
        pushed += test.leaveSolids(kPasses);
        if (kPushMargin * pushed <= searched) break;
        // Pushed so far that solids beyond the search may have come near.
        std::fill(gaps.begin(), gaps.end(), kUnknown);
        searched = reach_m + 2 * kPushMargin * pushed;
        any = test.findSolids(box, boxes_, searched);
      }
      for (float& gap : gaps) gap -= kPushMargin * pushed;
      results_[b].maxCorrection_m = pushed;
      if (any && role_ == Role::points) test.readFleshVelocities();
      results_[b].maxSpeed_m_per_s = finishContact(blocks_[b], any, reach_m, restitution, points,
                                                   lanes, position, velocity, around);
    }
  });

  Result total;
  for (const Result& r : results_) {
    total.maxCorrection_m = std::max(total.maxCorrection_m, r.maxCorrection_m);
    total.maxSpeed_m_per_s = std::max(total.maxSpeed_m_per_s, r.maxSpeed_m_per_s);
  }
  total.maxSpeed_m_per_s = std::sqrt(total.maxSpeed_m_per_s);
  return total;
}

// How much nearer a block and a solid can have come: the difference of their points' ways at the
// block's centre, and how much the ways differ over the block.
float FleshContact::approach(const BlockMotion& block, const SolidMotion& solid) {
  const Eigen::Vector3f center(block.center[0], block.center[1], block.center[2]);
  const Eigen::Vector3f way(block.way[0], block.way[1], block.way[2]);
  const Eigen::Vector3f matter = solid.change * (center - solid.origin) + solid.shift;
  return (way - matter).norm() + block.spread_m + solid.turn * block.radius_m + solid.extra_m;
}

// The motion of each solid since the last call, from eight material points around it.
void FleshContact::followSolids(const Field& field) {
  const std::size_t solids = boxes_.size();
  const bool first = motions_.size() != solids;
  if (first) gaps_.assign(blocks_.size() * solids, kUnknown);
  if (anchors_) {
    motions_ = anchors_->motions_;
    return;
  }
  if (first) {
    motions_.resize(solids);
    corners_.resize(solids * kCorners);
    cornersNow_.resize(kCorners);
    cornerMaterial_.resize(solids * kCorners);
    for (std::size_t k = 0; k < solids * kCorners; ++k) {
      const SolidId solid(static_cast<std::int64_t>(k / kCorners));
      const Box& box = boxes_[solid.index()];
      const Vec3 corner((k & 1 ? box.high : box.low).x(), (k & 2 ? box.high : box.low).y(),
                        (k & 4 ? box.high : box.low).z());
      put(cornerMaterial_, k, field.materialFromWorld(solid, corner).cast<float>());
      put(corners_, k, corner.cast<float>());
    }
  }
  for (std::size_t s = 0; s < solids; ++s) {
    field.worldFromMaterials(SolidId(static_cast<std::int64_t>(s)),
                             view(std::as_const(cornerMaterial_), s * kCorners, kCorners),
                             view(cornersNow_, 0, kCorners));
    motions_[s] = motionOf(s * kCorners);
    for (std::size_t c = 0; c < kCorners; ++c) put(corners_, s * kCorners + c, get(cornersNow_, c));
  }
}

FleshContact::SolidMotion FleshContact::motionOf(std::size_t firstCorner) const {
  const auto before = [&](std::size_t c) { return get(corners_, firstCorner + c); };
  SolidMotion m;
  Eigen::Matrix3f edges, edgesNow;
  for (int a = 0; a < 3; ++a) {
    edges.col(a) = before(std::size_t{1} << a) - before(0);
    edgesNow.col(a) = get(cornersNow_, std::size_t{1} << a) - get(cornersNow_, 0);
  }
  const Eigen::Matrix3f map = edgesNow * edges.inverse();
  m.change = map - Eigen::Matrix3f::Identity();
  m.origin = before(0);
  m.shift = get(cornersNow_, 0) - before(0);
  m.turn = m.change.norm();
  // Distances change where the map is not rigid, and where the corners do not follow it.
  const float size = (before(kCorners - 1) - before(0)).norm();
  m.extra_m = 2 * size * (map.transpose() * map - Eigen::Matrix3f::Identity()).norm();
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Eigen::Vector3f way = m.change * (before(c) - m.origin) + m.shift;
    m.extra_m += (get(cornersNow_, c) - before(c) - way).norm();
  }
  // A box without volume has no map: nothing is known then.
  if (!std::isfinite(m.turn) || !std::isfinite(m.extra_m)) {
    m = {Eigen::Matrix3f::Zero(), m.origin, m.shift, 0, -kUnknown};
  }
  return m;
}

float FleshContact::deepest(const Field& field, const PointModel& points,
                            const VectorArray& position, const VectorArray& carried) const {
  std::vector<Box> boxes;
  readBoxes(field, boxes);
  std::vector<std::int32_t> nearby(boxes.size());
  std::vector<float> yields(sense_ ? boxes.size() * PointBlock::kCapacity : 0);
  ContactLanes lanes{};
  float depth = 0;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const BlockBox box = loadContactLanes(blocks_[b], position, points.fat, lanes);
    BlockTest test{field, blocks_[b], lanes, nearby};
    if (sense_) {
      test.felt = sense_->felt.data() + b * boxes.size();
      test.yielding = sense_->yielding.data() + b * boxes.size();
      test.yields = yields;
    }
    const bool any = test.findSolids(box, boxes, 0);
    if (any && sense_) test.findYields(carried, sense_->yield_m, role_);
    if (any) depth = std::max(depth, test.visit(false));
  }
  return depth;
}

}  // namespace fascia
