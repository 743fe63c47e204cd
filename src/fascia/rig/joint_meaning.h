#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fascia/rig/rigged_model.h>

namespace fascia {

enum class BodySide { middle, left, right };

enum class BodyPart {
  unknown,
  hips,
  spine,
  neck,
  head,
  pelvis,  // of one side, between hips and upper leg
  upperLeg,
  lowerLeg,
  foot,
  toe,
  clavicle,
  upperArm,
  lowerArm,
  hand,
  thumb,
  index,
  middle,
  ring,
  pinky
};
inline constexpr bool isFinger(BodyPart part) {
  return part >= BodyPart::thumb;
}
inline constexpr bool isTrunk(BodyPart part) {
  return part >= BodyPart::hips && part <= BodyPart::head;
}

// What a joint most likely is, to a person.
struct JointMeaning {
  BodyPart part = BodyPart::unknown;
  BodySide side = BodySide::middle;
  friend bool operator==(JointMeaning, JointMeaning) = default;
};

std::string describe(JointMeaning meaning);  // "left upper arm"

// By names alone: "mixamorig:LeftArm", "DEF-upper_arm.L", "J_Bip_L_UpperArm", "b_LeftForeArm_010",
// "l_elbow", "upperarm_l", "Bip01 L Thigh" … A word that several rigs use for different bones
// (shoulder, leg, finger 1) is settled by what else the rig has. Then by structure: whoever holds
// both legs is the hips, and what leads from there to the head is spine up to the arms, neck above.
// Limbs whose joints are only numbered ("arm_joint_L_1" to 4) are read along their chain.
// `said`: per joint, what the file itself says that it is, in the words of VRM's humanoids
// ("leftUpperArm"; empty: it says nothing). Where any is given, names are not read.
std::vector<JointMeaning> guessMeanings(std::span<const RigJoint> joints,
                                        std::span<const std::string> said = {});

// The nearest common ancestor of joints; -1 if there are none or they share none.
int commonAncestor(std::span<const RigJoint> joints, std::span<const int> of);

}  // namespace fascia
