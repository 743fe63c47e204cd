#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <fascia/base/parallel.h>
#include <fascia/io/cache.h>
#include <fascia/io/image.h>
#include <fascia/io/stats_writer.h>
#include <fascia/io/texture.h>
#include <fascia/io/video_writer.h>
#include <fascia/render/character_scene.h>
#include <fascia/render/renderer.h>

#include "commands.h"
#include "interrupt.h"
#include "outputs.h"
#include "player.h"
#include "progress.h"
#include "simulation_options.h"

namespace fascia {
namespace {

constexpr const char* kFooter =
    R"(INPUT is a character, which is simulated first, or a cache that 'fascia bake' wrote. A .png shows
the moment --time, a .mp4 the whole motion (without ffmpeg: a folder of pictures).

Cameras: front, side, back, top, three-quarter; az=30,el=15 (degrees), with dist=2 or fov=40;
eye=1,2,3;target=0,1,0 (metres). The character faces +z, y is up.

Examples:
  fascia render examples/penguin.fascia.json --time 1.5 -o penguin.png
  fascia render examples/penguin.fascia.json --layers skeleton,muscle,skin -o layers.png
  fascia render penguin.fcache --camera az=60,el=10 --size 1280x720 --fps 60 -o penguin.mp4)";

struct RenderOptions {
  std::string input, output, stats;
  std::string size = "1280x720", camera = "three-quarter", layers = "skin";
  double time_s = 0;
  double frame_rate_hz = 30;
  SimulationOptions simulation;

  bool video() const { return endingOf(output) == ".mp4"; }
};

// What is to be drawn, wherever it came from.
struct Footage {
  Character character;
  Recording recording;
  Texture texture;
};

Footage simulateFootage(RenderOptions& options, const Console& console) {
  Character character = prepareCharacter(options.input, options.simulation, console);
  RecordOptions record = options.simulation.recordOptions(character);
  if (!options.video()) {  // as far as that moment, and keep only its frame
    const double rate_hz =
        record.frame_rate_hz > 0 ? record.frame_rate_hz : character.def().simulation.frame_rate_hz;
    record.duration_s = std::max(options.time_s, 0.5 / rate_hz);
    record.start_s = options.time_s - 0.5 / rate_hz;
  }
  Recording recording = simulate(character, record, console);
  Texture texture = loadTexture(character.def());
  return {std::move(character), std::move(recording), std::move(texture)};
}

Footage loadFootage(RenderOptions& options, const Console& console) {
  if (endingOf(options.input) != ".fcache") return simulateFootage(options, console);
  Cache cache = readCache(options.input);
  return {Character(cache.def), std::move(cache.recording), std::move(cache.texture)};
}

std::shared_ptr<const Pixels> toPixels(const Texture& texture) {
  if (texture.empty()) return nullptr;
  Image image = decodeImage(texture.bytes);
  return std::make_shared<const Pixels>(Pixels{image.width, image.height, std::move(image.rgba)});
}

// The decoded pictures of an imported character's materials. One that cannot be read is left out,
// and named: the rest of the character is still worth seeing.
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

// Draws moments of a footage, all from the same camera.
class Shooting {
 public:
  Shooting(const Footage& footage, const RenderOptions& options, const Console& console)
      : footage_(footage),
        player_(footage.character, footage.recording),
        size_(parseSize(options.size)) {
    const std::string& motion = footage.recording.motion;
    options_.layers = parseLayers(options.layers);
    options_.camera = parseCamera(options.camera);
    options_.aspect = static_cast<double>(size_.width) / size_.height;
    options_.skin_texture = toPixels(footage.texture);
    options_.rig_surface = rigSurface(footage.character, console);
    reach_ =
        motionReach(footage.character, motion.empty() ? -1 : footage.character.findMotion(motion));
    options_.framing = reach_.box();
    if (options_.rig_surface) options_.reach = &reach_;
    options_.ground_height_m = floorHeight(footage.character, reach_);
  }

  const Image& at(double time_s) {
    player_.seek(time_s);
    renderer_.render(buildScene(footage_.character, player_.state(), player_.skin(), options_),
                     size_.width, size_.height, pixels_);
    image_.width = pixels_.width;
    image_.height = pixels_.height;
    image_.rgba.swap(pixels_.rgba);
    return image_;
  }

  Size size() const { return size_; }

 private:
  const Footage& footage_;
  Player player_;
  Size size_;
  Reach reach_;
  SceneOptions options_;
  Renderer renderer_;
  Pixels pixels_;
  Image image_;
};

void shootVideo(const Footage& footage, const RenderOptions& options, const Console& console) {
  Shooting shooting(footage, options, console);
  const double start_s = footage.recording.frames.front().time_s;
  const double length_s = footage.recording.frames.back().time_s - start_s;
  const int frames = std::max(1, static_cast<int>(std::lround(length_s * options.frame_rate_hz)));
  VideoWriter video(options.output, shooting.size().width, shooting.size().height,
                    {.frame_rate_hz = options.frame_rate_hz});
  Progress progress(console, "drawing");
  for (int i = 0; i < frames; ++i) {
    video.add(shooting.at(start_s + i / options.frame_rate_hz));
    if (!progress.update((i + 1.0) / frames)) throw Interrupted{};
  }
  video.finish();
  if (!video.hint().empty()) console.hint(video.hint());
}

void render(RenderOptions& options, const Console& console) {
  checkFolders({options.output, options.stats});
  const ThreadLimit threads(options.simulation.threads);
  const Footage footage = loadFootage(options, console);
  if (footage.recording.frames.empty()) throw Error("there are no frames to draw");
  if (options.video())
    shootVideo(footage, options, console);
  else
    writePng(Shooting(footage, options, console).at(options.time_s), options.output);
  if (!options.stats.empty()) writeStats(footage.recording, options.stats);
  console.say("wrote " + options.output);
  reportRecording(footage.recording, {options.output}, console);
}

// A CLI11 check out of a parser that throws.
template <class Parser>
std::function<std::string(const std::string&)> parsedBy(Parser parse) {
  return [parse](const std::string& text) -> std::string {
    try {
      parse(text);
      return {};
    } catch (const Error& error) {
      return error.what();
    }
  };
}

void addPictureOptions(CLI::App& command, RenderOptions& options) {
  command.add_option("--time", options.time_s, "Moment of a picture, in seconds (default: 0)")
      ->type_name("SECONDS")
      ->check(numberIn(0, 86400));
  command.add_option("--size", options.size, "Of the picture (default: 1280x720)")
      ->type_name("WxH")
      ->check([](const std::string& text) { return sizeProblem(text, 1, Renderer::kMaxSide); });
  command.add_option("--camera", options.camera, "From where (default: three-quarter); see below")
      ->type_name("VIEW")
      ->check(parsedBy(parseCamera));
  command.add_option("--layers", options.layers, "What to show: skeleton, muscle, skin or all")
      ->type_name("LIST")
      ->check(parsedBy(parseLayers));
  command.add_option("--fps", options.frame_rate_hz, "Frames per second of a video (default: 30)")
      ->type_name("HZ")
      ->check(numberIn(1, 240));
}

}  // namespace

void addRender(CLI::App& program, Console& console) {
  CLI::App& command = *program.add_subcommand("render", "Draw a picture or a video");
  const auto options = std::make_shared<RenderOptions>();
  command.add_option("INPUT", options->input, "A *.fascia.json or *.fcache file")
      ->required()
      ->type_name("");
  command.add_option("-o,--output", options->output, "File to write: .png or .mp4")
      ->type_name("FILE")
      ->required()
      ->check(endsIn({".png", ".mp4"}));
  addPictureOptions(command, *options);
  command.add_option("--stats", options->stats, "Write how the simulation went to this JSON file")
      ->type_name("FILE");
  options->simulation.addTo(command);
  console.addFlags(command);
  console.addVerboseFlag(command);
  command.footer(kFooter);
  command.callback([options, &console] { render(*options, console); });
}

}  // namespace fascia
