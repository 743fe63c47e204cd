#pragma once

#include <vector>

#include <fascia/character/character.h>
#include <fascia/rig/rigged_model.h>

namespace fascia {

// The joints of a character's rig, moved by its skeleton: found there by name, and a joint that the
// skeleton lacks stays with the one that it hangs from.
class RigJoints {
 public:
  explicit RigJoints(const Character& character);  // which has a rig; must outlive this

  // Of every joint of the rig: its motion from the bind pose.
  void motion(const PosedSkeleton& posed, std::vector<Transform>& fromRest) const;
  // … and its world frame.
  void world(const PosedSkeleton& posed, std::vector<Transform>& world) const;

 private:
  const RiggedModel& model_;
  std::vector<std::size_t> driver_;   // rig joint -> the skeleton's joint that carries it
  std::vector<Transform> fromWorld_;  // rig joint: the world seen from its driver at rest
};

}  // namespace fascia
