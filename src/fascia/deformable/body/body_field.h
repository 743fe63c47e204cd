#pragma once

#include <memory>
#include <span>
#include <vector>

#include <fascia/deformable/body/body_map.h>
#include <fascia/deformable/surfaces/body_surface.h>
#include <fascia/field/field.h>

namespace fascia {

// Deformed bodies as solids: those of a BodyModel that have a surface, at one state. Material
// coordinates are the undeformed points X, so that whatever is fixed to a solid's matter goes along
// when it bends. A plain value; copies share what does not change.
//
// Distances are first order in d, the undeformed distance over the length of F⁻ᵀ n, as those of
// deformed solids (Barr 1984): exact on the surface. Where the map cannot be inverted, they are
// those from the nearest of some tangent planes; far outside, from a box around the body.
class BodyField final : public Field {
 public:
  BodyField() = default;
  // surfaces[b] is that of body b; nullptr: that body is no solid. Throws Error if there are not as
  // many as bodies. All bodies are at rest, undeformed, where they were made, until update().
  BodyField(const BodyModel& model, std::span<const BodySurfacePtr> surfaces);

  // The coordinates of all bodies and their rates. Allocates nothing.
  void update(std::span<const double> q, std::span<const double> v);

  // Whether the other was made for the same bodies, or copied from one that was.
  bool sharesBodiesWith(const BodyField& other) const { return parts_ == other.parts_; }
  const BodySurface& surface(SolidId solid) const { return *(*parts_)[solid.index()].surface; }
  const BodyMap& map(SolidId solid) const { return posed_[solid.index()].map; }
  // The deformed surface for pictures.
  void writeMesh(SolidId solid, TriangleMesh& mesh) const {
    mesh = surface(solid).mesh();
    deform(map(solid), mesh);
  }

  std::size_t solidCount() const override { return posed_.size(); }
  Box bounds(SolidId solid) const override { return posed_[solid.index()].map.bounds(); }
  void evaluate(SolidId solid, ConstVectors points, float* distance_m,
                Vectors normal) const override;
  Transform frame(SolidId solid) const override { return posed_[solid.index()].frame; }
  const Outline& outline(SolidId solid) const override { return posed_[solid.index()].outline; }
  void velocity(SolidId solid, ConstVectors points, Vectors velocity) const override;
  Vec3 materialFromWorld(SolidId solid, const Vec3& world) const override;
  Vec3 worldFromMaterial(SolidId solid, const Vec3& material) const override;
  void worldFromMaterials(SolidId solid, ConstVectors materials, Vectors world) const override;

 private:
  struct Part {
    BodyId body;
    std::size_t first, count;  // of its coordinates
    BodySurfacePtr surface;
  };
  struct Posed {
    BodyMap map;
    Transform frame;
    Outline outline;
  };
  void finish(const Part& part, Posed& posed) const;
  void evaluateAffine(std::size_t solid, ConstVectors points, float* distance_m,
                      Vectors normal) const;
  void evaluateCurved(std::size_t solid, ConstVectors points, float* distance_m,
                      Vectors normal) const;

  std::shared_ptr<const std::vector<Part>> parts_;
  std::vector<Posed> posed_;
};

}  // namespace fascia
