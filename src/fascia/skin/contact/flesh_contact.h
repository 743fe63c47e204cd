#pragma once

#include <span>
#include <vector>

#include <fascia/skin/contact/contact_batch.h>
#include <fascia/skin/contact/skin_contact.h>
#include <fascia/skin/contact/solid_motions.h>

namespace fascia {

// Contact of a skin with every solid. Works on groups of points that lie together.
class FleshContact final : public SkinContact {
 public:
  FleshContact() = default;
  explicit FleshContact(std::span<const PointBlock> blocks);

  // Candidate solids come from boxes of groups against boxes of solids, and from the gap that was
  // found when a group was last tested against a solid, less the ways both have gone since: solids
  // that cannot have come within reach are not asked again.
  Result project(const MovingField& field, const PointModel& points, float reach_m,
                 float restitution, VectorArray& position, VectorArray& velocity,
                 PointSurroundings& around) override;
  float deepest(const DistanceField& field, const PointModel& points,
                const VectorArray& position) const override;

 private:
  struct Batch {
    std::size_t first, count;  // of groups_
  };

  std::vector<ContactGroup> groups_;
  std::vector<Batch> batches_;
  std::vector<Result> results_;        // per batch
  std::vector<ContactBatch> scratch_;  // per task
  CulledSolids solids_;

  // What is known from the last call; it saves work and changes no result.
  VectorArray last_;  // positions
  FloatArray gaps_;   // groups x solids_.padded(): no point of the group is nearer
  SolidMotions motions_;
};

}  // namespace fascia
