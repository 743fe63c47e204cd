#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/field/field.h>
#include <fascia/skin/point_kernels.h>
#include <fascia/skin/point_model.h>

namespace fascia {

// Which points feel which solids, where not all feel all: on imported figures, whose limbs pass
// through each other and through the body in many a clip. Masks have an entry per block and solid
// (block * solids + solid), bit l for the block's point l.
struct FleshSense {
  std::vector<std::uint32_t> felt;
  // Of those, the points that other joints move too, so that the pose can drive the solid over
  // them: where their joints alone would carry them deeper than this (per point, in storage order)
  // they no longer feel it. What a clip puts inside of another limb is not torn off.
  std::vector<std::uint32_t> yielding;
  FloatArray yield_m;
};

// Non-penetration of skin and flesh (spec L10, L11): every point keeps the distance of its fat τ
// from every solid. The paper tests the point moved inward along the skin's normal, g(r − τ n) ≥ 0;
// as a distance changes at most as fast as its point moves, d(r) ≥ τ implies that for every n, also
// where the skin folds and its normal is doubtful. Works on blocks of points and knows nothing of
// how points are connected.
class FleshContact {
 public:
  FleshContact() = default;
  // With `sense`, points feel only some of the solids, and yield to those that the pose itself
  // drives over them; it must outlive this. Anchors yield gently: a depth x of the pose becomes a
  // push of x up to the yield, of less the deeper it is, and of 0 beyond three yields.
  enum class Role { points, anchors };
  explicit FleshContact(std::vector<PointBlock> blocks, const FleshSense* sense = nullptr,
                        Role role = Role::points);
  // Takes from the anchors' contact what it found out in the same pose, just before: how solids
  // moved, and which points are carried too deep into them to feel them.
  void follow(const FleshContact& anchors) { anchors_ = &anchors; }

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
  // With a sense, around.carried is read.
  Result project(const Field& field, const PointModel& points, float reach_m, float restitution,
                 VectorArray& position, VectorArray& velocity, PointSurroundings& around);

  // How deep the deepest point is (m, ≥ 0), measured afresh and without changing anything; beyond
  // where the pose wants it.
  float deepest(const Field& field, const PointModel& points, const VectorArray& position,
                const VectorArray& carried = {}) const;

 private:
  static constexpr int kPasses = 16;   // more than creases of three solids need
  static constexpr int kSearches = 4;  // each at least twice as wide as the one before

  std::vector<PointBlock> blocks_;
  const FleshSense* sense_ = nullptr;
  Role role_ = Role::points;
  const FleshContact* anchors_ = nullptr;
  std::vector<std::uint32_t> deep_;  // like FleshSense::yielding: those beyond their yield now
  std::vector<Result> results_;
  std::vector<Box> boxes_;
  std::vector<std::int32_t> nearby_;  // per task: as many as there are solids
  std::vector<float> yields_;         // per task, solid and point of a block; see FleshSense

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
