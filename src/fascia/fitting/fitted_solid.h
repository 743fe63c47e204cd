#pragma once

#include <string>

#include <fascia/field/solid.h>
#include <fascia/fitting/symmetry.h>
#include <fascia/flesh/flesh.h>

namespace fascia {

// A superellipsoid, tapered and then bent, that stands in the world of the rest pose. Its z axis is
// the long one; it bends in its xz-plane and is its own mirror image across it.
struct FittedSolid {
  Transform world;
  Vec3 half_m = Vec3::Constant(0.01);
  double exponent_e1 = 1, exponent_e2 = 1;
  double taper = 0, bend_rad = 0;

  SolidDef def() const;  // without the deformations that do nothing
  Solid solid() const;
  FittedSolid mirrored(const MirrorPlane& plane) const;
  // On a joint whose frame stands there in the rest pose.
  FleshSolidDef onJoint(const std::string& name, const std::string& joint,
                        const Transform& joint_world, const Color& color) const;
};

}  // namespace fascia
