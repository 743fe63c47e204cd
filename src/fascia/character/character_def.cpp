#include <fascia/character/character_def.h>

#include <algorithm>

#include <fascia/math/ode/integrators.h>

namespace fascia {

std::vector<std::string_view> skinIntegrators() {
  std::vector<std::string_view> names = {"auto", "leapfrog", "cloth"};
  for (const IntegratorInfo& info : integrators()) names.push_back(info.name);
  return names;
}

const std::string& RigDef::nameOf(const std::string& joint) const {
  const auto renamed = std::ranges::find(joint_names, joint, &RigJointNameDef::joint);
  return renamed == joint_names.end() ? joint : renamed->name;
}

std::vector<std::string> RigDef::jointNames() const {
  std::vector<std::string> names;
  for (const RigJoint& joint : model->joints) names.push_back(nameOf(joint.name));
  return names;
}

}  // namespace fascia
