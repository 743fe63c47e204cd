#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <fascia/baking/skinning_decomposition.h>
#include <fascia/character/recording.h>

namespace fascia {

// A character whose skin lies on its solids (a grid, or their surface), as if it were a rigged
// mesh: what the ways of baking ask for.
struct GridRig {
  std::vector<Transform> rest_world;  // per joint of the skeleton, in the rest posture
  TriangleMesh surface;               // as it is drawn, settled in the rest posture, with normals
  // Its vertices welded where they lie on one point: the seam of the texture is drawn twice.
  std::vector<std::uint32_t> pointOf;  // per vertex
  std::vector<Eigen::Vector3f> points_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // of points
  // What the joints seem to carry at rest, by the distance to their solids. Only a start.
  std::vector<PointWeights> weights;  // per point
};
GridRig gridRigOf(const Character& character);

// The frames of some recordings, one recording after the other.
struct GridFrames {
  std::vector<std::vector<Transform>> local;  // per frame, per joint: in its parent's frame
  std::vector<std::vector<Transform>> bones;  // per frame, per joint: from rest to the frame
  PointFrames points;                         // per frame, of GridRig::points_m
};
// Throws Error if a recording is not of this character, or holds no proper frames.
GridFrames gridFramesOf(const Character& character, const GridRig& rig,
                        std::span<const Recording* const> recordings);

}  // namespace fascia
