#pragma once

#include <functional>
#include <span>
#include <vector>

#include <fascia/rig/rigged_model.h>

namespace fascia {

// A deforming surface: frames of points, all as long as the rest shape.
using PointFrames = std::vector<std::vector<Eigen::Vector3f>>;
// Per frame, per joint of the rig: the motion from rest to the frame (world · rest⁻¹).
using BoneFrames = std::vector<std::vector<Transform>>;

struct DecompositionOptions {
  int helperBones = 20;  // [0, 512] added to the rig's own
  int influences = 4;    // 4 or 8 per point
  int iterations = 12;   // of bones against weights
  // Told the share that is done, now and then; what it throws stops the work.
  std::function<void(double)> progress = {};
  // As long as the RMS error of a motion is above, more helpers come, up to `mostHelpers` [0, 512].
  // 0: none do.
  double tolerance_m = 0;
  int mostHelpers = 0;
  // How many of the frames belong to each motion, if there are several. Each is heard.
  std::vector<std::size_t> motionFrames = {};
  // Poses that are not baked, but in which the surface shall stay as the rig's weights have it.
  BoneFrames kept = {};
};

// Linear blend skinning that plays back a simulation (Le & Deng 2012): the rig's own bones keep
// their motion, helper bones and all weights are found.
struct SkinningDecomposition {
  struct Helper {
    std::vector<Transform> world;  // per frame: from the rest pose to the frame (rigid)
    Vec3 center_m;                 // in the rest pose: where the bone sits
    int parent = 0;                // the rig's joint that it hangs from
    double radius_m = 0;           // the farthest point that it carries, from the center
  };
  std::vector<Helper> helpers;
  // Joint numbers below boneCount are the rig's, then come the helpers. At most `influences`.
  std::vector<PointWeights> weights;
  double rms_m = 0, max_m = 0;  // error over all points and frames
  // Nothing moves beyond the rig's own skinning: `weights` are the rig's, there are no helpers.
  bool plain = false;
};

SkinningDecomposition decomposeSkinning(std::span<const Eigen::Vector3f> rest,
                                        std::span<const std::array<std::uint32_t, 3>> triangles,
                                        std::span<const PointWeights> weights,
                                        const BoneFrames& bones, const PointFrames& frames,
                                        const DecompositionOptions& options);

// How the helpers of a decomposition have to move in other frames to bring the surface nearest to
// `targets` there. Per helper, per frame: the motion from the rest pose.
std::vector<std::vector<Transform>> fitHelpers(std::span<const Eigen::Vector3f> rest,
                                               const SkinningDecomposition& found,
                                               const BoneFrames& bones, const PointFrames& targets);

// The same where `targets` are what `weights` make of the rig's own bones, as in plainSkinning():
// as fast for any number of points.
std::vector<std::vector<Transform>> fitHelpersToSkinning(std::span<const Eigen::Vector3f> rest,
                                                         const SkinningDecomposition& found,
                                                         const BoneFrames& bones,
                                                         std::span<const PointWeights> weights);

// How far the surface is from `targets` at most where helpers rest on their parents.
double restingError_m(std::span<const Eigen::Vector3f> rest, const SkinningDecomposition& found,
                      const BoneFrames& bones, const PointFrames& targets);

// Where plain linear blend skinning puts the points.
PointFrames plainSkinning(std::span<const Eigen::Vector3f> rest,
                          std::span<const PointWeights> weights, const BoneFrames& bones);

}  // namespace fascia
