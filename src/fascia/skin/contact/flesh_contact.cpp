#include <fascia/skin/contact/flesh_contact.h>

#include <algorithm>
#include <utility>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>

namespace fascia {
namespace {

// Batches handed to a thread at once; smaller skins are not worth waking threads for.
constexpr std::size_t kBatchesPerTask = 4;

void readBoxes(const DistanceField& field, CulledSolids& solids) {
  for (std::size_t s = 0; s < solids.count(); ++s)
    solids.setBox(s, field.bounds(SolidId(static_cast<std::int64_t>(s))));
}

}  // namespace

FleshContact::FleshContact(std::span<const PointBlock> blocks) {
  static_assert(PointBlock::kCapacity <= ContactBatch::kGroups * ContactGroup::kLanes);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const std::size_t first = groups_.size();
    for (std::uint32_t i = 0; i < blocks[b].count; i += ContactGroup::kLanes)
      groups_.push_back({blocks[b].first + i,
                         std::min<std::uint32_t>(ContactGroup::kLanes, blocks[b].count - i),
                         static_cast<std::uint32_t>(b)});
    if (batches_.empty() || groups_.size() - batches_.back().first > ContactBatch::kGroups)
      batches_.push_back({first, 0});
    batches_.back().count = groups_.size() - batches_.back().first;
  }
  results_.resize(batches_.size());
  scratch_.resize((batches_.size() + kBatchesPerTask - 1) / kBatchesPerTask);
}

FleshContact::Result FleshContact::project(const MovingField& field, const PointModel& points,
                                           float reach_m, float restitution, VectorArray& position,
                                           VectorArray& velocity, PointSurroundings& around) {
  FASCIA_ASSERT(velocity.size() == position.size() && points.fat.size() == position.size(),
                "a number for each point");
  FASCIA_ASSERT(reach_m >= 0, "a search reaches somewhere");
  if (!motions_.follow(field, solids_))
    gaps_.assign(groups_.size() * solids_.padded(), kUnknownGap_m);
  readBoxes(field, solids_);
  last_.resize(position.size());
  parallelFor(scratch_.size(), [&](std::size_t t) {
    ContactBatch& batch = scratch_[t];
    const std::size_t end = std::min(batches_.size(), (t + 1) * kBatchesPerTask);
    for (std::size_t b = t * kBatchesPerTask; b < end; ++b) {
      const auto groups = std::span(groups_).subspan(batches_[b].first, batches_[b].count);
      float* gaps = gaps_.data() + batches_[b].first * solids_.padded();
      ageGaps(groups, position, solids_, last_, gaps);
      batch.load(groups, position, points.fat);
      results_[b].maxCorrection_m = batch.leaveSolids(field, solids_, reach_m, gaps);
      results_[b].maxSpeed_m_per_s =
          batch.finish(field, reach_m, restitution, points, position, velocity, around);
    }
  });
  return largest(results_);
}

float FleshContact::deepest(const DistanceField& field, const PointModel& points,
                            const VectorArray& position) const {
  CulledSolids solids;
  solids.resize(field.solidCount());
  readBoxes(field, solids);
  ContactBatch batch;
  float depth = 0;
  for (const Batch& b : batches_) {
    batch.load(std::span(groups_).subspan(b.first, b.count), position, points.fat);
    depth = std::max(depth, batch.deepest(field, solids));
  }
  return depth;
}

}  // namespace fascia
