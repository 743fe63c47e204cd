#include <fascia/io/rig_import/gltf/gltf_materials.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include <fascia/io/picture/image.h>
#include <fascia/io/rig_model/rig_limits.h>

namespace fascia {
namespace {

// Factors in [0, 1]; colours may be brighter.
float factor(const GltfPlace& place, double fallback, double most) {
  const double value = place.numberOr(fallback);
  return static_cast<float>(std::isfinite(value) ? std::clamp(value, 0.0, most) : fallback);
}

void readColor(const GltfPlace& place, std::array<float, 4>& color) {
  constexpr double kBrightest = 1;
  if (!place) return;
  if (place.size() != 4) place.fail("is no colour: expected four numbers");
  for (std::size_t i = 0; i < 4; ++i) color[i] = factor(place.at(i), 1, kBrightest);
}

// The place of the base colour's texture; the old extension for glossy materials is still met.
GltfPlace textureInfo(const GltfPlace& material) {
  const GltfPlace glossy = material["extensions"]["KHR_materials_pbrSpecularGlossiness"];
  const GltfPlace base = material["pbrMetallicRoughness"]["baseColorTexture"];
  return base || !glossy["diffuseTexture"] ? base : glossy["diffuseTexture"];
}

// KHR_texture_transform: uv' = translation · rotation · scale · uv.
void readTransform(const GltfPlace& transform, GltfTextureUse& use) {
  if (!transform) return;
  double offset[2] = {0, 0}, scale[2] = {1, 1};
  transform["offset"].numbers(offset, 2);
  transform["scale"].numbers(scale, 2);
  const double angle = transform["rotation"].numberOr(0), c = std::cos(angle), s = std::sin(angle);
  Eigen::Matrix<double, 2, 3> m;
  m << c * scale[0], s * scale[1], offset[0],  //
      -s * scale[0], c * scale[1], offset[1];
  if (m.allFinite() && m.cwiseAbs().maxCoeff() < 1e6) use.uvTransform = m.cast<float>();
  use.uvSet = transform["texCoord"].indexOr(use.uvSet, 8);
}

// Takes pictures along; materials that share one get copies of it, up to a limit.
class PictureReader {
 public:
  PictureReader(const GltfDocument& document, RiggedModel& model)
      : document_(document), model_(model), pictures_(document.root()["images"].size()) {}

  void read(int texture, RigMaterial& material) {
    const GltfPlace root = document_.root();
    const GltfPlace source = root["textures"].at(static_cast<std::size_t>(texture))["source"];
    if (!source) return;
    const int image = source.index(static_cast<int>(pictures_.size()));
    std::optional<std::vector<std::uint8_t>>& picture = pictures_[static_cast<std::size_t>(image)];
    if (!picture) {
      picture = document_.image(image);
      if (!isPicture(*picture)) picture->clear();
    }
    if (picture->empty() || picture->size() > kMostPictureBytes - taken_) {
      std::vector<std::uint8_t>().swap(*picture);  // what nobody gets is not kept
      model_.notes.push_back("the picture of material " + jsonText(material.name) +
                             " is missing, too large, or neither PNG nor JPEG: left out");
      return;
    }
    taken_ += picture->size();
    material.texture = *picture;
  }

 private:
  const GltfDocument& document_;
  RiggedModel& model_;
  std::vector<std::optional<std::vector<std::uint8_t>>> pictures_;
  std::size_t taken_ = 0;
};

}  // namespace

GltfTextureUse baseTextureOf(const GltfDocument& document, int material) {
  const GltfPlace root = document.root();
  GltfTextureUse use;
  const GltfPlace info = textureInfo(root["materials"].at(static_cast<std::size_t>(material)));
  if (!info) return use;
  use.texture = info["index"].index(static_cast<int>(root["textures"].size()));
  use.uvSet = info["texCoord"].indexOr(0, 8);
  readTransform(info["extensions"]["KHR_texture_transform"], use);
  return use;
}

void readGltfMaterials(const GltfDocument& document, RiggedModel& model) {
  const GltfPlace materials = document.root()["materials"];
  PictureReader pictures(document, model);
  for (std::size_t m = 0; m < materials.size(); ++m) {
    const GltfPlace place = materials.at(m), metal = place["pbrMetallicRoughness"];
    RigMaterial& material = model.materials.emplace_back();
    material.name = place["name"].textOr("");
    material.color = {1, 1, 1, 1};  // what a material that names none has
    const GltfPlace glossy = place["extensions"]["KHR_materials_pbrSpecularGlossiness"];
    readColor(glossy["diffuseFactor"], material.color);
    readColor(metal["baseColorFactor"], material.color);
    material.roughness = factor(metal["roughnessFactor"], 1, 1);
    material.metallic = factor(metal["metallicFactor"], glossy ? 0 : 1, 1);
    material.doubleSided = place["doubleSided"].flagOr(false);
    const int texture = baseTextureOf(document, static_cast<int>(m)).texture;
    if (texture >= 0) pictures.read(texture, material);
  }
}

}  // namespace fascia
