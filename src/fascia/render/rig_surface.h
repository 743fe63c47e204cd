#pragma once

#include <memory>
#include <vector>

#include <fascia/render/scene.h>
#include <fascia/rig/rigged_model.h>

namespace fascia {

// An imported character's surface, made ready to be drawn: one drawable per material.
class RigSurface {
 public:
  // textures: decoded RigMaterial::texture, by material; null where there is none.
  RigSurface(std::shared_ptr<const RiggedModel> model,
             std::vector<std::shared_ptr<const Pixels>> textures = {});

  struct Look {
    Rgb color{0.86f, 0.66f, 0.56f};  // of what has no material
    float scatter_m = 0.01f;         // of what has no material: it is drawn as skin
    float veil = 1;                  // below 1: all of it see-through and of one colour
  };

  // skin: a moment of the surface, in the order of RiggedModel::vertices, with normals.
  void addTo(Scene& scene, const TriangleMesh& skin, const Look& look) const;

 private:
  // What shares a material.
  struct Patch {
    int material = -1;
    std::vector<std::uint32_t> vertices;  // of the model
    std::vector<Eigen::Vector2f> uvs;
    std::vector<std::array<std::uint32_t, 3>> triangles;  // of `vertices`
  };

  Material material(const Patch& patch, const Look& look) const;

  std::shared_ptr<const RiggedModel> model_;
  std::vector<std::shared_ptr<const Pixels>> textures_;
  std::vector<Patch> patches_;
};

}  // namespace fascia
