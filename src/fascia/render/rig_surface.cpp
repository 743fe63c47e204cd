#include <fascia/render/rig_surface.h>

#include <algorithm>
#include <cmath>
#include <map>

#include <fascia/base/error.h>

namespace fascia {
namespace {

const Rgb kVeilColor(0.88f, 0.72f, 0.63f);  // pale skin, whatever is painted on it
constexpr float kVeilRoughness = 0.5f;
constexpr float kWrap = 0.25f;  // fur and cloth: light creeps around; 0 = plaster, 1 = fog

float srgbFromLinear(float c) {
  c = std::clamp(c, 0.f, 1.f);
  return c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
}

}  // namespace

RigSurface::RigSurface(std::shared_ptr<const RiggedModel> model,
                       std::vector<std::shared_ptr<const Pixels>> textures)
    : model_(std::move(model)), textures_(std::move(textures)) {
  textures_.resize(model_->materials.size());
  std::map<int, Patch> byMaterial;
  std::vector<std::uint32_t> place(model_->vertices.size());
  std::vector<int> owner(model_->vertices.size(), -2);  // -2: in no patch yet
  for (const RigPart& part : model_->parts) {
    Patch& patch = byMaterial[part.material];
    patch.material = part.material;
    for (std::uint32_t t = 0; t < part.triangleCount; ++t) {
      std::array<std::uint32_t, 3> triangle = model_->drawnTriangles[part.firstTriangle + t];
      for (std::uint32_t& v : triangle) {
        if (owner[v] != part.material) {
          owner[v] = part.material;
          place[v] = static_cast<std::uint32_t>(patch.vertices.size());
          patch.vertices.push_back(v);
          patch.uvs.push_back(model_->vertices[v].uv);
        }
        v = place[v];
      }
      patch.triangles.push_back(triangle);
    }
  }
  for (auto& [material, patch] : byMaterial) patches_.push_back(std::move(patch));
}

Material RigSurface::material(const Patch& patch, const Look& look) const {
  Material out;
  if (look.veil < 1) {
    out.kind = Material::Kind::skin;
    out.color = kVeilColor;
    out.roughness = kVeilRoughness;
    out.scatter_m = look.scatter_m;
    out.opacity = look.veil;
  } else if (patch.material < 0) {
    out.kind = Material::Kind::skin;
    out.color = look.color;
    out.scatter_m = look.scatter_m;
  } else {
    const auto index = static_cast<std::size_t>(patch.material);
    const RigMaterial& from = model_->materials[index];
    for (int k = 0; k < 3; ++k)
      out.color[k] = srgbFromLinear(from.color[static_cast<std::size_t>(k)]);
    out.texture = textures_[index];
    out.tiled = true;
    out.roughness = from.roughness;
    out.metallic = from.metallic;
    out.wrap = kWrap * (1 - from.metallic);
    out.opacity = std::clamp(from.color[3], 0.f, 1.f);
  }
  return out;
}

void RigSurface::addTo(Scene& scene, const TriangleMesh& skin, const Look& look) const {
  if (skin.positions.size() != model_->vertices.size() ||
      skin.normals.size() != skin.positions.size())
    throw Error("render: a rig's surface has other points than its file, or no normals");
  for (const Patch& patch : patches_) {
    Drawable drawable;
    drawable.material = material(patch, look);
    drawable.mesh.triangles = patch.triangles;
    drawable.mesh.uvs = patch.uvs;
    drawable.mesh.positions.reserve(patch.vertices.size());
    drawable.mesh.normals.reserve(patch.vertices.size());
    for (const std::uint32_t v : patch.vertices) {
      drawable.mesh.positions.push_back(skin.positions[v]);
      drawable.mesh.normals.push_back(skin.normals[v]);
    }
    scene.drawables.push_back(std::move(drawable));
  }
}

}  // namespace fascia
