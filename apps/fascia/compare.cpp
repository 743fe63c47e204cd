#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <fascia/render/renderer.h>

#include "commands.h"
#include "compare/comparison.h"
#include "example_files.h"
#include "outputs.h"

namespace fascia {
namespace {

constexpr const char* kCompareFooter =
    R"(INPUT is a character that 'fascia flesh' made, its cache, or a rigged mesh itself (.glb, .fbx, …),
which gets flesh as 'fascia flesh' gives it by default. Plain is what every program makes of the rig:
the same joints, points and weights, without Fascia.

A .png shows the worst moment of the motion, and the worst places in it closer; a .mp4 or .gif the
whole motion, with the place that is worst at its worst moment. What counts as bad: triangles that
pass through others as they do not at rest, that are turned inside out, that are stretched.

Cameras as in 'fascia render'. Without --camera the figure is seen from the side where the worst
places show. The camera of a film goes along with a figure that walks away.

Examples:
  fascia compare fox.glb --motion Run -o fox.png
  fascia flesh fox.glb -o fox.fascia.json
  fascia compare fox.fascia.json --motion Run -o fox.mp4 --size 1280x720
  fascia compare fox.fascia.json --motion Walk -o fox.gif --seconds 0.5 --turntable
  fascia compare fox.fascia.json --motion Jump -o jump.png --wipe --camera front
  fascia compare fox.fascia.json --against dual-quaternions --worst ours -o own.png --zooms 2)";

constexpr int kLeastSide = 160;  // pixels; less holds no letters

void addPictureOptions(CLI::App& command, CompareOptions& options) {
  command
      .add_option("--time", options.time_s, "Moment of a picture, in seconds (default: the worst)")
      ->type_name("SECONDS")
      ->check(numberIn(0, 86400));
  command
      .add_option("--size", options.size,
                  "Of it all (default: 1600x900; .mp4 1280x720; .gif 800x450)")
      ->type_name("WxH")
      ->check([](const std::string& text) {
        return sizeProblem(text, kLeastSide, Renderer::kMaxSide);
      });
  command.add_option("--camera", options.camera, "From where (default: where the worst shows)")
      ->type_name("VIEW")
      ->check(parsedBy(parseCamera));
  command
      .add_option("--fps", options.frame_rate_hz,
                  "Frames per second of a film (default: 30; .gif 20)")
      ->type_name("HZ")
      ->check(numberIn(1, 240));
  command
      .add_option("--zooms", options.zooms,
                  "Closer looks at the worst places (default: 3; films 1)")
      ->type_name("N")
      ->check(numberIn(0, 3));
  command.add_flag("--wipe", options.wipe, "One figure behind a line, which moves in films");
  command.add_flag("--turntable", options.turntable, "A film's camera goes around once");
  command.add_flag("--stand", options.stand, "A film's camera stands still");
}

void addSubjectOptions(CLI::App& command, CompareOptions& options) {
  SimulationOptions& simulation = options.simulation;
  command
      .add_option("--motion", simulation.motion,
                  "Motion to show (default: the first); a .bvh or .glb file is put onto the rig")
      ->type_name("NAME");
  command
      .add_option("--joint-map", simulation.joint_map,
                  "Which of that file's joints drive which of the rig's (default: guessed)")
      ->type_name("FILE");
  command.add_option("--seconds", simulation.duration_s, "So much of the motion (default: all)")
      ->type_name("SECONDS")
      ->check(numberIn(0.05, 86400));
  command
      .add_option("--threads", simulation.threads,
                  "Threads to use; 0 = all. The result is the same")
      ->type_name("N")
      ->check(numberIn(0, 1024));
  command
      .add_option("--against", options.against,
                  fmt::format("Plain skinning: {}", fmt::join(plainSkinnings(), ", ")))
      ->type_name("NAME")
      ->check(CLI::IsMember(plainSkinnings()).description(""));
  const std::map<std::string, Worst> kinds{
      {"plain", Worst::plain}, {"ours", Worst::ours}, {"difference", Worst::difference}};
  command
      .add_option("--worst", options.worst,
                  "What to look for: where plain is worst, ours is, or their difference is largest")
      ->type_name("SIDE")
      ->transform(CLI::CheckedTransformer(kinds).description(""));
}

}  // namespace

void addCompare(CLI::App& program, Console& console) {
  CLI::App& command = *program.add_subcommand(
      "compare", "Show a rig's plain skinning and Fascia's side by side, with the worst places");
  const auto options = std::make_shared<CompareOptions>();
  command.add_option("INPUT", options->input, "A character on a rig, or a rigged mesh")
      ->required()
      ->transform(exampleFiles())
      ->type_name("");
  command.add_option("-o,--output", options->output, "File to write: .png, .mp4 or .gif")
      ->type_name("FILE")
      ->required()
      ->check(endsIn({".png", ".mp4", ".gif"}));
  addSubjectOptions(command, *options);
  addPictureOptions(command, *options);
  console.addFlags(command);
  console.addVerboseFlag(command);
  command.footer(kCompareFooter);
  command.callback([options, &console] { compare(*options, console); });
}

}  // namespace fascia
