#pragma once

#include <span>
#include <vector>

#include <fascia/baking/skinning_decomposition.h>

namespace fascia {

struct MorphOptions {
  int targets = 16;        // [1, 256] at most
  double tolerance_m = 0;  // stop early when the RMS error is below; 0 = use all targets
  double sparsity = 0.02;  // of the largest displacement: smaller ones become exactly 0
};

// A few displacement fields whose weighted sums play back a simulation, on top of the rig's own
// skinning: displacements are in the bind pose, before the joints move the point.
struct MorphBasis {
  struct Target {
    std::vector<std::uint32_t> points;            // increasing; those that it moves
    std::vector<Eigen::Vector3f> displacement_m;  // of those
  };
  std::vector<Target> targets;
  // Frame, target; in [0, 1], as some importers cut off what is negative. The first target may be
  // an offset with the weight 1 throughout.
  std::vector<std::vector<float>> weights;
  double rms_m = 0, max_m = 0;  // error over all points and frames, in the world
};

MorphBasis findMorphBasis(std::span<const Eigen::Vector3f> rest,
                          std::span<const PointWeights> weights,
                          const std::vector<std::vector<Transform>>& bones,
                          const PointFrames& frames, const MorphOptions& options);

}  // namespace fascia
