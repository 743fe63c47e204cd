#pragma once

#include <vector>

#include <fascia/geometry/triangle_mesh.h>
#include <fascia/rig/rigged_model.h>
#include <fascia/skeleton/skeleton.h>

namespace fascia {

// How the bones of a skeleton are drawn, by joint.
struct BoneSizes {
  std::vector<float> ball_m;   // radius at the joint; 0: none
  std::vector<char> hasShaft;  // from the parent to the joint
};

// One size for all.
BoneSizes boneSizes(const Skeleton& skeleton);

// For imported rigs, which are full of joints that are no bones: roots on the floor, handles, twist
// joints on top of others. Only chains that move the surface are drawn, thick as they are long.
// `names`: what the skeleton calls the rig's joints; empty: as the rig does.
BoneSizes boneSizes(const Skeleton& skeleton, const RiggedModel& rig,
                    std::span<const std::string> names = {});

// Every bone of a posed skeleton in one mesh: a shaft with knobs from each parent to its child, and
// a ball at each joint. Has the same triangles in every posture of the same skeleton, also where a
// bone has no length.
TriangleMesh boneMesh(const Skeleton& skeleton, const PosedSkeleton& posed, const BoneSizes& sizes);
inline TriangleMesh boneMesh(const Skeleton& skeleton, const PosedSkeleton& posed) {
  return boneMesh(skeleton, posed, boneSizes(skeleton));
}

}  // namespace fascia
