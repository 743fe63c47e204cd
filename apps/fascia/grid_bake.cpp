#include "grid_bake.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "outputs.h"
#include "progress.h"

namespace fascia {
namespace {

// If nothing is said, morph targets are added until the skin is, by RMS, within half a pixel of a
// character that is a thousand pixels high; but no more than games like.
constexpr double kTolerance = 5e-4;  // of the height
constexpr int kMostTargets = 32;

std::string wayOf(const RigBakeOptions& options) {
  return options.as.empty() ? "morphs" : options.as;
}

bool isGiven(const RigBakeOptions& options, const std::string& option) {
  const std::vector<RigBakeOptions::Given> given = options.given();
  return std::any_of(given.begin(), given.end(),
                     [&](const RigBakeOptions::Given& g) { return g.option == option; });
}

double heightOf_m(const Recording& recording) {
  Box box;
  for (const Eigen::Vector3f& p : recording.frames.front().skin_m) box.add(p.cast<double>());
  return box.size().y();
}

}  // namespace

bool isSmallGridBake(const Character& character, const RigBakeOptions& options) {
  return character.skin() && !character.skin()->rigged() && wayOf(options) != "cache";
}

GridBakeReport writeGridBake(const Character& character,
                             std::span<const Recording* const> recordings,
                             const RigBakeOptions& options, const std::string& path,
                             const Console& console) {
  GridBakeOptions fit;
  fit.way = wayOf(options) == "bones" ? GridWay::bones : GridWay::morphs;
  fit.bones.helperBones = options.helpers;
  fit.bones.influences = options.influences;
  fit.bones.tolerance_m = 0.01 * options.tolerance_percent * heightOf_m(*recordings.front());
  fit.bones.mostHelpers = std::max(options.helpers, kMostHelpers);
  // A number of targets that was asked for is made, however small the error is before.
  const bool asked = isGiven(options, "--targets");
  fit.morphs.targets = asked ? options.targets : kMostTargets;
  fit.morphs.tolerance_m = asked ? 0 : kTolerance * heightOf_m(*recordings.front());
  fit.morphs.sparsity = 0.01;
  ProgressBar progress(console, "fitting the skin");
  fit.bones.progress = [&](double share) { progress.update(share); };
  return writeGridGlb(character, recordings, fit, path);
}

Json describe(const GridBakeReport& report, std::span<const Recording* const> recordings,
              const RigBakeOptions& options, const std::string& path, const Console& console) {
  const double percent = 0.1 / std::max(heightOf_m(*recordings.front()), 1e-9);
  console.say(fmt::format("{}: {:.0f} kB, {} {}", path, 1e-3 * static_cast<double>(report.bytes),
                          report.added,
                          wayOf(options) == "bones" ? "helper bones" : "morph targets"));
  Json::List motions;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const BakeError& error = report.errors[r];
    const std::string& motion = recordings[r]->motion;
    console.say(fmt::format(
        "  {}: error {:.2g} mm RMS, {:.2g} mm at most ({:.2g} % and {:.2g} % of the height)",
        motion.empty() ? "rest" : motion, error.rms_mm, error.max_mm, percent * error.rms_mm,
        percent * error.max_mm));
    motions.push_back(Json::Object{{"motion", motion},
                                   {"rms_mm", error.rms_mm},
                                   {"max_mm", error.max_mm},
                                   {"rms_percent", percent * error.rms_mm},
                                   {"max_percent", percent * error.max_mm}});
  }
  return Json::Object{{"file", path},
                      {"added", static_cast<int>(report.added)},
                      {"bytes", static_cast<double>(report.bytes)},
                      {"motions", std::move(motions)}};
}

}  // namespace fascia
