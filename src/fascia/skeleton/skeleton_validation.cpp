#include <fascia/skeleton/skeleton_validation.h>

#include <algorithm>
#include <array>
#include <map>
#include <string_view>

#include <fascia/base/suggest.h>

namespace fascia {
namespace {

using JointIndices = std::map<std::string_view, std::size_t>;

// Limits may be "none", which no other value of that size is.
void validateLimit(const DofDef& def, double limit, const std::string& pointer,
                   Diagnostics& diagnostics) {
  if (limit == DofDef{}.min || limit == DofDef{}.max) return;
  checkNumber(dofInfo(def.dof), limit, pointer, diagnostics);
}

void validateDof(const DofDef& def, const std::string& pointer, Diagnostics& diagnostics) {
  const std::size_t errorsBefore = diagnostics.errors().size();
  const std::string unit = isRotation(def.dof) ? "_deg" : "_m";
  validateLimit(def, def.min, pointer + "/min" + unit, diagnostics);
  validateLimit(def, def.max, pointer + "/max" + unit, diagnostics);
  checkNumber(dofInfo(def.dof), def.rest, pointer + "/rest" + unit, diagnostics);
  if (diagnostics.errors().size() > errorsBefore) return;
  if (def.min > def.max) {
    diagnostics.error(pointer, "limits: the minimum " + shortNumber(def.min) +
                                   " is above the maximum " + shortNumber(def.max));
  } else if (def.rest < def.min || def.rest > def.max) {
    diagnostics.error(pointer, "rest: " + shortNumber(def.rest) + " lies outside the limits [" +
                                   shortNumber(def.min) + ", " + shortNumber(def.max) + "]");
  }
}

void validateJoint(const JointDef& joint, const std::string& pointer, Diagnostics& diagnostics) {
  validateTunables(joint, pointer, diagnostics);
  std::array<bool, 6> seen{};
  for (const DofDef& dof : joint.dofs) {
    const std::string dofPointer = pointer + "/dofs/" + std::string(name(dof.dof));
    bool& known = seen[static_cast<std::size_t>(dof.dof)];
    if (known) diagnostics.error(dofPointer, "the same degree of freedom twice");
    known = true;
    validateDof(dof, dofPointer, diagnostics);
  }
}

// Every joint by its name; the first of several.
JointIndices indexNames(const SkeletonDef& def, const std::string& pointer,
                        Diagnostics& diagnostics) {
  JointIndices indices;
  for (std::size_t i = 0; i < def.joints.size(); ++i) {
    const std::string& name = def.joints[i].name;
    const std::string namePointer = pointer + "/" + std::to_string(i) + "/name";
    if (name.empty()) {
      diagnostics.error(namePointer, "a joint needs a name");
      continue;
    }
    const auto [first, fresh] = indices.try_emplace(name, i);
    if (!fresh) {
      diagnostics.error(namePointer, "a second joint named " + quotedName(name),
                        "the first is joint " + std::to_string(first->second));
    }
  }
  return indices;
}

// "a → b → a", or empty if the chain of parents above `start` ends. At most kMostJoints steps.
std::string cycleThrough(const SkeletonDef& def, const JointIndices& indices, std::size_t start) {
  std::string path = quotedName(def.joints[start].name);
  std::size_t at = start;
  for (std::size_t steps = 0; steps < def.joints.size(); ++steps) {
    const auto parent = indices.find(def.joints[at].parent);
    if (parent == indices.end()) return {};
    at = parent->second;
    if (steps < 8) path += " → " + quotedName(def.joints[at].name);
    if (at == start) return steps < 8 ? path : path + " → …";
  }
  return {};  // runs into a cycle that `start` is not part of: reported there
}

void validateParent(const SkeletonDef& def, const JointIndices& indices, std::size_t i,
                    const std::string& pointer, Diagnostics& diagnostics) {
  const JointDef& joint = def.joints[i];
  const auto parent = indices.find(joint.parent);
  if (parent == indices.end()) {
    NearestName nearest(joint.parent);
    for (const auto& [known, index] : indices) nearest.offer(known);
    diagnostics.error(pointer, "unknown joint " + quotedName(joint.parent), nearest.hint());
  } else if (parent->second >= i) {
    const std::string cycle = cycleThrough(def, indices, i);
    if (!cycle.empty()) {
      diagnostics.error(pointer, "the parents run in a circle: " + cycle);
    } else {
      diagnostics.error(pointer, "the parent " + quotedName(joint.parent) + " comes later",
                        "list parents before their children");
    }
  }
}

void validateTree(const SkeletonDef& def, const JointIndices& indices, const std::string& pointer,
                  Diagnostics& diagnostics) {
  std::string root;
  bool rooted = false;
  for (std::size_t i = 0; i < def.joints.size(); ++i) {
    const std::string parentPointer = pointer + "/" + std::to_string(i) + "/parent";
    if (!def.joints[i].parent.empty()) {
      validateParent(def, indices, i, parentPointer, diagnostics);
    } else if (rooted) {
      // A forgotten parent must not quietly tear the figure in two.
      diagnostics.error(parentPointer,
                        "a second root: " + quotedName(def.joints[i].name) + " has no parent",
                        "a skeleton has one root; should the parent be " + quotedName(root) + "?");
    } else {
      rooted = true;
      root = def.joints[i].name;
    }
  }
  if (!rooted) diagnostics.error(pointer, "no joint without a parent", "a skeleton needs a root");
}

}  // namespace

void validateSkeleton(const SkeletonDef& def, const std::string& pointer,
                      Diagnostics& diagnostics) {
  if (def.joints.empty() || def.joints.size() > kMostJoints) {
    diagnostics.error(pointer, "found " + std::to_string(def.joints.size()) +
                                   " joints, expected 1 to " + std::to_string(kMostJoints));
    return;
  }
  const JointIndices indices = indexNames(def, pointer, diagnostics);
  validateTree(def, indices, pointer, diagnostics);
  for (std::size_t i = 0; i < def.joints.size(); ++i) {
    validateJoint(def.joints[i], pointer + "/" + std::to_string(i), diagnostics);
  }
}

}  // namespace fascia
