#pragma once

#include <memory>
#include <span>
#include <vector>

#include <fascia/field/field.h>
#include <fascia/geometry/signed_mesh.h>

namespace fascia {

// The inside of a surface of triangles that moves and bends, as one solid: a character's skin as
// others meet it. Its matter goes with the nearest point of the surface; material coordinates are
// (triangle, and where in it) and belong to the surface. Not copyable.
class SurfaceField final : public Field {
 public:
  // `mesh` at any moment; depth_m: how far the matter below each vertex gives way.
  SurfaceField(const TriangleMesh& mesh, std::span<const float> depth_m);

  // Where the vertices are now, and where they were span_s > 0 ago. Allocates nothing.
  void update(std::span<const Eigen::Vector3f> positions, std::span<const Eigen::Vector3f> before,
              double span_s);

  // How far the matter gives way below the nearest point of the surface, m.
  void softness(ConstVectors points, float* depth_m) const;

  std::size_t solidCount() const override { return 1; }
  Box bounds(SolidId) const override { return bounds_; }
  void evaluate(SolidId solid, ConstVectors points, float* distance_m,
                Vectors normal) const override;
  Transform frame(SolidId) const override { return {}; }
  const Outline& outline(SolidId) const override { return outline_; }
  void velocity(SolidId solid, ConstVectors points, Vectors velocity) const override;
  Vec3 materialFromWorld(SolidId solid, const Vec3& world) const override;
  Vec3 worldFromMaterial(SolidId solid, const Vec3& material) const override;

 private:
  SignedMesh surface_;
  std::vector<float> depth_m_;             // per welded point
  std::vector<Eigen::Vector3f> velocity_;  // likewise
  Box bounds_;                             // of now and before
  Outline outline_;
};

}  // namespace fascia
