#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <fascia/pose/limb_part.h>
#include <fascia/pose/pose_mesh.h>

namespace fascia {

// The implicit bodies of all bones of a figure, and what they say about the skin on them. Constant
// once built.
struct LimbParts {
  std::vector<LimbPart> part;        // per joint; without a body where the skin has no such shape
  std::vector<char> hub;             // per joint: several limbs begin here (hips, chests)
  std::vector<std::uint32_t> home;   // per point: the joint with most weight
  std::vector<std::uint32_t> place;  // per point: where it stands in skin[home]
  std::vector<std::vector<std::uint32_t>> skin;  // per joint: the points whose home it is
  std::vector<float> own_m;                      // per point: distance from its home's body at rest
  std::vector<float> radius_m;  // per point: how thick the limb is there, smooth along the skin
  std::vector<int> parent;      // per joint, of the rig

  // Whether skin of the two meets in a crease: joints that follow each other, or that a bone
  // shorter than thick lies between; but not jaws, which lie beside what carries them.
  bool meetInCrease(std::size_t a, std::size_t b) const;
  // The next joint towards the root that has a body; -1: none.
  int bodyAbove(std::size_t joint) const;

  std::vector<Eigen::Vector3f> origin_m;  // per joint, at rest
};

LimbParts makeLimbParts(const PoseSource& source, const PoseMesh& mesh);

}  // namespace fascia
