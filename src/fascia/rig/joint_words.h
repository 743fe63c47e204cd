#pragma once

#include <string>
#include <string_view>

#include <fascia/rig/joint_meaning.h>

namespace fascia {

// Part of guessMeanings(): the words that rigs call their joints by. Some (shoulder, leg, finger)
// mean different bones in different rigs.
enum class JointWord {
  hips,
  hip,
  pelvis,
  hipJoint,
  spine,
  neck,
  head,
  shoulder,
  clavicle,
  arm,
  upperArm,
  lowerArm,
  hand,
  leg,
  upperLeg,
  lowerLeg,
  foot,
  toe,
  thumb,
  index,
  middle,
  ring,
  pinky,
  finger
};

// A name taken apart.
struct JointReading {
  bool known = false;
  JointWord word = JointWord::hips;
  BodySide side = BodySide::middle;
  std::string number;  // the first after the word
};

JointReading readJointName(std::string_view name);

// "左ひじ", "上半身2", "ひじ.L": as MikuMikuDance and what came from it call their joints.
JointReading readJapaneseJointName(std::string_view name);

}  // namespace fascia
