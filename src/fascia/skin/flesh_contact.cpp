#include <fascia/skin/flesh_contact.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <fascia/base/parallel.h>

namespace fascia {
namespace {

// A projection larger than this makes a block with several solids be tested again.
constexpr float kRetest_m = 1e-5f;
// Bound of how far a point goes when pushed out, over the sum of the depths: along a crease's flank
// the way is longer than the depth.
constexpr float kPushMargin = 8;
// Allowance for solids that swell or bend while they move, which is not quite affine.
constexpr float kSwellMargin = 1.5f;
// Gap of a block and a solid that have not been tested yet.
constexpr float kUnknown = -1e30f;
// Blocks handed to a thread at once; smaller skins are not worth waking threads for.
constexpr std::size_t kBlocksPerTask = 128;

bool near(const BlockBox& a, const Box& b, float reach) {
  for (int k = 0; k < 3; ++k)
    if (a.low[k] - reach > b.high[k] || a.high[k] + reach < b.low[k]) return false;
  return true;
}

// One block of points against the solids of a field.
struct BlockTest {
  const Field& field;
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

  // Like visit(true), until no point is inside any solid or `passes` are used up. Returns the sum
  // of the passes' depths.
  float leaveSolids(int passes) {
    float moved = 0;
    for (int pass = 0; pass < passes; ++pass) {
      const float depth = visit(true);
      moved += depth;
      if (depth < kRetest_m || nearbyCount == 1) break;
    }
    return moved;
  }

  void readFleshVelocities() {
    ContactLanes::Lanes3 velocity;
    for (const std::int32_t s : nearby.first(nearbyCount)) {
      const auto solid = static_cast<float>(s);
      const auto end = lanes.nearestSolid.begin() + block.count;
      if (std::find(lanes.nearestSolid.begin(), end, solid) == end) continue;
      field.velocity(SolidId(s), lanes.place.view(block.count), velocity.view(block.count));
      absorbVelocity(solid, velocity, lanes);
    }
  }
};

void readBoxes(const Field& field, std::vector<Box>& boxes) {
  boxes.resize(field.solidCount());
  for (std::size_t s = 0; s < boxes.size(); ++s)
    boxes[s] = field.bounds(SolidId(static_cast<std::int64_t>(s)));
}

}  // namespace

FleshContact::FleshContact(std::vector<PointBlock> blocks)
    : blocks_(std::move(blocks)), results_(blocks_.size()) {}

FleshContact::Result FleshContact::project(const Field& field, const PointModel& points,
                                           float reach_m, float restitution, VectorArray& position,
                                           VectorArray& velocity, PointSurroundings& around) {
  readBoxes(field, boxes_);
  followSolids(field);
  last_.resize(position.size());
  const std::size_t solids = boxes_.size();
  const std::size_t tasks = (blocks_.size() + kBlocksPerTask - 1) / kBlocksPerTask;
  nearby_.resize(tasks * solids);
  parallelFor(tasks, [&](std::size_t t) {
    ContactLanes lanes{};
    const std::span scratch(nearby_.data() + t * solids, solids);
    const std::size_t end = std::min(blocks_.size(), (t + 1) * kBlocksPerTask);
    for (std::size_t b = t * kBlocksPerTask; b < end; ++b) {
      float moved = 0;
      const BlockBox box =
          loadContactLanes(blocks_[b], position, points.fat, lanes, &last_, &moved);
      const std::span gaps(gaps_.data() + b * solids, solids);
      for (std::size_t s = 0; s < solids; ++s) gaps[s] -= moved + solidMoved_[s];
      BlockTest test{field, blocks_[b], lanes, scratch, gaps};
      float searched = reach_m, pushed = 0;
      bool any = test.findSolids(box, boxes_, searched);
      for (int search = 0; any && search < kSearches; ++search) {
        pushed += test.leaveSolids(kPasses);
        if (kPushMargin * pushed <= searched) break;
        // Pushed so far that solids beyond the search may have come near.
        std::fill(gaps.begin(), gaps.end(), kUnknown);
        searched = reach_m + 2 * kPushMargin * pushed;
        any = test.findSolids(box, boxes_, searched);
      }
      for (float& gap : gaps) gap -= kPushMargin * pushed;
      results_[b].maxCorrection_m = pushed;
      if (any) test.readFleshVelocities();
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

// How far the matter of each solid can have moved since the last call, by eight material points
// around it: motions are affine in them, or nearly so.
void FleshContact::followSolids(const Field& field) {
  constexpr std::size_t kCorners = 8;
  const std::size_t solids = boxes_.size();
  const bool first = solidMoved_.size() != solids;
  if (first) {
    solidMoved_.assign(solids, 0.f);
    gaps_.assign(blocks_.size() * solids, kUnknown);
    corners_.resize(solids * kCorners);
    cornersNow_.resize(kCorners);
    cornerMaterial_.resize(solids * kCorners);
  }
  for (std::size_t s = 0; s < solids; ++s) {
    const SolidId solid(static_cast<std::int64_t>(s));
    for (std::size_t c = 0; first && c < kCorners; ++c) {
      const Vec3 corner((c & 1 ? boxes_[s].high : boxes_[s].low).x(),
                        (c & 2 ? boxes_[s].high : boxes_[s].low).y(),
                        (c & 4 ? boxes_[s].high : boxes_[s].low).z());
      const Eigen::Vector3f material = field.materialFromWorld(solid, corner).cast<float>();
      cornerMaterial_.x[s * kCorners + c] = material.x();
      cornerMaterial_.y[s * kCorners + c] = material.y();
      cornerMaterial_.z[s * kCorners + c] = material.z();
    }
    field.worldFromMaterials(solid, view(std::as_const(cornerMaterial_), s * kCorners, kCorners),
                             view(cornersNow_, 0, kCorners));
    float farthest = 0;
    for (std::size_t c = 0; c < kCorners; ++c) {
      const std::size_t k = s * kCorners + c;
      const float x = cornersNow_.x[c] - corners_.x[k], y = cornersNow_.y[c] - corners_.y[k],
                  z = cornersNow_.z[c] - corners_.z[k];
      farthest = std::max(farthest, x * x + y * y + z * z);
      corners_.x[k] = cornersNow_.x[c];
      corners_.y[k] = cornersNow_.y[c];
      corners_.z[k] = cornersNow_.z[c];
    }
    solidMoved_[s] = kSwellMargin * std::sqrt(farthest);
  }
}

float FleshContact::deepest(const Field& field, const PointModel& points,
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
