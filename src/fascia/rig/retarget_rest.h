#pragma once

#include <span>
#include <vector>

#include <fascia/rig/joint_meaning.h>

namespace fascia {

// Parts of retarget(): two rest poses brought to a common one.

// The map with indices.
struct DrivenJoint {
  int source = -1, target = -1;
  int above = -1;  // the driven joint that holds this one; -1: none
  JointMeaning meaning;
  int run = 1, inRun = 0;  // consecutive joints that share one source, and which of them this is
};

// Axes of a standing figure: x to its left, y up, z forward.
Mat3 figureAxes(std::span<const Transform> world, std::span<const JointMeaning> meanings);

// How far a pose is from standing with straight limbs, in radians; infinite if it cannot be told.
double stanceError_rad(std::span<const Transform> world, std::span<const JointMeaning> meanings);

// The shortest turn of one direction onto another; identity if either is zero.
Mat3 shortestArc(const Vec3& from, const Vec3& to);

struct RestAlignment {
  Mat3 toTarget = Mat3::Identity();  // the source's world turned into the target's
  std::vector<Mat3> turn;            // per driven joint: of the target's bind pose, in the world
  std::vector<Vec3> axis;  // per driven joint: along its source's bone, in the target's world
};

RestAlignment alignRest(std::span<const DrivenJoint> driven, std::span<const Transform> sourceRest,
                        std::span<const JointMeaning> sourceMeanings,
                        std::span<const Transform> targetRest,
                        std::span<const JointMeaning> targetMeanings);

}  // namespace fascia
