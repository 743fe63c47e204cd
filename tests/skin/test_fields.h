#pragma once

#include <vector>

#include <fascia/field/field.h>
#include <fascia/field/solid.h>

#include "grids.h"

namespace fascia::test {

// Solids with a rigid motion each: the weakest thing a skin can rest on.
class RigidSolids : public Field {
 public:
  struct Part {
    Solid solid;
    Transform world;
    Twist twist;
  };
  std::vector<Part> parts;

  RigidSolids& addSphere(const Vec3& center, double radius_m, const Twist& twist = {}) {
    SolidDef def;
    def.parameters = {radius_m};
    return add(def, {Mat3::Identity(), center}, twist);
  }
  RigidSolids& add(const SolidDef& def, const Transform& world, const Twist& twist = {}) {
    Diagnostics diagnostics;
    parts.push_back({Solid(def, "", diagnostics), world, twist});
    diagnostics.throwIfErrors();
    return *this;
  }

  std::size_t solidCount() const override { return parts.size(); }
  Box bounds(SolidId id) const override {
    const Part& part = parts[id.index()];
    const Box& local = part.solid.bounds();
    Box out;
    for (int c = 0; c < 8; ++c)
      out.add(part.world.point({c & 1 ? local.high.x() : local.low.x(),
                                c & 2 ? local.high.y() : local.low.y(),
                                c & 4 ? local.high.z() : local.low.z()}));
    return out;
  }
  void evaluate(SolidId id, ConstVectors points, float* distance_m, Vectors normal) const override {
    evaluatePosed(parts[id.index()].solid, parts[id.index()].world, points, distance_m, normal);
  }
  Transform frame(SolidId id) const override { return parts[id.index()].world; }
  const Outline& outline(SolidId id) const override { return parts[id.index()].solid.outline_m(); }
  void velocity(SolidId id, ConstVectors points, Vectors out) const override {
    for (std::size_t i = 0; i < points.count; ++i) {
      const Vec3 v = parts[id.index()].twist.at({points.x[i], points.y[i], points.z[i]});
      out.x[i] = static_cast<float>(v.x());
      out.y[i] = static_cast<float>(v.y());
      out.z[i] = static_cast<float>(v.z());
    }
  }
  Vec3 materialFromWorld(SolidId id, const Vec3& p) const override {
    return parts[id.index()].world.inverse().point(p);
  }
  Vec3 worldFromMaterial(SolidId id, const Vec3& m) const override {
    return parts[id.index()].world.point(m);
  }

  // Signed distance to the nearest solid.
  double distance(const Vec3& p) const {
    const float x = static_cast<float>(p.x()), y = static_cast<float>(p.y()),
                z = static_cast<float>(p.z());
    float nearest = 1e30f, d, nx, ny, nz;
    for (std::size_t s = 0; s < parts.size(); ++s) {
      evaluate(SolidId(static_cast<std::int64_t>(s)), {&x, &y, &z, 1}, &d, {&nx, &ny, &nz, 1});
      nearest = std::min(nearest, d);
    }
    return nearest;
  }
};

inline SolidDef superellipsoid(double x, double y, double z, double e1, double e2) {
  SolidDef def;
  def.shape = "superellipsoid";
  for (const ParameterInfo& info : findShape("superellipsoid")->parameters()) {
    double value = info.standard;
    if (info.name == "half_x_m") value = x;
    if (info.name == "half_y_m") value = y;
    if (info.name == "half_z_m") value = z;
    if (info.name == "exponent_e1") value = e1;
    if (info.name == "exponent_e2") value = e2;
    def.parameters.push_back(value);
  }
  return def;
}

}  // namespace fascia::test
