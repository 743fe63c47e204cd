#include "film.h"

#include <fascia/io/cache/cache.h>
#include <fascia/io/cache/scene_cache.h>
#include <fascia/io/documents/scene_file.h>
#include <fascia/io/picture/image.h>

#include <fmt/core.h>

#include "film_parts.h"
#include "outputs.h"

namespace fascia {

std::shared_ptr<const Pixels> toPixels(const Texture& texture) {
  if (texture.empty()) return nullptr;
  Image image = decodeImage(texture.bytes);
  return std::make_shared<const Pixels>(Pixels{image.width, image.height, std::move(image.rgba)});
}

std::shared_ptr<const RigSurface> rigSurface(const Character& character, const Console& console) {
  if (!character.def().rig || !character.def().rig->model) return nullptr;
  const std::shared_ptr<const RiggedModel> model = character.def().rig->model;
  std::vector<std::shared_ptr<const Pixels>> textures;
  for (const RigMaterial& material : model->materials) {
    try {
      textures.push_back(toPixels({std::string(material.texture.begin(), material.texture.end())}));
    } catch (const Error& error) {
      textures.push_back(nullptr);
      console.hint(fmt::format("the picture of the material '{}' is left out: {}", material.name,
                               error.what()));
    }
  }
  return std::make_shared<const RigSurface>(model, std::move(textures));
}

std::unique_ptr<Film> makeFilm(const std::string& input, SimulationOptions& options,
                               std::optional<double> only_s, const FilmLook& look,
                               const Console& console) {
  const bool scene =
      endingOf(input) == ".fcache" ? isSceneCache(readCacheBytes(input)) : isSceneFile(input);
  return (scene ? makeStageFilm : makeCharacterFilm)(input, options, only_s, look, console);
}

}  // namespace fascia
