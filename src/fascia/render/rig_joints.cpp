#include <fascia/render/rig_joints.h>

#include <string_view>
#include <unordered_map>

namespace fascia {

RigJoints::RigJoints(const Character& character) : model_(*character.def().rig->model) {
  const Skeleton& skeleton = character.skeleton();
  PosedSkeleton rest;
  skeleton.pose(skeleton.restPosture(), rest);
  std::unordered_map<std::string_view, std::size_t> byName;
  for (std::size_t j = 0; j < skeleton.jointCount(); ++j)
    byName.emplace(skeleton.joint(JointId(static_cast<std::int64_t>(j))).name, j);
  for (const RigJoint& joint : model_.joints) {
    const auto found = byName.find(character.def().rig->nameOf(joint.name));
    const std::size_t inherited =
        joint.parent < 0 ? 0 : driver_[static_cast<std::size_t>(joint.parent)];
    driver_.push_back(found != byName.end() ? found->second : inherited);
    fromWorld_.push_back(rest.joint_world[driver_.back()].inverse());
  }
}

void RigJoints::motion(const PosedSkeleton& posed, std::vector<Transform>& fromRest) const {
  fromRest.resize(driver_.size());
  for (std::size_t j = 0; j < driver_.size(); ++j)
    fromRest[j] = posed.joint_world[driver_[j]] * fromWorld_[j];
}

void RigJoints::world(const PosedSkeleton& posed, std::vector<Transform>& world) const {
  motion(posed, world);
  for (std::size_t j = 0; j < world.size(); ++j) world[j] = world[j] * model_.joints[j].rest_world;
}

}  // namespace fascia
