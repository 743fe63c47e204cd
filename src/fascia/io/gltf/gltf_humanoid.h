#pragma once

#include <string>
#include <vector>

#include <fascia/io/json/json.h>

namespace fascia {

// What a VRM, an avatar as a glTF with extensions, says of its nodes: VRM 0.x (/extensions/VRM) and
// 1.0 (/extensions/VRMC_vrm; in motions VRMC_vrm_animation). What does not fit is passed over.

struct HumanBone {
  std::string bone;  // "leftUpperArm"
  int node = -1;
};
std::vector<HumanBone> humanBonesOf(const Json& root);

bool isVrm(const Json& root);

// Swinging chains: hair, skirts. In 0.x a node begins one, and all below it swing; in 1.0 the nodes
// are listed. Takes out the chains that have a node in `animated`; returns how many.
std::size_t eraseSprings(Json& root, const std::vector<bool>& animated);
std::size_t springCount(const Json& root);

}  // namespace fascia
