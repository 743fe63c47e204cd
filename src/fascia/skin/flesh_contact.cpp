#include <fascia/skin/flesh_contact.h>

#include <algorithm>
#include <cmath>
#include <span>

#include <fascia/base/parallel.h>

namespace fascia {
namespace {

// A projection larger than this makes a block with several solids be tested again.
constexpr float kRetest_m = 1e-5f;
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
  std::size_t nearbyCount = 0;

  bool findSolids(const BlockBox& box, std::span<const Box> boxes, float reach) {
    for (std::size_t s = 0; s < boxes.size(); ++s)
      if (near(box, boxes[s], reach)) nearby[nearbyCount++] = static_cast<std::int32_t>(s);
    return nearbyCount > 0;
  }

  // Visits every nearby solid once, moving points out of it at once. Returns the largest depth.
  float visit(bool move) {
    lanes.nearest.fill(1e30f);
    float deepest = 0;
    for (const std::int32_t s : nearby.first(nearbyCount)) {
      field.evaluate(SolidId(s), lanes.place.view(block.count), lanes.distance.data(),
                     lanes.normal.view(block.count));
      deepest = std::max(deepest, absorbSolid(static_cast<float>(s), move, block.count, lanes));
    }
    return deepest;
  }

  // Like visit(true), until no point is inside any solid or `passes` are used up.
  float leaveSolids(int passes) {
    float deepest = 0;
    for (int pass = 0; pass < passes; ++pass) {
      const float depth = visit(true);
      deepest = std::max(deepest, depth);
      if (depth < kRetest_m || nearbyCount == 1) break;
    }
    return deepest;
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
  const std::size_t tasks = (blocks_.size() + kBlocksPerTask - 1) / kBlocksPerTask;
  nearby_.resize(tasks * boxes_.size());
  parallelFor(tasks, [&](std::size_t t) {
    ContactLanes lanes{};
    const std::span scratch(nearby_.data() + t * boxes_.size(), boxes_.size());
    const std::size_t end = std::min(blocks_.size(), (t + 1) * kBlocksPerTask);
    for (std::size_t b = t * kBlocksPerTask; b < end; ++b) {
      const BlockBox box = loadContactLanes(blocks_[b], position, points.fat, lanes);
      BlockTest test{field, blocks_[b], lanes, scratch};
      const bool any = test.findSolids(box, boxes_, reach_m);
      results_[b].maxCorrection_m = any ? test.leaveSolids(kPasses) : 0;
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
