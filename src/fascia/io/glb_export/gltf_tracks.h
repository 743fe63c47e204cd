#pragma once

#include <string>
#include <vector>

#include <fascia/io/gltf/gltf_builder.h>
#include <fascia/math/types.h>

namespace fascia {

Eigen::Vector4f gltfQuaternion(const Mat3& rotation);  // x, y, z, w

// A node's place in its parent, frame by frame.
struct PlaceTrack {
  std::vector<Eigen::Vector3f> translations;
  std::vector<Eigen::Vector4f> rotations;  // quaternions; neighbours on one side

  void add(const Transform& place);
};

// A node that stands where the track starts.
Json placeNode(const std::string& name, const PlaceTrack& track);
struct TrackOptions {
  // What a frame may differ from the blend of its neighbours to be dropped. Where skins are morphs
  // of their own, their joints' nodes need no more than what can be seen.
  float metres = 1e-5f, halfRadians = 1e-4f;
  // Told even if nothing moves: the node stands elsewhere, or another animation moves it.
  bool translations = false, rotations = false;
  bool small = false;  // rotations in 16 bits
};
// Animates it; drops frames that lie between their neighbours.
void addTracks(const std::vector<float>& times, const PlaceTrack& track, int node, GltfBuilder& glb,
               Json& animation, const TrackOptions& options = {});

}  // namespace fascia
