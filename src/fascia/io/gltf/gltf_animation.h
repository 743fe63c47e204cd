#pragma once

#include <fascia/io/json/json.h>

namespace fascia {

// Appends a track of linear keys to an animation: a sampler of its own and the channel that moves
// the node by it. `times` and `values` are accessors; path: "translation", "rotation", "weights".
void addGltfTrack(Json& animation, int times, int values, int node, const char* path);

// Whether an animation moves anything.
bool hasGltfTracks(const Json& animation);

}  // namespace fascia
