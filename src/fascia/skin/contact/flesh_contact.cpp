#include <fascia/skin/contact/flesh_contact.h>

#include <algorithm>
#include <utility>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>
#include <fascia/skin/contact/way_out.h>

namespace fascia {
namespace {

// Bound of how far a point goes when pushed out, over the sum of the depths: along a crease's flank
// the way is longer than the depth.
constexpr float kPushMargin = 8;
// A solid's distance is an estimate whose error grows with the square of the depth: so far out of
// it a point may be pushed without looking again.
constexpr float kSure_m = 1e-3f;
constexpr float kUnknown = SolidMotions::kUnknown;
// Blocks handed to a thread at once; smaller skins are not worth waking threads for.
constexpr std::size_t kBlocksPerTask = 128;

bool near(const BlockBox& a, const Box& b, float reach) {
  for (int k = 0; k < 3; ++k)
    if (a.low[k] - reach > b.high[k] || a.high[k] + reach < b.low[k]) return false;
  return true;
}

// One block of points against the solids of a field.
struct BlockTest {
  const DistanceField& field;
  const PointBlock& block;
  ContactLanes& lanes;
  std::span<std::int32_t> nearby;  // scratch for as many as the field has solids
  std::span<float> gaps = {};      // per solid: no point is nearer than this; updated by visits
  std::size_t nearbyCount = 0;

  bool findSolids(const BlockBox& box, std::span<const Box> boxes, float reach) {
    nearbyCount = 0;
    for (std::size_t s = 0; s < boxes.size(); ++s)
      if ((gaps.empty() || gaps[s] <= reach) && near(box, boxes[s], reach))
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
      const float gap = absorbSolid(static_cast<float>(s), move, block.count, lanes);
      if (!gaps.empty()) gaps[static_cast<std::size_t>(s)] = gap;
      deepest = std::max(deepest, -gap);
    }
    return deepest;
  }

  // Like visit(true), until no point is inside any solid; what `passes` have not brought out leaves
  // all solids at once. Returns a bound of how far points went: the sum of the passes' depths.
  float leaveSolids(int passes, float retest_m) {
    float moved = 0;
    for (int pass = 0; pass < passes; ++pass) {
      const float depth = visit(true);
      moved += depth;
      const bool again =
          (nearbyCount > 1 && mustRetest(retest_m)) || (depth > kSure_m && depthLeft() > retest_m);
      if (!again) return moved;
    }
    return moved + leaveTogether(retest_m);
  }

  float leaveTogether(float retest_m) {
    float farthest = 0;
    for (std::size_t l = 0; l < block.count; ++l) {
      if (!(lanes.pushed[l] > retest_m)) continue;
      const Eigen::Vector3f from(lanes.place.x[l], lanes.place.y[l], lanes.place.z[l]);
      const Eigen::Vector3f to =
          leaveAll(field, nearby.first(nearbyCount), double{lanes.fat[l]}, from.cast<double>())
              .cast<float>();
      lanes.place.x[l] = to.x(), lanes.place.y[l] = to.y(), lanes.place.z[l] = to.z();
      farthest = std::max(farthest, (to - from).norm());
    }
    return farthest + visit(true);
  }

  // How deep the deepest point is where it has come to; changes nothing that visit() found.
  float depthLeft() const {
    float deepest = 0;
    for (const std::int32_t s : nearby.first(nearbyCount)) {
      field.evaluate(SolidId(s), lanes.place.view(block.count), lanes.distance.data(),
                     lanes.normal.view(block.count));
      for (std::size_t l = 0; l < block.count; ++l)
        deepest = std::max(deepest, lanes.fat[l] - lanes.distance[l]);
    }
    return deepest;
  }

  // Whether a point that was pushed out of one solid may have been pushed into another.
  bool mustRetest(float retest_m) const {
    bool must = false;
    for (std::size_t l = 0; l < block.count; ++l)
      must |= lanes.pushed[l] > retest_m && lanes.clearance[l] < lanes.pushed[l];
    return must;
  }

  // Each point's from its nearest solid: solids that swell take long to say how fast.
  void readFleshVelocities(const MovingField& moving) {
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
      moving.velocity(SolidId(s), place.view(count), velocity.view(count));
      for (std::size_t i = 0; i < count; ++i) {
        lanes.fleshVelocity.x[lane[i]] = velocity.x[i];
        lanes.fleshVelocity.y[lane[i]] = velocity.y[i];
        lanes.fleshVelocity.z[lane[i]] = velocity.z[i];
      }
    }
  }
};

void readBoxes(const DistanceField& field, std::vector<Box>& boxes) {
  boxes.resize(field.solidCount());
  for (std::size_t s = 0; s < boxes.size(); ++s)
    boxes[s] = field.bounds(SolidId(static_cast<std::int64_t>(s)));
}

}  // namespace

FleshContact::FleshContact(std::vector<PointBlock> blocks)
    : blocks_(std::move(blocks)), results_(blocks_.size()) {}

FleshContact::Result FleshContact::project(const MovingField& field, const PointModel& points,
                                           float reach_m, float restitution, VectorArray& position,
                                           VectorArray& velocity, PointSurroundings& around) {
  FASCIA_ASSERT(velocity.size() == position.size() && points.fat.size() == position.size(),
                "a number for each point");
  FASCIA_ASSERT(reach_m >= 0, "a search reaches somewhere");
  readBoxes(field, boxes_);
  last_.resize(position.size());
  const std::size_t solids = boxes_.size();
  if (!motions_.follow(field)) gaps_.assign(blocks_.size() * solids, kUnknown);
  const std::size_t tasks = (blocks_.size() + kBlocksPerTask - 1) / kBlocksPerTask;
  nearby_.resize(tasks * solids);
  parallelFor(tasks, [&](std::size_t t) {
    ContactLanes lanes{};
    const std::span scratch(nearby_.data() + t * solids, solids);
    const std::size_t end = std::min(blocks_.size(), (t + 1) * kBlocksPerTask);
    for (std::size_t b = t * kBlocksPerTask; b < end; ++b) {
      BlockMotion motion;
      const BlockBox box =
          loadContactLanes(blocks_[b], position, points.fat, lanes, &last_, &motion);
      const std::span gaps(gaps_.data() + b * solids, solids);
      for (std::size_t s = 0; s < solids; ++s) gaps[s] = motions_.left(gaps[s], motion, s);
      BlockTest test{field, blocks_[b], lanes, scratch, gaps};
      float searched = reach_m, pushed = 0;
      bool any = test.findSolids(box, boxes_, searched);
      for (int search = 0; any && search < kSearches; ++search) {
        pushed += test.leaveSolids(kPasses, kRetest_m);
        if (kPushMargin * pushed <= searched) break;
        // Pushed so far that solids beyond the search may have come near.
        std::fill(gaps.begin(), gaps.end(), kUnknown);
        searched = reach_m + 2 * kPushMargin * pushed;
        any = test.findSolids(box, boxes_, searched);
      }
      for (float& gap : gaps) gap -= kPushMargin * pushed;
      results_[b].maxCorrection_m = pushed;
      if (any) test.readFleshVelocities(field);
      const std::size_t count = blocks_[b].count;
      const ContactFindings found{lanes.place.view(count), lanes.nearest.data(),
                                  lanes.nearestNormal.view(count), lanes.fleshVelocity.view(count)};
      results_[b].maxSpeed_m_per_s = finishContact(blocks_[b], any, reach_m, restitution, points,
                                                   found, position, velocity, around);
    }
  });
  return largest(results_);
}

float FleshContact::deepest(const DistanceField& field, const PointModel& points,
                            const VectorArray& position) const {
  std::vector<Box> boxes;
  readBoxes(field, boxes);
  std::vector<std::int32_t> nearby(boxes.size());
  ContactLanes lanes{};
  float depth = 0;
  for (const PointBlock& block : blocks_) {
    const BlockBox box = loadContactLanes(block, position, points.fat, lanes);
    BlockTest test{field, block, lanes, nearby};
    if (test.findSolids(box, boxes, 0)) depth = std::max(depth, test.visit(false));
  }
  return depth;
}

}  // namespace fascia
