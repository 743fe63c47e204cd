#pragma once

#include <string>
#include <vector>

#include <fascia/io/gltf/gltf_keys.h>
#include <fascia/io/rig_import/gltf/gltf_scene.h>

namespace fascia {

// A glTF animation's channel, decoded and checked: times increase, values are sane.
struct GltfChannel {
  enum class Path { translation, rotation, scale };
  enum class Mode { step, linear, cubic };
  int node = 0;
  Path path = Path::translation;
  Mode mode = Mode::linear;
  std::vector<float> times_s;
  std::vector<float> values;  // per key; cubic: in-tangent, value, out-tangent

  std::size_t components() const { return path == Path::rotation ? 4 : 3; }
  // The value at a time, clamped to the keys. `key` remembers where the last search ended.
  Eigen::Vector4d valueAt(double time_s, std::size_t& key) const;
};

// … and one of the weights of all morph targets of a node's mesh.
struct GltfWeightChannel {
  int node = 0;
  GltfKeys keys;
};

struct GltfClip {
  std::string name;
  std::vector<GltfChannel> channels;  // of nodes' transforms
  std::vector<GltfWeightChannel> weights;

  bool isEmpty() const { return channels.empty() && weights.empty(); }
  double start_s() const;
  double end_s() const;
  // Frames per second that lose nothing: the rate of the keys if they keep one, else 60.
  double naturalRate_hz() const;
};

// All animations. Channels that are no use (no such node, no numbers) are left out and noted.
std::vector<GltfClip> readGltfClips(const GltfDocument& document, const GltfScene& scene,
                                    std::vector<std::string>& notes);
// One of them: of many, each for itself would else decode all again.
GltfClip readGltfClip(const GltfDocument& document, const GltfScene& scene, std::size_t animation,
                      std::vector<std::string>& notes);

}  // namespace fascia
