#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <fascia/base/parallel.h>

#include "bench/benches.h"
#include "bench/machine.h"
#include "bench/peers/bullet_sheet.h"
#include "bench/sheet/fascia_sheet.h"
#include "bench/sheet/sheet_options.h"
#include "console.h"
#include "simulation_options.h"

namespace fascia {
namespace {

constexpr const char* kPeersFooter =
    R"(A sheet of 2 m x 2 m and 1 kg, pinned at two edges, over seven moving spheres: once in Bullet's
soft body and once in Fascia, one thread each, in turn. Bullet's links are as stiff as it allows:
how far they stretch depends on how often they are solved. For each of its settings Fascia runs
with the softest material that stretches no more, and once alone with cloth that stays below 10 %.

Examples:
  fascia bench peers
  fascia bench peers --points 1000 --bullet 5x4,10x10)";

struct PeerOptions : SheetOptions {
  std::vector<std::string> bullet = {"5x4", "10x4"};
};

// Softest to stiffest material that is tried, in steps of a half octave.
constexpr double kSoftest_N_per_m = 6.25, kStiffest_N_per_m = 1e5;
// Frames of a run that only looks for the material.
constexpr int kSearchFrames = 60;
// Sheets larger than this would keep Bullet busy for many minutes; Fascia runs them alone, with the
// material of the last comparison.
constexpr int kMostBulletPoints = 20000;
// What a sheet of firm cloth may stretch; Fascia alone.
constexpr double kFirmStretch = 0.10;

struct FasciaRun {
  FasciaSettings settings;
  int stepsPerFrame = 0;
  SheetResult result;
};

FasciaRun runFascia(const SheetScene& scene, const FasciaSettings& settings, int frames) {
  FasciaRun run{settings, 0, {}};
  const std::unique_ptr<SheetSolver> sheet = makeFasciaSheet(scene, settings, run.stepsPerFrame);
  run.result = measureSheet(scene, *sheet, frames);
  return run;
}

// With the softest material that stretches no more than `limit`.
FasciaRun runFasciaWithin(const SheetScene& scene, double limit, int frames) {
  FasciaSettings settings;
  for (double stiffness = kSoftest_N_per_m; stiffness < kStiffest_N_per_m;
       stiffness *= std::sqrt(2)) {
    settings = FasciaSettings::skin(stiffness);
    if (!(runFascia(scene, settings, kSearchFrames).result.stretch <= limit)) continue;
    const FasciaRun run = runFascia(scene, settings, frames);
    if (run.result.stretch <= limit) return run;
  }
  return runFascia(scene, settings, frames);
}

class Report {
 public:
  explicit Report(const Console& console) : console_(console) {
    console.say(machineLine());
    console.say(
        "                                                 × real   stretch (%)   deepest   times");
    console.say(
        " points engine  setting                           time     max   99 %     (mm)  Bullet");
  }

  void add(const SheetScene& scene, const std::string& engine, const std::string& setting,
           int threads, const SheetResult& r, double timesBullet) {
    const int points = scene.side * scene.side;
    console_.say(fmt::format("{:7} {:7} {:30} {:8.2f} {:7.1f} {:6.1f} {:8.1f} {:>7}", points,
                             engine, setting, r.realtimeRatio(), 100 * r.stretch, 100 * r.stretch99,
                             1e3 * r.penetration_m,
                             timesBullet > 0 ? fmt::format("{:.1f}", timesBullet) : ""));
    Json entry = Json::Object{{"points", points},
                              {"engine", engine},
                              {"setting", setting},
                              {"threads", threads},
                              {"realtime_ratio", r.realtimeRatio()},
                              {"stretch_max", r.stretch},
                              {"stretch_p99", r.stretch99},
                              {"penetration_m", r.penetration_m}};
    if (timesBullet > 0) entry.set("times_bullet", timesBullet);
    results_.push_back(std::move(entry));
  }

  void add(const SheetScene& scene, const FasciaRun& run, int threads, double timesBullet) {
    std::string setting =
        fmt::format("{:.3g} N/m, {} steps", run.settings.stiffness_N_per_m, run.stepsPerFrame);
    if (threads > 1) setting += fmt::format(", {} threads", threads);
    add(scene, "Fascia", setting, threads, run.result, timesBullet);
  }

  void finish() {
    console_.answer(
        Json::Object{{"ok", true}, {"machine", machineInfo()}, {"results", std::move(results_)}});
  }

 private:
  const Console& console_;
  Json::List results_;
};

// Returns the material that Fascia needed at the last of Bullet's settings.
FasciaSettings compare(const SheetScene& scene, const PeerOptions& options, Report& report) {
  FasciaSettings last;
  for (const std::string& text : options.bullet) {
    const Size size = parseSize(text);
    const BulletSettings settings{size.width, size.height};
    const std::unique_ptr<SheetSolver> bullet = makeBulletSheet(scene, settings);
    const SheetResult theirs = measureSheet(scene, *bullet, options.frames);
    report.add(scene, "Bullet",
               fmt::format("{} substeps x {} iterations", settings.substeps, settings.iterations),
               1, theirs, 0);
    const FasciaRun ours = runFasciaWithin(scene, theirs.stretch, options.frames);
    report.add(scene, ours, 1, theirs.frame_s / ours.result.frame_s);
    last = ours.settings;
  }
  return last;
}

void runPeers(const PeerOptions& options, const Console& console) {
  Report report(console);
  FasciaSettings settings;
  for (const int points : options.points) {
    const SheetScene scene{static_cast<int>(std::lround(std::sqrt(points)))};
    const ThreadLimit oneThread(1);
    if (points <= kMostBulletPoints) {
      settings = compare(scene, options, report);
      report.add(scene, runFasciaWithin(scene, kFirmStretch, options.frames), 1, 0);
    } else {
      report.add(scene, runFascia(scene, settings, options.frames), 1, 0);
    }
  }
  report.finish();
}

}  // namespace

void addPeersBench(CLI::App& group, Console& console) {
  CLI::App& command = *group.add_subcommand("peers", "A sheet on spheres, beside Bullet");
  const auto options = std::make_shared<PeerOptions>();
  addSheetOptions(command, *options);
  command
      .add_option("--bullet", options->bullet,
                  "Bullet's settings, SUBSTEPSxITERATIONS (default: 5x4,10x4)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("LIST")
      ->check([](const std::string& text) { return sizeProblem(text, 1, 1000); });
  console.addFlags(command);
  command.footer(kPeersFooter);
  command.callback([options, &console] { runPeers(*options, console); });
}

}  // namespace fascia
