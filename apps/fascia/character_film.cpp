#include <fascia/io/cache/cache.h>
#include <fascia/io/documents/stats_writer.h>
#include <fascia/render/character_scene.h>
#include <fascia/render/player.h>

#include "film.h"
#include "film_parts.h"
#include "outputs.h"

namespace fascia {
namespace {

// What is to be drawn, wherever it came from.
struct Footage {
  Character character;
  Recording recording;
  Texture texture;
};

Footage simulateFootage(const std::string& input, SimulationOptions& options,
                        std::optional<double> only_s, const Console& console) {
  Character character = prepareCharacter(input, options, console);
  const int motion = chooseMotion(character, options.motion);
  RecordOptions record = options.recordOptions();
  if (only_s)
    keepOnly(
        *only_s,
        record.frame_rate_hz > 0 ? record.frame_rate_hz : character.def().simulation.frame_rate_hz,
        record);
  Recording recording = simulate(character, motion, record, console);
  Texture texture = loadTexture(character.def());
  return {std::move(character), std::move(recording), std::move(texture)};
}

Footage cachedFootage(const std::string& input) {
  Cache cache = readCache(input);
  return {Character(cache.def), std::move(cache.recording), std::move(cache.texture)};
}

class CharacterFilm final : public Film {
 public:
  // cache: the file that the footage was read from, if it was.
  CharacterFilm(Footage footage, const std::string& input, std::string cache, const FilmLook& look,
                const Console& console)
      : footage_(std::move(footage)),
        cache_(std::move(cache)),
        player_(footage_.character, footage_.recording) {
    if (footage_.recording.frames.empty()) throw Error("there are no frames to draw");
    const std::string& motion = footage_.recording.motion;
    options_.layers = parseLayers(look.layers);
    if (!look.camera.empty()) options_.camera = parseCamera(look.camera);
    options_.aspect = look.aspect;
    options_.skin_texture = toPixels(footage_.texture, input);
    options_.rig_surface = rigSurface(footage_.character, console);
    reach_ = motionReach(
        footage_.character,
        footage_.character.source(motion.empty() ? -1 : footage_.character.findMotion(motion)));
    options_.framing = reach_.box();
    if (options_.rig_surface) options_.reach = &reach_;
    options_.ground_height_m = floorHeight(footage_.character, reach_);
  }

  double start_s() const override { return footage_.recording.frames.front().time_s; }
  double end_s() const override { return footage_.recording.frames.back().time_s; }
  Scene at(double time_s) override {
    player_.seek(time_s);
    return buildScene(footage_.character, player_.state(), player_.skin(), options_);
  }
  std::string stats() const override { return statsJson(footage_.recording); }
  void report(const std::vector<std::string>& outputs, const Console& console) const override {
    reportRecording(footage_.recording, outputs, console, cache_);
  }

 private:
  Footage footage_;
  std::string cache_;
  Player player_;
  Reach reach_;
  SceneOptions options_;
};

}  // namespace

std::unique_ptr<Film> makeCharacterFilm(const std::string& input, SimulationOptions& options,
                                        std::optional<double> only_s, const FilmLook& look,
                                        const Console& console) {
  const bool cached = endingOf(input) == ".fcache";
  Footage footage =
      cached ? cachedFootage(input) : simulateFootage(input, options, only_s, console);
  return std::make_unique<CharacterFilm>(std::move(footage), input, cached ? input : std::string(),
                                         look, console);
}

}  // namespace fascia
