#pragma once

#include <memory>

#include <fascia/skin/grid/grid_skin.h>
#include <fascia/skin/skin.h>

#include "grids.h"

namespace fascia::test {

inline FleshSolidDef ball(const std::string& name, const std::string& joint, const Vec3& position,
                          double radius_m) {
  FleshSolidDef def;
  def.name = name;
  def.joint = joint;
  def.position_m = position;
  def.solid.parameters = {radius_m};
  return def;
}

// A belly, a chest and a head on two joints, and a skin around them.
struct Body {
  SkeletonDef skeletonDef;
  FleshDef fleshDef;
  SkinDef skinDef;
  SkinSettings settings;

  Skeleton skeleton;
  Flesh flesh;
  PosedSkeleton posedSkeleton;
  PosedFlesh posedFlesh;
  Diagnostics diagnostics;
  std::unique_ptr<Skin> skin;

  Body() {
    skeletonDef.joints = {
        {"hip", "", Vec3(0, 1, 0), Vec3::Zero(), {{Dof::tx}, {Dof::ry}}},
        {"neck", "hip", Vec3(0, 0.5, 0), Vec3::Zero(), {{Dof::rx, -1.6, 1.6, 0}}}};
    fleshDef.solids = {ball("belly", "hip", Vec3::Zero(), 0.3),
                       ball("chest", "hip", Vec3(0, 0.35, 0.03), 0.2),
                       ball("head", "neck", Vec3(0, 0.15, 0), 0.15)};
    skinDef.grid.bottom.joint = "hip";
    skinDef.grid.top.joint = "neck";
    skinDef.grid.columns = 16;
    skinDef.grid.rows = 24;
  }

  // Returns whether the skin was built without faults.
  bool build(const std::string& pointer = "/skin") {
    diagnostics = {};
    skeleton = Skeleton(skeletonDef, "/skeleton", diagnostics);
    flesh = Flesh(fleshDef, skeleton, "/solids", diagnostics);
    diagnostics.throwIfErrors();
    pose(skeleton.restPosture());
    skin = std::make_unique<Skin>(skinDef, settings,
                                  SkinBase{skeleton, flesh, posedSkeleton, posedFlesh}, pointer,
                                  diagnostics);
    return diagnostics.ok();
  }
  void pose(const Posture& posture) {
    skeleton.pose(posture, posedSkeleton);
    flesh.pose(posture, posedSkeleton, {}, posedFlesh);
  }
  SkinPose skinPose() const { return {&posedFlesh, posedSkeleton.joint_world}; }

  double distanceTo(SolidId solid, const Vec3& p) const {
    const float x = static_cast<float>(p.x()), y = static_cast<float>(p.y()),
                z = static_cast<float>(p.z());
    float d, nx, ny, nz;
    posedFlesh.evaluate(solid, {&x, &y, &z, 1}, &d, {&nx, &ny, &nz, 1});
    return d;
  }
};

// A body that stands still in its present posture.
class StillPoses final : public SkinPoseSource {
 public:
  explicit StillPoses(SkinPose pose) : pose_(pose) {}
  SkinPose at(double) override { return pose_; }

 private:
  SkinPose pose_;
};

}  // namespace fascia::test
