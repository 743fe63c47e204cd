#pragma once

#include <optional>
#include <span>
#include <vector>

#include <fascia/rig/retarget_rest.h>

namespace fascia {

// Part of retarget(): one leg of the target and what drives it, as indices of driven joints.
struct DrivenLeg {
  std::vector<int> upper, lower;  // from the hip on
  int foot = -1;
  int planted = -1;  // the ball of the foot if it is driven, else the foot
};

std::vector<DrivenLeg> legsOf(std::span<const DrivenJoint> driven);

// The turns in the world of upper and lower leg that bring the ankle to a goal: the knee bends in
// the plane that it bends in already, then the leg swings.
struct LegTurns {
  Mat3 upper = Mat3::Identity(), lower = Mat3::Identity();
};
LegTurns reach(const Vec3& hip, const Vec3& knee, const Vec3& ankle, const Vec3& kneeAxis,
               const Vec3& goal);

}  // namespace fascia
