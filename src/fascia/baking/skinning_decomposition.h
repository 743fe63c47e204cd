#pragma once

#include <functional>
#include <span>
#include <vector>

#include <fascia/rig/rigged_model.h>

namespace fascia {

// A deforming surface: frames of points, all as long as the rest shape.
using PointFrames = std::vector<std::vector<Eigen::Vector3f>>;

struct DecompositionOptions {
  int helperBones = 20;  // [0, 512] added to the rig's own
  int influences = 4;    // 4 or 8 per point
  int iterations = 12;   // of bones against weights
  // Told the share that is done, now and then; what it throws stops the work.
  std::function<void(double)> progress = {};
};

// Linear blend skinning that plays back a simulation (Le & Deng 2012): the rig's own bones keep
// their motion, helper bones and all weights are found.
struct SkinningDecomposition {
  struct Helper {
    std::vector<Transform> world;  // per frame: from the rest pose to the frame (rigid)
    Vec3 center_m;                 // in the rest pose: where the bone sits
    int parent = 0;                // the rig's joint that it hangs from
  };
  std::vector<Helper> helpers;
  // Joint numbers below boneCount are the rig's, then come the helpers. At most `influences`.
  std::vector<PointWeights> weights;
  double rms_m = 0, max_m = 0;  // error over all points and frames
};

// bones: per frame, per joint of the rig, the motion from rest to frame (world · rest⁻¹).
SkinningDecomposition decomposeSkinning(std::span<const Eigen::Vector3f> rest,
                                        std::span<const std::array<std::uint32_t, 3>> triangles,
                                        std::span<const PointWeights> weights,
                                        const std::vector<std::vector<Transform>>& bones,
                                        const PointFrames& frames,
                                        const DecompositionOptions& options);

}  // namespace fascia
