#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include <fascia/rig/rigged_model.h>

namespace fascia {

// A joint that bends like an elbow or a knee; vectors in the bind pose, world.
struct Hinge {
  std::size_t upper = 0, joint = 0;  // of RiggedModel: the limb's first joint, the one that turns
  Vec3 center_m;
  Vec3 upper_m, lower_m;  // the segments on either side, both away from the body
  Vec3 axis;              // unit, perpendicular to lower_m; a positive turn bends further

  double shorter_m() const { return std::min(upper_m.norm(), lower_m.norm()); }
  double flexion_rad() const;  // [0, π]: angle between the two segments, 0 = stretched
  // The turn about the axis, from the bind pose, after which the segments stand at this angle (or
  // come as near to it as the axis allows).
  double turnFor_rad(double flexion_rad) const;
};

// The hinges of the limbs on the character's left side (its right one's are their mirror images),
// at most `most`, one per limb. Elbows and knees that are named so come first, then what has
// the shape of one: two long segments in a row. A body without limbs has none.
std::vector<Hinge> findHinges(const RiggedModel& model, std::size_t most = 2);

// Turns one joint about a world axis (unit), from the bind pose, within a second, and holds it for
// another. Everything else keeps its place on its parent.
SampledMotion turnMotion(const RiggedModel& model, std::size_t joint, const Vec3& axis_world,
                         double turn_rad);

// Bends one hinge from the bind pose to a flexion within a second and holds it for another.
SampledMotion bendMotion(const RiggedModel& model, const Hinge& hinge, double flexion_rad);

// The part of the surface that a joint moves, and what is near the joint. Of a hinge: the limb, cut
// off where it begins; near are the points that lie (at rest, along either segment) within half of
// the shorter one, and their triangles.
struct HingeRegion {
  std::vector<std::array<std::uint32_t, 3>> limb, nearJoint;
  std::vector<std::uint32_t> pointsNearJoint;  // increasing
};
HingeRegion regionOf(const RiggedModel& model, const Hinge& hinge);

}  // namespace fascia
