#include <fascia/facade/stage_player.h>
#include <fascia/io/cache/cache.h>
#include <fascia/io/cache/scene_cache.h>
#include <fascia/io/documents/stats_writer.h>
#include <fascia/render/stage_scene.h>

#include "film.h"
#include "film_parts.h"
#include "outputs.h"
#include "stage_run.h"

namespace fascia {
namespace {

// All that moves in the course of a performance, from where a camera sees it. Of a long one this
// many moments do: what swings is missed by less than it is thick.
constexpr std::size_t kReachMoments = 120;

SceneCache performScene(const std::string& input, const SimulationOptions& options,
                        std::optional<double> only_s, const Console& console) {
  Stage stage = prepareStage(input, options, console);
  StageRecordOptions record = stageRecordOptions(options);
  // Without a box to be seen the camera shows all that moves in the course of the performance.
  const ViewDef& view = stage.def().view;
  if (only_s && view.low_m != view.high_m)
    keepOnly(*only_s,
             record.frame_rate_hz > 0 ? record.frame_rate_hz : stage.def().simulation.frame_rate_hz,
             record);
  StageRecording recording = perform(stage, record, console);
  std::vector<Texture> textures;
  for (const SceneCharacterDef& def : stage.def().characters)
    textures.push_back(loadTexture(def.character->def()));
  return {std::move(stage), std::move(textures), std::move(recording)};
}

class StageFilm final : public Film {
 public:
  // cache: the file that the scene was read from, if it was.
  StageFilm(SceneCache scene, std::string cache, const FilmLook& look, const Console& console)
      : scene_(std::move(scene)),
        cache_(std::move(cache)),
        pictures_(scene_.stage),
        player_(scene_.stage, scene_.recording, scene_.textures, &notes_) {
    for (const std::string& note : notes_) console.hint(note);
    if (scene_.recording.frames.empty()) throw Error("there are no frames to draw");
    const SceneDef& def = scene_.stage.def();
    options_.layers = parseLayers(look.layers);
    options_.aspect = look.aspect;
    const std::string camera = !look.camera.empty()       ? look.camera
                               : !def.view.camera.empty() ? def.view.camera
                               : def.dimension == 2       ? "front"
                                                          : "three-quarter";
    options_.camera = parseCamera(camera);
    options_.ground = def.ground.has_value();
    if (def.ground) options_.ground_height_m = def.ground->height_m;
    options_.framing.add(def.view.low_m.cwiseMin(def.view.high_m));
    options_.framing.add(def.view.low_m.cwiseMax(def.view.high_m));
    if (def.view.low_m != def.view.high_m) return;
    findReach();
    options_.reach = &reach_;
  }

  double start_s() const override { return scene_.recording.frames.front().time_s; }
  double end_s() const override { return scene_.recording.frames.back().time_s; }
  Scene at(double time_s) override {
    player_.seek(time_s);
    return pictures_.scene(player_.moment(), options_);
  }
  std::string stats() const override { return statsJson(scene_.stage, scene_.recording); }
  void report(const std::vector<std::string>& outputs, const Console& console) const override {
    reportPerformance(scene_.stage, scene_.recording, outputs, console, cache_);
  }

 private:
  void findReach() {
    const std::vector<StageRecording::Frame>& frames = scene_.recording.frames;
    const std::size_t step = std::max<std::size_t>(1, frames.size() / kReachMoments);
    for (std::size_t f = 0; f < frames.size(); f += step) pictures_.addTo(frames[f].bodies, reach_);
    for (const SceneCharacterDef& actor : scene_.stage.def().characters) {
      const Reach own = motionReach(
          *actor.character, actor.character->source(actor.character->findMotion(actor.motion)));
      for (const Vec3& p : own.extremes()) reach_.add(placeOf(actor).point(p));
    }
  }

  SceneCache scene_;
  std::string cache_;
  StagePictures pictures_;
  std::vector<std::string> notes_;
  StagePlayer player_;
  Reach reach_;
  SceneOptions options_;
};

}  // namespace

std::unique_ptr<Film> makeStageFilm(const std::string& input, SimulationOptions& options,
                                    std::optional<double> only_s, const FilmLook& look,
                                    const Console& console) {
  const bool cached = endingOf(input) == ".fcache";
  SceneCache scene = cached ? parseSceneCache(readCacheBytes(input), input)
                            : performScene(input, options, only_s, console);
  return std::make_unique<StageFilm>(std::move(scene), cached ? input : std::string(), look,
                                     console);
}

}  // namespace fascia
