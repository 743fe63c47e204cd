#pragma once

#include <memory>
#include <vector>

#include <fascia/pose/pose_skin.h>
#include <fascia/skin/mesh/soft_ride.h>
#include <fascia/skin/skin.h>

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

// Scratch memory for carrying points with a pose.
struct CarryScratch {
  VectorArray points;
  std::vector<Transform> motion;
  PoseSkin::Scratch pose;
  VectorArray soft;
};

// Props and soft flesh included, into the first entries of `out`; with `jiggle`, which takes a step
// of dt_s > 0 first.
void evaluateRigged(const RiggedSkin& rigged, const SkinPose& pose, double dt_s,
                    JiggleState* jiggle, CarryScratch& scratch, VectorArray& out);

}  // namespace fascia
