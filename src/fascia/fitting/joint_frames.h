#pragma once

#include <vector>

#include <fascia/fitting/rest_surface.h>
#include <fascia/fitting/symmetry.h>

namespace fascia {

// How a joint's bone lies, in the rest pose.
struct BoneFrame {
  Transform world;            // x = axis of the main bend, positive = flexion; y along the bone
  int mainChild = -1;         // the joint that the bone leads to
  Vec3 end_m = Vec3::Zero();  // of the bone; for joints without a main child where its points end
  double length_m = 0;
};

std::vector<BoneFrame> findBoneFrames(const RiggedModel& model, const RestSurface& surface,
                                      const Symmetry& symmetry);

// The rig's joints with these frames, free in all six ways.
SkeletonDef makeSkeleton(const RiggedModel& model, const std::vector<BoneFrame>& frames);

}  // namespace fascia
