#include <fascia/field/surface_field.h>

#include <algorithm>
#include <cmath>

#include <fascia/math/points.h>

namespace fascia {
namespace {

constexpr float kNowhere_m = 1e9f;

// The sum of three corners' values by weights.
template <class T>
T blend(const std::vector<T>& values, const std::array<std::uint32_t, 3>& t, const Vec3& weights) {
  const Eigen::Vector3f w = weights.cast<float>();
  return w[0] * values[t[0]] + w[1] * values[t[1]] + w[2] * values[t[2]];
}

// The mesh with its triangles turned outward.
TriangleMesh outward(TriangleMesh mesh) {
  if (mesh.positions.empty()) return mesh;
  const Eigen::Vector3f origin = mesh.positions.front();  // near: meshes may be open
  for (Eigen::Vector3f& p : mesh.positions) p -= origin;
  const bool inward = enclosedVolume(mesh) < 0;
  for (Eigen::Vector3f& p : mesh.positions) p += origin;
  if (inward)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

}  // namespace

SurfaceField::SurfaceField(const TriangleMesh& mesh, std::span<const float> depth_m)
    : surface_(outward(mesh)) {
  const std::size_t points = surface_.welded().positions.size();
  depth_m_.assign(points, 0), velocity_.assign(points, Eigen::Vector3f::Zero());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    depth_m_[surface_.pointOf(v)] = depth_m[v];
  update(mesh.positions, mesh.positions, 1);
}

void SurfaceField::update(std::span<const Eigen::Vector3f> positions,
                          std::span<const Eigen::Vector3f> before, double span_s) {
  surface_.refit(positions);
  bounds_ = surface_.bounds_m();
  const auto rate = static_cast<float>(1 / span_s);
  for (std::size_t v = 0; v < positions.size(); ++v) {
    velocity_[surface_.pointOf(v)] = rate * (positions[v] - before[v]);
    bounds_.add(Vec3(before[v].cast<double>()));
  }
  for (std::size_t c = 0; c < kOutline; ++c)
    for (int axis = 0; axis < 3; ++axis)
      outline_[c][axis] = (c >> axis & 1 ? bounds_.high : bounds_.low)[axis];
}

void SurfaceField::evaluate(SolidId, ConstVectors points, float* distance_m, Vectors normal) const {
  for (std::size_t i = 0; i < points.count; ++i) {
    const auto nearest = surface_.nearest(pointAt(points, i));
    if (!nearest) {
      distance_m[i] = kNowhere_m;
      setPoint(normal, i, Vec3::UnitY());
      continue;
    }
    distance_m[i] = static_cast<float>(nearest->distance_m);
    setPoint(normal, i, nearest->normal);
  }
}

void SurfaceField::softness(ConstVectors points, float* depth_m) const {
  for (std::size_t i = 0; i < points.count; ++i) {
    const auto nearest = surface_.nearest(pointAt(points, i));
    depth_m[i] =
        nearest ? blend(depth_m_, surface_.welded().triangles[nearest->triangle], nearest->weights)
                : 0.f;
  }
}

void SurfaceField::velocity(SolidId, ConstVectors points, Vectors velocity) const {
  for (std::size_t i = 0; i < points.count; ++i) {
    const auto nearest = surface_.nearest(pointAt(points, i));
    const Eigen::Vector3f v =
        nearest ? blend(velocity_, surface_.welded().triangles[nearest->triangle], nearest->weights)
                : Eigen::Vector3f(Eigen::Vector3f::Zero());
    velocity.x[i] = v.x(), velocity.y[i] = v.y(), velocity.z[i] = v.z();
  }
}

// The number of a triangle, and the weights of its second and third corner.
Vec3 SurfaceField::materialFromWorld(SolidId, const Vec3& world) const {
  const auto nearest = surface_.nearest(world);
  if (!nearest) return Vec3::Zero();
  return {static_cast<double>(nearest->triangle), nearest->weights[1], nearest->weights[2]};
}

Vec3 SurfaceField::worldFromMaterial(SolidId, const Vec3& material) const {
  const std::vector<std::array<std::uint32_t, 3>>& triangles = surface_.welded().triangles;
  if (triangles.empty()) return Vec3::Zero();
  const auto t = static_cast<std::size_t>(
      std::clamp(std::round(material.x()), 0.0, static_cast<double>(triangles.size() - 1)));
  const Vec3 weights(1 - material.y() - material.z(), material.y(), material.z());
  return blend(surface_.welded().positions, triangles[t], weights).cast<double>();
}

}  // namespace fascia
