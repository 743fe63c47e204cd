#pragma once

#include <vector>

#include <fascia/rig/rigged_model.h>

namespace fascia {

// A plane across one of the world's axes.
struct MirrorPlane {
  int axis = 0;  // 0 x, 2 z
  double offset_m = 0;

  Vec3 point(Vec3 p) const {
    p[axis] = 2 * offset_m - p[axis];
    return p;
  }
  Vec3 direction(Vec3 v) const {
    v[axis] = -v[axis];
    return v;
  }
  // Rotation axes and the like keep their part across the plane and turn the rest.
  Vec3 axial(const Vec3& v) const { return -direction(v); }
  Vec3 normal() const { return Vec3::Unit(axis); }
  double distance_m(const Vec3& p) const { return p[axis] - offset_m; }
};

// Which joint is which one's mirror image.
struct Symmetry {
  bool present = false;
  MirrorPlane plane;
  std::vector<int> partner;  // per joint: itself if it lies in the plane; -1: none

  bool central(std::size_t joint) const {
    return present && partner[joint] == static_cast<int>(joint);
  }
  bool paired(std::size_t joint) const {
    return present && partner[joint] >= 0 && partner[joint] != static_cast<int>(joint);
  }
  // The second of a pair: it takes the mirror image of what the first one gets.
  bool mirrored(std::size_t joint) const {
    return paired(joint) && partner[joint] < static_cast<int>(joint);
  }
};

// Symmetry of joints and surface alike; not present if either is lopsided.
Symmetry findSymmetry(const RiggedModel& model);

}  // namespace fascia
