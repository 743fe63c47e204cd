#pragma once

#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/field/field.h>
#include <fascia/skin/point_kernels.h>
#include <fascia/skin/point_model.h>

namespace fascia {

// Non-penetration of skin and flesh (spec L10, L11): every point keeps the distance of its fat τ
// from every solid. The paper tests the point moved inward along the skin's normal, g(r − τ n) ≥ 0;
// as a distance changes at most as fast as its point moves, d(r) ≥ τ implies that for every n, also
// where the skin folds and its normal is doubtful. Works on blocks of points and knows nothing of
// how points are connected.
class FleshContact {
 public:
  FleshContact() = default;
  explicit FleshContact(std::vector<PointBlock> blocks);

  struct Result {
    float maxCorrection_m = 0;
    float maxSpeed_m_per_s = 0;  // relative to the anchors
  };

  // Projects points out of the solids exactly, removes the approaching part of their velocity
  // relative to the flesh, and writes each point's half space (normal, offset, flesh velocity) for
  // the steps that follow: the nearest solid within `reach_m`.
  // Candidate solids come from boxes of blocks against boxes of solids, and from the gap that was
  // found when a block was last tested against a solid, less the ways both have gone since: solids
  // that cannot have come within reach are not asked again. A point in several solids is projected
  // in turn until it is outside of all, or kPasses are used up.
  Result project(const Field& field, const PointModel& points, float reach_m, float restitution,
                 VectorArray& position, VectorArray& velocity, PointSurroundings& around);

  // How deep the deepest point is (m, ≥ 0), measured afresh and without changing anything.
  float deepest(const Field& field, const PointModel& points, const VectorArray& position) const;

 private:
  static constexpr int kPasses = 16;   // more than creases of three solids need
  static constexpr int kSearches = 4;  // each at least twice as wide as the one before

  std::vector<PointBlock> blocks_;
  std::vector<Result> results_;
  std::vector<Box> boxes_;
  std::vector<std::int32_t> nearby_;  // per task: as many as there are solids

  // What is known from the last call; it saves work and changes no result.
  VectorArray last_;         // positions
  std::vector<float> gaps_;  // blocks x solids: no point of the block is nearer
  // A solid's motion since the last call as an affine map: x goes by change (x − origin) + shift.
  struct SolidMotion {
    Eigen::Matrix3f change;
    Eigen::Vector3f origin, shift;
    float turn;     // norm of change
    float extra_m;  // what is not rigid: swelling and bending
  };
  static float approach(const BlockMotion& block, const SolidMotion& solid);
  void followSolids(const Field& field);
  SolidMotion motionOf(std::size_t firstCorner) const;
  std::vector<SolidMotion> motions_;
  VectorArray corners_, cornersNow_, cornerMaterial_;  // eight points around each solid
};

}  // namespace fascia
