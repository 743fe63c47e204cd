#pragma once

#include <optional>
#include <string>
#include <vector>

#include <fascia/rig/hinge.h>

namespace fascia {

// What poses of single joints try: elbows and knees bend, the others do what they do farthest.
enum class PoseGroup { bends, hips, shoulders, wrists, neck };

// One joint turned from the bind pose about one axis; everything below it goes along.
struct JointPose {
  PoseGroup group = PoseGroup::bends;
  std::string name;  // for people: "LeftLeg bent to 90°"
  std::size_t joint = 0;
  Vec3 axis = Vec3::UnitX();  // unit, world
  double turn_rad = 0;
  double angle_rad = 0;        // the one that the name tells
  bool twist = false;          // about the limb's own axis, or else across it
  std::optional<Hinge> hinge;  // of bends
};

// The poses that a rig can show, on its left side:
// - bends: its hinges (see findHinges) at these angles between the segments;
// - of upright bodies whose joints' names tell what they are: the thigh raised to the front by 90°
//   (sitting), the arm raised by 75°, the arm twisted by 110°, the hand twisted by 150°;
// - of others: the limbs of its hinges, swung forwards (hanging limbs: legs) or raised (wings) by
//   45°;
// - where something is called head: its neck turned by 65° to the side;
// - of bodies without limbs: the middle of its longest row of joints bent by 60° (or, where all
//   joints hang on the root, the one that shares most skin).
// Bends that the bind pose nearly has are left out.
std::vector<JointPose> findPoses(const RiggedModel& model, const std::vector<double>& bends_rad);

SampledMotion poseMotion(const RiggedModel& model, const JointPose& pose);

// What to measure of a pose: for bends of hinges their region, for others the whole surface, and of
// it what both the joint and what is above it hold on to (each at least 2 % of the weight). Where
// weights are rigid, what is near the joint instead.
HingeRegion regionOf(const RiggedModel& model, const JointPose& pose);

}  // namespace fascia
