#pragma once

#include <string>
#include <vector>

#include <fascia/flesh/bind.h>

namespace fascia::test {

inline SolidDef shape(const std::string& type,
                      const std::vector<std::pair<std::string, double>>& parameters,
                      std::vector<SolidDef::Step> deformations = {}) {
  SolidDef def;
  def.shape = type;
  const Shape* found = findShape(type);
  for (const ParameterInfo& info : found->parameters()) {
    double value = info.standard;
    for (const auto& [name, wanted] : parameters) value = name == info.name ? wanted : value;
    def.parameters.push_back(value);
  }
  def.deformations = std::move(deformations);
  return def;
}

inline FleshSolidDef solid(const std::string& name, const std::string& joint, SolidDef def,
                           std::vector<DriverDef> drivers = {}) {
  FleshSolidDef solid;
  solid.name = name;
  solid.joint = joint;
  solid.solid = std::move(def);
  solid.drivers = std::move(drivers);
  return solid;
}

// Shoulder, elbow, hand, bending about every axis.
inline SkeletonDef armSkeleton() {
  SkeletonDef def;
  def.joints = {{"shoulder", "", Vec3(0, 1.3, 0), Vec3::Zero(), {{Dof::tx}, {Dof::rx}, {Dof::rz}}},
                {"elbow", "shoulder", Vec3(0.3, 0, 0), Vec3(0.1, 0, 0), {{Dof::rz, 0, 2.5, 0}}},
                {"hand", "elbow", Vec3(0.25, 0, 0), Vec3::Zero(), {{Dof::ry}}}};
  return def;
}

// One solid for every way in which matter can move: rigid, stretched, by the shape's map (capsule,
// exponent) and by a deformation's.
inline FleshDef armFlesh() {
  using Smooth = DriverDef::Interpolation;
  const auto byElbow = [](const char* parameter, double from, double to) {
    return DriverDef{parameter, "elbow", Dof::rz, {{0, from}, {2.5, to}}, Smooth::smooth};
  };
  FleshDef def;
  def.solids = {
      solid("bone", "shoulder", shape("capsule", {{"radius_m", 0.03}, {"half_length_m", 0.12}})),
      solid("biceps", "shoulder",
            shape("superellipsoid", {{"half_x_m", 0.04}, {"half_z_m", 0.1}, {"exponent_e1", 0.8}}),
            {byElbow("half_x_m", 0.04, 0.07), byElbow("half_z_m", 0.1, 0.08)}),
      solid("forearm", "elbow", shape("capsule", {{"radius_m", 0.04}, {"half_length_m", 0.1}}),
            {byElbow("radius_m", 0.04, 0.05)}),
      solid("palm", "hand", shape("superellipsoid", {{"exponent_e1", 0.7}}),
            {byElbow("exponent_e1", 0.6, 1.1)}),
      solid("flexor", "elbow",
            shape("superellipsoid", {{"half_z_m", 0.12}}, {{"taper", {0.2}}, {"bend", {0.3}}}),
            {byElbow("taper.amount", 0.1, 0.5), byElbow("half_y_m", 0.1, 0.13)}),
      solid("thumb", "hand", shape("superellipsoid", {{"half_z_m", 0.05}}, {{"bend", {0.6}}})),
      solid("ball", "hand", shape("sphere", {{"radius_m", 0.05}}),
            {byElbow("radius_m", 0.05, 0.06)})};
  for (std::size_t i = 0; i < def.solids.size(); ++i) {
    def.solids[i].position_m = Vec3(0.1, 0.02 * static_cast<double>(i), -0.03);
    def.solids[i].orientation_rad = Vec3(0.2, 1.2, 0.1 * static_cast<double>(i));
  }
  return def;
}

struct Arm {
  Skeleton skeleton;
  Flesh flesh;
  Morphs morphs;  // none

  Figure figure() const { return {skeleton, flesh, morphs}; }

  Arm() : Arm(armSkeleton(), armFlesh()) {}
  Arm(const SkeletonDef& skeletonDef, const FleshDef& fleshDef) {
    Diagnostics diagnostics;
    skeleton = Skeleton(skeletonDef, "/skeleton", diagnostics);
    flesh = Flesh(fleshDef, skeleton, "/solids", diagnostics);
    diagnostics.throwIfErrors();
  }

  // A posture with every joint somewhere inside its limits, and moving.
  Posture moving() const {
    Posture posture = skeleton.restPosture();
    posture.values = {0.2, 0.7, -0.4, 1.1, 0.5};
    posture.rates = {0.3, -1.2, 0.8, 1.5, -2.0};
    return posture;
  }
  void pose(const Posture& posture, PosedFlesh& out,
            std::span<const Flesh::ParameterOverride> overrides = {}) const {
    PosedSkeleton posed;
    skeleton.pose(posture, posed);
    flesh.pose(posture, posed, overrides, out);
  }
  SolidId id(const char* name) const { return flesh.find(name); }
};

inline Posture moved(Posture posture, double time_s) {
  for (std::size_t i = 0; i < posture.values.size(); ++i) {
    posture.values[i] += time_s * posture.rates[i];
  }
  return posture;
}

// Points on the surface of a solid's present state, in the world.
inline std::vector<Vec3> surfacePoints(const PosedFlesh& posed, SolidId solid) {
  std::vector<Vec3> points;
  for (int i = 0; i < 60; ++i) {  // directions on a spiral
    const double z = -0.95 + 1.9 * i / 59, turn = 2.4 * i, r = std::sqrt(1 - z * z);
    const Vec3 direction(r * std::cos(turn), r * std::sin(turn), z);
    points.push_back(posed.frame(solid).point(posed.solid(solid).localFromMaterial(direction)));
  }
  return points;
}

inline VectorArray toArray(const std::vector<Vec3>& points) {
  VectorArray array(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    array.x[i] = static_cast<float>(points[i].x());
    array.y[i] = static_cast<float>(points[i].y());
    array.z[i] = static_cast<float>(points[i].z());
  }
  return array;
}

inline Vec3 at(const VectorArray& a, std::size_t i) {
  return {a.x[i], a.y[i], a.z[i]};
}

// Bends the elbow and the thumb, to and fro.
inline BoundClip flexClip(const Arm& arm) {
  MotionDef motion;
  motion.name = "flex";
  motion.duration_s = 2;
  motion.loop = true;
  motion.tracks = {{TrackDef::Target::joint, "elbow", "rz", {{0, 0}, {1, 2}}},
                   {TrackDef::Target::solid, "thumb", "bend.angle_rad", {{0, 0.2}, {1, 0.9}}}};
  Diagnostics diagnostics;
  BoundClip clip = bindMotion(motion, arm.figure(), {}, "/m", diagnostics);
  diagnostics.throwIfErrors();
  return clip;
}

}  // namespace fascia::test
