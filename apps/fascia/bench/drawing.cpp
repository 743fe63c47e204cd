#include <algorithm>
#include <chrono>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <fascia/base/parallel.h>
#include <fascia/io/picture/image.h>
#include <fascia/render/renderer.h>

#include "bench/benches.h"
#include "bench/machine.h"
#include "console.h"
#include "example_files.h"
#include "film.h"

namespace fascia {
namespace {

constexpr const char* kDrawingFooter =
    R"(Milliseconds per frame: 'wall' passes on the clock, 'processor' is summed over all threads and
hardly minds what else the machine does. 'first' is a still picture with all that is made for it:
programs, textures, tables. 'frame' is the median of the frames after it, of which 'pose' is making
the scene from a recording. The passes are the same frames drawn again, waiting after each pass.

Examples:
  fascia bench drawing
  fascia bench drawing penguin.fcache body.fcache --size 640x360 --frames 30 --json)";

struct DrawingOptions {
  std::vector<std::string> files;
  std::string size = "1280x720";
  int frames = 12;
};

struct Span {
  double wall_s = 0, processor_s = 0;
};

template <class Work>
Span timed(const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  const std::clock_t processor = std::clock();
  work();
  const auto wall = std::chrono::steady_clock::now() - begin;
  return {std::chrono::duration<double>(wall).count(),
          static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC};
}

Span medianSpan(std::vector<Span> spans) {
  const auto middle = [&](double Span::*part) {
    std::ranges::sort(spans, {}, part);
    return spans[spans.size() / 2].*part;
  };
  return {middle(&Span::wall_s), middle(&Span::processor_s)};
}

// What one look costs.
struct LookCost {
  Span first, frame, pose, png;
  Renderer::PassTimes passes;  // means
};

// Moments spread over a film.
std::vector<double> momentsOf(const Film& film, int count) {
  std::vector<double> times_s;
  times_s.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i)
    times_s.push_back(film.start_s() + (film.end_s() - film.start_s()) * i / count);
  return times_s;
}

Renderer::PassTimes meanPasses(Renderer& renderer, Film& film, Size size,
                               const std::vector<double>& times_s) {
  Renderer::PassTimes sum;
  Pixels pixels;
  for (const double time_s : times_s) {
    const Renderer::PassTimes one =
        renderer.renderMeasured(film.at(time_s), size.width, size.height, pixels);
    sum.upload_s += one.upload_s, sum.shadow_s += one.shadow_s;
    sum.occlusion_s += one.occlusion_s, sum.beauty_s += one.beauty_s, sum.read_s += one.read_s;
  }
  const auto n = static_cast<double>(times_s.size());
  for (double* part : {&sum.upload_s, &sum.shadow_s, &sum.occlusion_s, &sum.beauty_s, &sum.read_s})
    *part /= n;
  return sum;
}

LookCost measureLook(Film& film, Look look, const DrawingOptions& options) {
  const Size size = parseSize(options.size);
  const std::vector<double> times_s = momentsOf(film, options.frames);
  LookCost cost;
  std::unique_ptr<Renderer> renderer;
  Pixels pixels;
  cost.first = timed([&] {
    renderer = std::make_unique<Renderer>(look);
    renderer->render(film.at(times_s.front()), size.width, size.height, pixels);
  });
  std::vector<Span> frames, poses;
  for (const double time_s : times_s) {
    Scene scene;
    poses.push_back(timed([&] { scene = film.at(time_s); }));
    frames.push_back(timed([&] { renderer->render(scene, size.width, size.height, pixels); }));
    frames.back().wall_s += poses.back().wall_s;
    frames.back().processor_s += poses.back().processor_s;
  }
  cost.frame = medianSpan(std::move(frames));
  cost.pose = medianSpan(std::move(poses));
  cost.passes = meanPasses(*renderer, film, size, times_s);
  Image image{pixels.width, pixels.height, std::move(pixels.rgba)};
  cost.png = timed([&] { encodePng(image); });
  return cost;
}

Json toJson(const Span& span) {
  return Json::Object{{"wall_ms", 1e3 * span.wall_s}, {"processor_ms", 1e3 * span.processor_s}};
}

Json describeCost(const std::string& file, const std::string& look, const LookCost& cost,
                  const Console& console) {
  const Renderer::PassTimes& p = cost.passes;
  const double whole_s = p.upload_s + p.shadow_s + p.occlusion_s + p.beauty_s + p.read_s;
  const auto share = [&](double part_s) { return whole_s > 0 ? 100 * part_s / whole_s : 0; };
  console.say(
      fmt::format("{} | {} | {:.0f} / {:.0f} | {:.0f} / {:.0f} | {:.1f} | {:.1f} | {:.0f} | {:.0f} "
                  "% | {:.0f} % | "
                  "{:.0f} % | {:.0f} %",
                  file, look, 1e3 * cost.first.wall_s, 1e3 * cost.first.processor_s,
                  1e3 * cost.frame.wall_s, 1e3 * cost.frame.processor_s, 1 / cost.frame.wall_s,
                  1e3 * cost.pose.wall_s, 1e3 * cost.png.wall_s, share(p.upload_s),
                  share(p.shadow_s), share(p.occlusion_s), share(p.beauty_s + p.read_s)));
  return Json::Object{{"file", file},
                      {"look", look},
                      {"first", toJson(cost.first)},
                      {"frame", toJson(cost.frame)},
                      {"pose", toJson(cost.pose)},
                      {"png", toJson(cost.png)},
                      {"passes_ms", Json::Object{{"upload", 1e3 * p.upload_s},
                                                 {"shadow", 1e3 * p.shadow_s},
                                                 {"occlusion", 1e3 * p.occlusion_s},
                                                 {"beauty", 1e3 * p.beauty_s},
                                                 {"read", 1e3 * p.read_s}}}};
}

void runDrawing(const DrawingOptions& options, const Console& console) {
  std::vector<std::string> files = options.files;
  if (files.empty()) files.push_back(findExamples() + "/penguin.fascia.json");
  const Size size = parseSize(options.size);
  console.say(machineLine() + ", " + options.size);
  console.say(
      "file | look | first, wall / processor ms | frame, wall / processor ms | frames/s | pose | "
      "PNG | upload | shadow | occlusion | light and read");
  Json::List results;
  for (const std::string& file : files) {
    SimulationOptions simulation;
    const FilmLook framing{
        .camera = {}, .layers = "skin", .aspect = static_cast<double>(size.width) / size.height};
    const std::unique_ptr<Film> film = makeFilm(file, simulation, {}, framing, console);
    const std::string name = file.substr(file.find_last_of('/') + 1);
    for (const auto& [look, word] : {std::pair(Look::full, "full"), {Look::fast, "fast"}})
      results.push_back(describeCost(name, word, measureLook(*film, look, options), console));
  }
  console.answer(
      Json::Object{{"ok", true}, {"machine", machineInfo()}, {"results", std::move(results)}});
}

}  // namespace

void addDrawingBench(CLI::App& group, Console& console) {
  CLI::App& command = *group.add_subcommand("drawing", "What pictures cost, in both looks");
  const auto options = std::make_shared<DrawingOptions>();
  command.add_option("FILE", options->files, "Characters, scenes or caches (default: the penguin)")
      ->type_name("");
  command.add_option("--size", options->size, "Of the pictures (default: 1280x720)")
      ->type_name("WxH")
      ->check([](const std::string& text) { return sizeProblem(text, 1, Renderer::kMaxSide); });
  command.add_option("--frames", options->frames, "Frames to draw of each (default: 12)")
      ->type_name("N")
      ->check(numberIn(1, 1e4));
  console.addFlags(command);
  command.footer(kDrawingFooter);
  command.callback([options, &console] { runDrawing(*options, console); });
}

}  // namespace fascia
