#include <cmath>
#include <memory>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <fascia/base/parallel.h>
#include <fascia/skin/cloth/cloth_choice.h>

#include "bench/benches.h"
#include "bench/machine.h"
#include "bench/peers/peer.h"
#include "bench/sheet/fascia_sheet.h"
#include "bench/sheet/sheet_options.h"
#include "console.h"

namespace fascia {
namespace {

constexpr const char* kSheetFooter =
    R"(Cloth of 2 m x 2 m and 1 kg, pinned at two edges, over seven moving spheres, stepped by limits;
with --skin also a skin that stretches as little, stepped by the leapfrog. Beside them the soft bodies
of Bullet and Jolt, where those were found when this was built: each with its default effort, then
twice as much, and so on, until it stretches no more than our cloth. A speed counts only with what
stands beside it: how far edges stretch, how deep points are in the spheres, and how many were lost.

Examples:
  fascia bench sheet
  fascia bench sheet --points 10000 --threads 2 --steps 4 --runs 5)";

struct ClothBenchOptions : SheetOptions {
  std::vector<int> threads = {1, 2};
  int steps = 0;  // per frame; 0: as skins choose
  int runs = 3;
  bool skin = false;
};

// A skin as firm as stays below 10 % of stretch at so many points; larger ones take minutes.
constexpr double kFirmSkin_N_per_m = 1131, kFirmerSkin_N_per_m = 3200;
constexpr int kSmallSheet = 2000, kMostLeapfrogPoints = 20000;
// A peer is not asked to try harder where a run of it would take longer than this.
constexpr double kLongestPeerRun_s = 10;

class ClothBenchReport {
 public:
  explicit ClothBenchReport(const Console& console) : console_(console) {
    console.say(machineLine());
    console.say(
        "                                             × real time    stretch (%)   deepest");
    console.say(
        " points engine            setting threads  best  median      max   99 %     (mm)    lost");
  }

  void add(int points, const std::string& engine, const std::string& setting, int threads,
           const SheetResult& r) {
    console_.say(fmt::format("{:7} {:8} {:>16} {:7} {:7.2f} {:7.2f} {:7.1f} {:6.1f} {:8.2f} {:7}",
                             points, engine, setting, threads, r.fastRatio(), r.realtimeRatio(),
                             100 * r.stretch, 100 * r.stretch99, 1e3 * r.penetration_m, r.lost));
    results_.push_back(Json::Object{{"points", points},
                                    {"engine", engine},
                                    {"setting", setting},
                                    {"threads", threads},
                                    {"realtime_ratio", r.fastRatio()},
                                    {"realtime_ratio_median", r.realtimeRatio()},
                                    {"stretch_max", r.stretch},
                                    {"stretch_p99", r.stretch99},
                                    {"penetration_m", r.penetration_m},
                                    {"lost_points", static_cast<double>(r.lost)}});
  }
  void finish() {
    console_.answer(
        Json::Object{{"ok", true}, {"machine", machineInfo()}, {"results", std::move(results_)}});
  }

 private:
  const Console& console_;
  Json::List results_;
};

// The fastest of several runs, which are alike but for their time.
template <class Make>
SheetResult bestRun(const SheetScene& scene, const ClothBenchOptions& options, const Make& make) {
  SheetResult best;
  for (int run = 0; run < options.runs; ++run) {
    const std::unique_ptr<SheetSolver> solver = make();
    const SheetResult result = measureSheet(scene, *solver, options.frames);
    if (run == 0 || result.fastFrame_s < best.fastFrame_s) best = result;
  }
  return best;
}

SheetResult addFascia(const SheetScene& scene, const ClothBenchOptions& options,
                      const FasciaSettings& settings, const std::string& engine, int threads,
                      ClothBenchReport& report) {
  const ThreadLimit limit(threads);
  int steps = 0;
  const SheetResult result =
      bestRun(scene, options, [&] { return makeFasciaSheet(scene, settings, steps); });
  report.add(scene.side * scene.side, engine, fmt::format("{} steps", steps), threads, result);
  return result;
}

// The peer, trying harder and harder until it stretches no more than `stretch`.
void addPeer(const Peer& peer, const SheetScene& scene, const ClothBenchOptions& options,
             double stretch, int threads, ClothBenchReport& report) {
  double nextRun_s = 0;
  for (int effort = 1; nextRun_s < kLongestPeerRun_s; effort *= 2) {
    const SheetResult result =
        bestRun(scene, options, [&] { return peer.make(scene, effort, threads); });
    report.add(scene.side * scene.side, peer.name, peer.setting(effort), threads, result);
    if (result.stretch <= stretch) return;
    nextRun_s = 2 * result.frame_s * options.frames * options.runs;
  }
}

void runSheet(const ClothBenchOptions& options, const Console& console) {
  ClothBenchReport report(console);
  for (const int wanted : options.points) {
    const SheetScene scene{static_cast<int>(std::lround(std::sqrt(wanted)))};
    const int points = scene.side * scene.side;
    const auto chosen = static_cast<int>(
        std::lround(SheetScene::kFrame_s / clothStep_s(static_cast<std::size_t>(points))));
    double stretch = 0;
    for (const int threads : options.threads)
      stretch = addFascia(scene, options,
                          FasciaSettings::cloth(options.steps > 0 ? options.steps : chosen),
                          "cloth", threads, report)
                    .stretch;
    if (options.skin && points <= kMostLeapfrogPoints)
      addFascia(
          scene, options,
          FasciaSettings::skin(points < kSmallSheet ? kFirmSkin_N_per_m : kFirmerSkin_N_per_m),
          "skin", 1, report);
    for (const Peer& peer : sheetPeers())
      addPeer(peer, scene, options, stretch, peer.threaded ? options.threads.back() : 1, report);
  }
  report.finish();
}

}  // namespace

void addSheetBench(CLI::App& group, Console& console) {
  CLI::App& command = *group.add_subcommand("sheet", "Cloth on spheres, beside Bullet and Jolt");
  const auto options = std::make_shared<ClothBenchOptions>();
  addSheetOptions(command, *options);
  addNumbers(command, "--threads", options->threads, "Numbers of threads (default: 1,2)", 1, 1024);
  command.add_option("--steps", options->steps, "Steps of cloth in a frame (default: as skins)")
      ->type_name("N")
      ->check(numberIn(1, 1000));
  command.add_option("--runs", options->runs, "Runs, of which the fastest counts (default: 3)")
      ->type_name("N")
      ->check(numberIn(1, 100));
  command.add_flag("--skin", options->skin, "Also a firm skin, stepped by the leapfrog");
  console.addFlags(command);
  command.footer(kSheetFooter);
  command.callback([options, &console] { runSheet(*options, console); });
}

}  // namespace fascia
