#pragma once

#include <memory>
#include <vector>

#include <fascia/pose/pose_skin.h>
#include <fascia/skin/mesh/soft_ride.h>
#include <fascia/skin/point/skin_attachment.h>

namespace fascia {

// The pose function of an imported mesh, on a character's skeleton.
struct RiggedSkin {
  struct Joint {
    std::size_t skeletonJoint;
    Transform inverseRest;
  };
  std::shared_ptr<const PoseSkin> skin;
  std::vector<Joint> joints;    // of the rig
  std::size_t fleshSolids = 0;  // solids of a pose's field beyond these stand around the figure
  SoftRide soft;                // of the flesh that is soft
};

// Scratch memory of evaluateRigged.
struct RiggedScratch {
  std::vector<Transform> motion;
  PoseSkin::Scratch pose;
  VectorArray soft;
};

// Props and soft flesh included, into the first entries of `out`; with `jiggle`, which takes a step
// of dt_s > 0 first.
void evaluateRigged(const RiggedSkin& rigged, const SkinPose& pose, double dt_s,
                    JiggleState* jiggle, RiggedScratch& scratch, VectorArray& out);

// A simulated mesh hangs where its pose function has it.
class MeshAttachment final : public SkinAttachment {
 public:
  // `sag`: how far a point's weight stretches its strand, zero where it has none; `fixed`: storage
  // indices of the points that are not simulated.
  MeshAttachment(std::shared_ptr<const RiggedSkin> rigged, VectorArray sag, std::size_t pointCount,
                 std::vector<std::size_t> fixed);

  const RiggedSkin& rigged() const { return *rigged_; }
  const VectorArray& sag() const { return sag_; }
  std::size_t pointCount() const { return pointCount_; }
  const std::vector<std::size_t>& fixed() const { return fixed_; }

  std::unique_ptr<PointPlacer> makePlacer() const override;

 private:
  std::shared_ptr<const RiggedSkin> rigged_;
  VectorArray sag_;
  std::size_t pointCount_;
  std::vector<std::size_t> fixed_;
};

}  // namespace fascia
