#pragma once

#include <span>
#include <vector>

#include <fascia/baking/bone_tracks.h>
#include <fascia/baking/point_graph.h>

namespace fascia {

// A new helper for where the error is largest: its motion follows a patch of points rigidly.
struct HelperSeed {
  std::uint32_t point = 0;
  double radius_m = 0;  // of the patch
  int parent = 0;       // the rig's joint that moves most like it
  std::vector<Transform> track;
};

// At most `count` of them, far enough from each other to be fitted at once; fewer where no error is
// left. Places near `seeds`, those of helpers before, count less, as a helper that could not mend
// them will not the next time either; the new ones are added to them.
std::vector<HelperSeed> seedHelpers(const SkinningProblem& problem, const PointGraph& graph,
                                    std::span<const PointWeights> rigWeights,
                                    const BoneTracks& bones, std::span<const double> squaredError,
                                    std::size_t patchSize, std::size_t count,
                                    std::vector<std::uint32_t>& seeds);

}  // namespace fascia
