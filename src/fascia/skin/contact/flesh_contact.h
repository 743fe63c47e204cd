#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <fascia/skin/contact/skin_contact.h>
#include <fascia/skin/contact/solid_motions.h>
#include <fascia/skin/point/point_kernels.h>

namespace fascia {

// Contact of a skin with every solid. Works on blocks of points that lie together.
class FleshContact final : public SkinContact {
 public:
  FleshContact() = default;
  explicit FleshContact(std::vector<PointBlock> blocks);

  // Candidate solids come from boxes of blocks against boxes of solids, and from the gap that was
  // found when a block was last tested against a solid, less the ways both have gone since: solids
  // that cannot have come within reach are not asked again.
  Result project(const MovingField& field, const PointModel& points, float reach_m,
                 float restitution, VectorArray& position, VectorArray& velocity,
                 PointSurroundings& around) override;
  float deepest(const DistanceField& field, const PointModel& points,
                const VectorArray& position) const override;

 private:
  static constexpr int kSearches = 4;  // each at least twice as wide as the one before

  std::vector<PointBlock> blocks_;
  std::vector<Result> results_;
  CulledSolids solids_;
  std::vector<std::int32_t> nearby_;  // per task: solids_.padded()

  // What is known from the last call; it saves work and changes no result.
  VectorArray last_;  // positions
  FloatArray gaps_;   // blocks x solids_.padded(): no point of the block is nearer
  SolidMotions motions_;
};

}  // namespace fascia
