#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fascia/rig/rigged_model.h>

namespace fascia {

// Which joint of a motion drives which joint of a rig. A target is driven by one source at most; a
// source may drive several targets.
struct JointPair {
  std::string source, target;  // names; an empty target (given by a person): drives nothing
  std::string why;             // for a person: "same name", "left upper arm", "given"
  int line = 0;                // of the file that gave it; 0: none
};
using JointMap = std::vector<JointPair>;  // targets in the rig's order

// What the files of both say of their joints (see guessMeanings).
struct SaidJoints {
  std::span<const std::string> source = {}, target = {};
};

// Pairs by name and structure. `given` pairs win over guesses. Pairs that contradict the hierarchy
// are left out; `notes` says which, and what has no counterpart. Throws Error with
// every given name that does not exist, and its line.
JointMap guessJointMap(std::span<const RigJoint> source, std::span<const RigJoint> target,
                       std::span<const JointPair> given = {},
                       std::vector<std::string>* notes = nullptr, const SaidJoints& said = {});

// "source = target" a line; # starts a comment; nothing after the sign: drives nothing. Throws
// Error with the line.
JointMap parseJointMap(std::string_view text, const std::string& file);

// The pairs as such lines, with the reasons as comments: to be shown, edited and given back.
std::string printJointMap(const JointMap& map);

}  // namespace fascia
