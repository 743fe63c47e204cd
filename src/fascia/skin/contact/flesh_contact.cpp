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
// Blocks handed to a thread at once; smaller skins are not worth waking threads for.
constexpr std::size_t kBlocksPerTask = 128;

// One block of points against the solids of a field.
struct BlockTest {
  const DistanceField& field;
  const PointBlock& block;
  ContactLanes& lanes;
  std::span<std::int32_t> nearby;  // scratch for CulledSolids::padded()
  float* gaps = nullptr;           // per solid: no point is nearer than this; updated by visits
  std::size_t nearbyCount = 0;

  bool findSolids(const BlockBox& box, const CulledSolids& solids, float reach) {
    nearbyCount = findNearSolids(box, solids, reach, gaps, nearby.data());
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
      if (gaps) gaps[s] = gap;
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
  void readFleshVelocities(const MovingField& moving, float reach_m) {
    ContactLanes::Lanes3 place, velocity;
    ContactLanes::Lanes<std::int32_t> lane;
    for (const std::int32_t s : nearby.first(nearbyCount)) {
      const std::size_t count =
          packNearest(static_cast<float>(s), reach_m, block.count, lanes, place, lane);
      if (count == 0) continue;
      if (count == block.count) {
        moving.velocity(SolidId(s), lanes.place.view(count), lanes.fleshVelocity.view(count));
        return;
      }
      moving.velocity(SolidId(s), place.view(count), velocity.view(count));
      for (std::size_t i = 0; i < count; ++i) {
        const auto l = static_cast<std::size_t>(lane[i]);
        lanes.fleshVelocity.x[l] = velocity.x[i];
        lanes.fleshVelocity.y[l] = velocity.y[i];
        lanes.fleshVelocity.z[l] = velocity.z[i];
      }
    }
  }
};

void readBoxes(const DistanceField& field, CulledSolids& solids) {
  for (std::size_t s = 0; s < solids.count(); ++s)
    solids.setBox(s, field.bounds(SolidId(static_cast<std::int64_t>(s))));
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
  if (!motions_.follow(field, solids_))
    gaps_.assign(blocks_.size() * solids_.padded(), kUnknownGap_m);
  readBoxes(field, solids_);
  last_.resize(position.size());
  const std::size_t solids = solids_.padded();
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
      float* gaps = gaps_.data() + b * solids;
      ageGaps(motion, solids_, gaps);
      BlockTest test{field, blocks_[b], lanes, scratch, gaps};
      float searched = reach_m, pushed = 0;
      bool any = test.findSolids(box, solids_, searched);
      for (int search = 0; any && search < kSearches; ++search) {
        pushed += test.leaveSolids(kPasses, kRetest_m);
        if (kPushMargin * pushed <= searched) break;
        // Pushed so far that solids beyond the search may have come near.
        std::fill_n(gaps, solids, kUnknownGap_m);
        searched = reach_m + 2 * kPushMargin * pushed;
        any = test.findSolids(box, solids_, searched);
      }
      if (pushed > 0)
        for (std::size_t s = 0; s < solids; ++s) gaps[s] -= kPushMargin * pushed;
      results_[b].maxCorrection_m = pushed;
      if (any) test.readFleshVelocities(field, reach_m);
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
  CulledSolids solids;
  solids.resize(field.solidCount());
  readBoxes(field, solids);
  std::vector<std::int32_t> nearby(solids.padded());
  ContactLanes lanes{};
  float depth = 0;
  for (const PointBlock& block : blocks_) {
    const BlockBox box = loadContactLanes(block, position, points.fat, lanes);
    BlockTest test{field, block, lanes, nearby};
    if (test.findSolids(box, solids, 0)) depth = std::max(depth, test.visit(false));
  }
  return depth;
}

}  // namespace fascia
