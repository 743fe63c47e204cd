#include <fascia/fitting/fitted_solid.h>

#include <fascia/skeleton/euler.h>

namespace fascia {

SolidDef FittedSolid::def() const {
  SolidDef def;
  def.shape = "superellipsoid";
  def.parameters = {half_m.x(), half_m.y(), half_m.z(), exponent_e1, exponent_e2};
  if (taper != 0) def.deformations.push_back({"taper", {taper}});
  if (bend_rad != 0) def.deformations.push_back({"bend", {bend_rad}});
  return def;
}

Solid FittedSolid::solid() const {
  Diagnostics diagnostics;
  return Solid(def(), {}, diagnostics);
}

FittedSolid FittedSolid::mirrored(const MirrorPlane& plane) const {
  FittedSolid image = *this;
  image.world.translation_m = plane.point(world.translation_m);
  for (int axis : {0, 1, 2}) {
    image.world.rotation.col(axis) = plane.direction(world.rotation.col(axis));
  }
  image.world.rotation.col(1) *= -1;  // right-handed again; the solid is symmetric in y
  return image;
}

FleshSolidDef FittedSolid::onJoint(const std::string& name, const std::string& joint,
                                   const Transform& joint_world, const Color& color) const {
  const Transform local = joint_world.inverse() * world;
  FleshSolidDef flesh;
  flesh.name = name;
  flesh.joint = joint;
  flesh.position_m = local.translation_m;
  flesh.orientation_rad = anglesZyx(local.rotation);
  flesh.solid = def();
  flesh.color = color;
  return flesh;
}

}  // namespace fascia
