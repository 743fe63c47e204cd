#pragma once

#include <span>
#include <string>
#include <vector>

#include <fascia/io/gltf/gltf_keys.h>
#include <fascia/io/rig_export/rig_writer.h>
#include <fascia/io/rig_import/gltf/gltf_clip.h>

namespace fascia {

// Plays a glTF as any viewer does, by the specification alone: nodes, morph targets, skins. Knows
// nothing of how the file was made, and so can tell how well it plays what it should.
class RigPlayer {
 public:
  // parts: node and primitive of what is wanted. animation: -1 = at rest.
  RigPlayer(const GltfDocument& document, std::span<const RigPart> parts, int animation,
            double scale);

  // Vertices of all parts, one after the other, in metres. May be called from several threads.
  void pose(double time_s, std::vector<Eigen::Vector3f>& vertices) const;
  // World frames of all nodes.
  std::vector<Affine> nodesAt(double time_s) const;
  // Of all morph targets of a part.
  std::vector<double> morphWeights(std::size_t part, double time_s) const;

 private:
  struct Skin {
    std::vector<int> nodes;
    std::vector<Affine> inverseBind;
  };
  struct Part {
    int node = 0, skin = -1;
    std::vector<Eigen::Vector3d> positions;
    std::vector<std::vector<Eigen::Vector3f>> targets;
    std::vector<float> restWeights;
    std::size_t influences = 0;
    std::vector<std::uint32_t> slots;
    std::vector<float> weights;
  };

  void readPart(const RigPart& part);
  void readSkins();

  const GltfDocument& document_;
  std::vector<std::string> notes_;
  GltfScene scene_;
  GltfClip clip_;
  std::vector<Skin> skins_;
  std::vector<Part> parts_;
};

// How far what a player shows is from recorded frames; start_s: the first one's, on its clock.
BakeError playedError(const RigPlayer& player, double start_s,
                      const std::vector<Recording::Frame>& frames);

// An animation of a written file, and the clip that it should play.
struct PlayedClip {
  const RigClip& clip;
  int animation = 0;
  double start_s = 0;  // the recording's first frame on the animation's clock
};

// Reads a file that was written for clips, with the scale that it needs, and compares every frame:
// fills in `error` and `baked`.
void measurePlayed(const std::string& path, double scale, std::span<const PlayedClip> played,
                   RigBakeReport& report);

}  // namespace fascia
