#pragma once

#include <vector>

#include <fascia/character/character.h>
#include <fascia/render/rig_joints.h>
#include <fascia/rig/linear_blend.h>

namespace fascia {

// An imported surface moved by its file's own weights, and its morphs: what there is to see of a
// rig without elastic skin, and a quick measure of where one with it will go.
class BlendedSkin {
 public:
  explicit BlendedSkin(const Character& character);  // which has a rig; must outlive this

  // Reads the state's posed skeleton and its morphs. In the order of RiggedModel::vertices.
  void compute(const CharacterState& state, std::vector<Eigen::Vector3f>& positions);

 private:
  const RiggedModel& model_;
  RigJoints joints_;
  LinearBlend blend_;
  std::vector<Transform> motion_;  // per rig joint, of the frame at hand
  std::vector<Eigen::Vector3f> points_;
};

}  // namespace fascia
