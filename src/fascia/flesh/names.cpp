#include <fascia/flesh/names.h>

#include <fascia/base/suggest.h>

namespace fascia {

JointId resolveJoint(const Skeleton& skeleton, const std::string& name, const std::string& pointer,
                     Diagnostics& diagnostics) {
  const JointId joint = skeleton.find(name);
  if (joint.valid()) return joint;
  if (skeleton.jointCount() == 0) return joint;  // its own faults are reported already
  NearestName nearest(name);
  for (std::size_t i = 0; i < skeleton.jointCount(); ++i) {
    nearest.offer(skeleton.joint(JointId{static_cast<std::int64_t>(i)}).name);
  }
  diagnostics.error(pointer, "unknown joint " + quotedName(name), nearest.hint());
  return joint;
}

int resolveDof(const Skeleton& skeleton, JointId joint, Dof dof, const std::string& pointer,
               Diagnostics& diagnostics) {
  const int value = skeleton.valueIndex(joint, dof);
  if (value >= 0) return value;
  const JointDef& def = skeleton.joint(joint);
  std::string owned;
  for (const DofDef& own : def.dofs)
    owned += (owned.empty() ? "" : ", ") + std::string(name(own.dof));
  diagnostics.error(
      pointer,
      "joint " + quotedName(def.name) + " has no degree of freedom " + std::string(name(dof)),
      owned.empty() ? "it has none" : "it has " + owned);
  return value;
}

int resolveParameter(const Solid& solid, const std::string& path, const std::string& pointer,
                     Diagnostics& diagnostics) {
  const int parameter = solid.parameterIndex(path);
  if (parameter >= 0 || solid.parameterCount() == 0) return parameter;
  NearestName nearest(path);
  std::string known;
  for (std::size_t i = 0; i < solid.parameterCount(); ++i) {
    const std::string& own = solid.parameterPath(static_cast<int>(i));
    nearest.offer(own);
    known += (known.empty() ? "" : ", ") + own;
  }
  diagnostics.error(pointer, "unknown parameter " + quotedName(path),
                    nearest.best().empty() ? "it has " + known : nearest.hint());
  return parameter;
}

}  // namespace fascia
