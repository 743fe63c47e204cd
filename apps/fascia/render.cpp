#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <fascia/base/parallel.h>
#include <fascia/io/file/file.h>
#include <fascia/io/picture/image.h>
#include <fascia/io/picture/video_writer.h>
#include <fascia/render/character_scene.h>
#include <fascia/render/renderer.h>

#include "commands.h"
#include "example_files.h"
#include "film.h"
#include "input_kind.h"
#include "outputs.h"
#include "progress.h"
#include "simulation_options.h"

namespace fascia {
namespace {

constexpr const char* kRenderFooter =
    R"(INPUT is a character or a scene, which is simulated first, or a cache that 'fascia bake' wrote. A
.png shows the moment --time, a .mp4 the whole motion (without ffmpeg: a folder of pictures).

Cameras: front, side, back, top, three-quarter; az=30,el=15 (degrees), with dist=2 or fov=40;
eye=1,2,3;target=0,1,0 (metres). The character faces +z, y is up.

Examples:
  fascia render examples/penguin.fascia.json --time 1.5 -o penguin.png
  fascia render examples/penguin.fascia.json --layers skeleton,muscle,skin -o layers.png
  fascia render examples/sky-hook.fascia.json --seed 7 -o sky-hook.mp4
  fascia bake examples/penguin.fascia.json -o penguin.fcache
  fascia render penguin.fcache --camera az=60,el=10 --size 1280x720 --fps 60 -o penguin.mp4)";

struct RenderOptions {
  std::string input, output, stats;
  std::string size = "1280x720", camera, layers = "skin", look = "full";
  double time_s = 0;
  double frame_rate_hz = 30;
  SimulationOptions simulation;

  bool video() const { return endingOf(output) == ".mp4"; }
  Look drawnLook() const { return look == "fast" ? Look::fast : Look::full; }
};

// Draws moments of a film.
class Shooting {
 public:
  Shooting(Film& film, Size size, Look look) : film_(film), size_(size), renderer_(look) {}

  const Image& at(double time_s) {
    renderer_.render(film_.at(time_s), size_.width, size_.height, pixels_);
    image_.width = pixels_.width;
    image_.height = pixels_.height;
    image_.rgba.swap(pixels_.rgba);
    return image_;
  }

 private:
  Film& film_;
  Size size_;
  Renderer renderer_;
  Pixels pixels_;
  Image image_;
};

void shootVideo(Film& film, Size size, const RenderOptions& options, const Console& console) {
  ProgressBar progress(console, "drawing");
  Shooting shooting(film, size, options.drawnLook());
  const double length_s = film.end_s() - film.start_s();
  const int frames = std::max(1, static_cast<int>(std::lround(length_s * options.frame_rate_hz)));
  VideoWriter video(options.output, size.width, size.height,
                    {.frame_rate_hz = options.frame_rate_hz});
  for (int i = 0; i < frames; ++i) {
    video.add(shooting.at(film.start_s() + i / options.frame_rate_hz));
    progress.update((i + 1.0) / frames);
  }
  video.finish();
  if (!video.hint().empty()) console.hint(video.hint());
}

void render(RenderOptions& options, const Console& console) {
  checkFolders({options.output, options.stats});
  checkOverwriting({options.output}, options.stats);
  const ThreadLimit threads(options.simulation.threads);
  const Size size = parseSize(options.size);
  const FilmLook look{.camera = options.camera,
                      .layers = options.layers,
                      .aspect = static_cast<double>(size.width) / size.height};
  std::unique_ptr<Film> film;
  withInput(options.input,
            {.command = "render", .character = true, .scene = true, .recording = true}, [&] {
              film = makeFilm(options.input, options.simulation,
                              options.video() ? std::optional<double>() : options.time_s, look,
                              console);
            });
  if (options.video())
    shootVideo(*film, size, options, console);
  else
    writePng(Shooting(*film, size, options.drawnLook()).at(options.time_s), options.output);
  if (!options.stats.empty()) writeFileWhole(options.stats, film->stats());
  console.say("wrote " + options.output);
  film->report({options.output}, console);
}

void addPictureOptions(CLI::App& command, RenderOptions& options) {
  command.add_option("--time", options.time_s, "Moment of a picture, in seconds (default: 0)")
      ->type_name("SECONDS")
      ->check(numberIn(0, 86400));
  command.add_option("--size", options.size, "Of the picture (default: 1280x720)")
      ->type_name("WxH")
      ->check([](const std::string& text) { return sizeProblem(text, 1, Renderer::kMaxSide); });
  command
      .add_option("--camera", options.camera,
                  "From where (default: three-quarter, or as a scene says); see below")
      ->type_name("VIEW")
      ->check(parsedBy(parseCamera));
  command.add_option("--layers", options.layers, "What to show: skeleton, muscle, skin or all")
      ->type_name("LIST")
      ->check(parsedBy(parseLayers));
  command
      .add_option("--look", options.look,
                  "full, or fast: plain light and hard shadows, several times as fast "
                  "(default: full)")
      ->type_name("LOOK")
      ->check(CLI::IsMember({"full", "fast"}).description(""));
  command.add_option("--fps", options.frame_rate_hz, "Frames per second of a video (default: 30)")
      ->type_name("HZ")
      ->check(numberIn(1, 240));
}

}  // namespace

void addRender(CLI::App& program, Console& console) {
  CLI::App& command = *program.add_subcommand("render", "Draw a picture or a video");
  const auto options = std::make_shared<RenderOptions>();
  command
      .add_option("INPUT", options->input,
                  "A *.fascia.json or *.fcache file of a character or scene")
      ->required()
      ->transform(exampleFiles())
      ->type_name("");
  command.add_option("-o,--output", options->output, "File to write: .png or .mp4")
      ->type_name("FILE")
      ->required()
      ->check(endsIn({".png", ".mp4"}));
  addPictureOptions(command, *options);
  command.add_option("--stats", options->stats, "Write how the simulation went to this JSON file")
      ->type_name("FILE");
  options->simulation.addMotionTo(command);
  options->simulation.addTo(command);
  console.addFlags(command);
  console.addVerboseFlag(command);
  command.footer(kRenderFooter);
  command.callback([options, &console] { render(*options, console); });
}

}  // namespace fascia
