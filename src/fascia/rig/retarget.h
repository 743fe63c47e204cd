#pragma once

#include <string>
#include <vector>

#include <fascia/rig/joint_map.h>
#include <fascia/rig/motion_figure.h>

namespace fascia {

// Which of the motion's poses corresponds to the rig's bind pose.
enum class SourceRest {
  automatic,  // the first frame if that is a calibration stance and the file's own rest is none
  bind,       // the file's own rest pose: a BVH's offsets, a rig's bind pose
  firstFrame
};

struct RetargetOptions {
  SourceRest rest = SourceRest::automatic;
  // The figure starts where the rig stands, and its standing feet are as high as the rig's.
  // Otherwise its path is the recorded one, scaled.
  bool startAtRig = true;
  // Legs bend a little so that feet stand where the recorded ones stood: proportions differ, and
  // directions alone let the feet slide.
  bool plantFeet = true;
  // What the source's and the target's files say of their joints (see guessMeanings).
  std::vector<std::string> sourceSaid = {}, said = {};
};

// The motion on the rig, as frames of all its joints. Every driven joint turns in the world as its
// source does, from a common rest pose: in the two rest poses limbs are turned onto each other, so
// that a T-pose drives an A-pose. The path is scaled by the ratio of the legs' lengths. Joints that
// nothing drives keep their place on their parent. Throws Error if the map drives nothing.
SampledMotion retarget(const MotionFigure& source, const RiggedModel& target, const JointMap& map,
                       const RetargetOptions& options = {},
                       std::vector<std::string>* notes = nullptr);

}  // namespace fascia
