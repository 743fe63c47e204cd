#include <fascia/facade/rig_pictures.h>

#include <fascia/io/picture/image.h>

namespace fascia {

namespace {

Image decoded(const Texture& texture, const std::string& owner) {
  try {
    return decodeImage(texture.bytes, texture.name);
  } catch (const Error& error) {
    if (owner.empty()) throw;
    const Location where{owner, 0, "/skin/texture"};
    throw Error(Issue{where, "the texture " + error.issues().front().text(), {}});
  }
}

}  // namespace

std::shared_ptr<const Pixels> toPixels(const Texture& texture, const std::string& owner) {
  if (texture.empty()) return nullptr;
  Image image = decoded(texture, owner);
  return std::make_shared<const Pixels>(Pixels{image.width, image.height, std::move(image.rgba)});
}

std::shared_ptr<const RigSurface> rigSurface(const Character& character,
                                             std::vector<std::string>* notes) {
  if (!character.def().rig || !character.def().rig->model) return nullptr;
  const std::shared_ptr<const RiggedModel> model = character.def().rig->model;
  std::vector<std::shared_ptr<const Pixels>> textures;
  for (const RigMaterial& material : model->materials) {
    try {
      textures.push_back(
          toPixels({std::string(material.texture.begin(), material.texture.end()), {}}));
    } catch (const Error& error) {
      textures.push_back(nullptr);
      if (notes)
        notes->push_back("the picture of the material '" + material.name +
                         "' is left out: " + error.what());
    }
  }
  return std::make_shared<const RigSurface>(model, std::move(textures));
}

}  // namespace fascia
