#pragma once

#include <span>
#include <string>
#include <vector>

#include <fascia/io/gltf/gltf_keys.h>
#include <fascia/io/rig_export/rig_source.h>

namespace fascia {

// Whether a channel turns or moves one of the rig's joints: what a bake replaces.
bool movesJoint(const RigSource& source, const Json& channel);

// Whether it is of the weights of a node's morph targets.
bool weighsMorphs(const Json& channel, int node);

// Makes an animation anew of what it does beside moving joints (morph targets, props, sizes, what
// extensions animate), cut or repeated to a span of its clock. Returns how many channels could not
// be cut, and are left out.
std::size_t cutOtherChannels(RigSource& source, int animation, const GltfSpan& span);

// What a person is told of a bake: channels that were left out, and what the importer noted of the
// baked motions (joints whose sizes are not simulated).
std::vector<std::string> notesOfMotions(std::span<const RigClip> clips, std::size_t leftOut);

}  // namespace fascia
