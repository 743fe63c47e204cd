#include <fascia/io/gltf/gltf_humanoid.h>

#include <algorithm>
#include <functional>
#include <initializer_list>
#include <string_view>

namespace fascia {
namespace {

using Keys = std::initializer_list<std::string_view>;

// A member of members; nullptr where one is missing.
const Json* findDeep(const Json& json, Keys keys) {
  const Json* found = &json;
  for (const std::string_view key : keys) {
    if (!found->is(Json::Kind::object)) return nullptr;
    found = found->find(key);
    if (!found) return nullptr;
  }
  return found;
}
Json* findDeep(Json& json, Keys keys) {
  Json* found = &json;
  for (const std::string_view key : keys) {
    found = findMember(*found, key);
    if (!found) return nullptr;
  }
  return found;
}

const Json::List& listOf(const Json* json) {
  static const Json::List none;
  return json && json->is(Json::Kind::list) ? json->list() : none;
}

int indexOf(const Json* json) {
  if (!json || !json->is(Json::Kind::number)) return -1;
  const double value = json->number();
  return value >= 0 && value < 1e9 ? static_cast<int>(value) : -1;
}

// Whether a node or one below it is marked.
bool anyBelow(const Json& root, int node, const std::vector<bool>& marked) {
  const Json::List& nodes = listOf(root.find("nodes"));
  std::vector<int> open{node};
  std::vector<bool> seen(nodes.size(), false);
  while (!open.empty()) {
    const int n = open.back();
    open.pop_back();
    if (n < 0 || n >= static_cast<int>(nodes.size())) continue;
    const auto i = static_cast<std::size_t>(n);
    if (seen[i]) continue;
    seen[i] = true;
    if (i < marked.size() && marked[i]) return true;
    if (!nodes[i].is(Json::Kind::object)) continue;
    for (const Json& child : listOf(nodes[i].find("children"))) open.push_back(indexOf(&child));
  }
  return false;
}

template <class AnyJson>
AnyJson* groupsOf0(AnyJson& root) {
  return findDeep(root, {"extensions", "VRM", "secondaryAnimation", "boneGroups"});
}
template <class AnyJson>
AnyJson* springsOf1(AnyJson& root) {
  return findDeep(root, {"extensions", "VRMC_springBone", "springs"});
}

}  // namespace

std::vector<HumanBone> humanBonesOf(const Json& root) {
  std::vector<HumanBone> out;
  const auto add = [&](std::string_view bone, const Json* node) {
    if (indexOf(node) >= 0) out.push_back({std::string(bone), indexOf(node)});
  };
  for (const Json& bone : listOf(findDeep(root, {"extensions", "VRM", "humanoid", "humanBones"}))) {
    const Json* name = findDeep(bone, {"bone"});
    if (name && name->is(Json::Kind::text)) add(name->text(), findDeep(bone, {"node"}));
  }
  for (const std::string_view extension : {"VRMC_vrm", "VRMC_vrm_animation"}) {
    const Json* bones = findDeep(root, {"extensions", extension, "humanoid", "humanBones"});
    if (!bones || !bones->is(Json::Kind::object)) continue;
    for (const Json::Member& bone : bones->object()) add(bone.key, findDeep(bone.value, {"node"}));
  }
  return out;
}

bool isVrm(const Json& root) {
  return findDeep(root, {"extensions", "VRM"}) || findDeep(root, {"extensions", "VRMC_vrm"});
}

std::size_t springCount(const Json& root) {
  std::size_t count = listOf(springsOf1(root)).size();
  for (const Json& group : listOf(groupsOf0(root)))
    count += listOf(findDeep(group, {"bones"})).size();
  return count;
}

std::size_t eraseSprings(Json& root, const std::vector<bool>& animated) {
  const std::size_t before = springCount(root);
  const Json& whole = root;
  if (Json* groups = groupsOf0(root); groups && groups->is(Json::Kind::list)) {
    for (Json& group : groups->list()) {
      Json* bones = findMember(group, "bones");
      if (!bones || !bones->is(Json::Kind::list)) continue;
      std::erase_if(bones->list(),
                    [&](const Json& bone) { return anyBelow(whole, indexOf(&bone), animated); });
    }
    std::erase_if(groups->list(), [](const Json& group) {
      const Json* bones = findDeep(group, {"bones"});
      return bones && listOf(bones).empty();
    });
  }
  if (Json* springs = springsOf1(root); springs && springs->is(Json::Kind::list)) {
    std::erase_if(springs->list(), [&](const Json& spring) {
      const Json::List& joints = listOf(findDeep(spring, {"joints"}));
      return std::ranges::any_of(joints, [&](const Json& joint) {
        const int node = indexOf(findDeep(joint, {"node"}));
        return node >= 0 && node < static_cast<int>(animated.size()) &&
               animated[static_cast<std::size_t>(node)];
      });
    });
    if (springs->list().empty())
      eraseMember(*findDeep(root, {"extensions", "VRMC_springBone"}), "springs");
  }
  return before - springCount(root);
}

}  // namespace fascia
