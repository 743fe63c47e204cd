#include "film.h"

#include <fascia/io/cache/cache.h>
#include <fascia/io/cache/scene_cache.h>
#include <fascia/io/documents/scene_file.h>

#include "film_parts.h"
#include "outputs.h"

namespace fascia {

std::shared_ptr<const RigSurface> rigSurface(const Character& character, const Console& console) {
  std::vector<std::string> notes;
  std::shared_ptr<const RigSurface> surface = rigSurface(character, &notes);
  for (const std::string& note : notes) console.hint(note);
  return surface;
}

std::unique_ptr<Film> makeFilm(const std::string& input, SimulationOptions& options,
                               std::optional<double> only_s, const FilmLook& look,
                               const Console& console) {
  const bool scene =
      endingOf(input) == ".fcache" ? isSceneCache(readCacheBytes(input)) : isSceneFile(input);
  return (scene ? makeStageFilm : makeCharacterFilm)(input, options, only_s, look, console);
}

}  // namespace fascia
