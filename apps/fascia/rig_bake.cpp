#include "rig_bake.h"

#include <algorithm>

#include <fmt/format.h>

#include "outputs.h"
#include "progress.h"
#include "simulation_options.h"

namespace fascia {
namespace {

// They are looked for in some of the frames: what all frames together have more.
constexpr double kMargin = 0.96;
// Other motions that change by more than this share of the height are told one by one, in percent.
constexpr double kMostChange_percent = 2;

double percentOf(double mm, const RiggedModel& rig) {
  return 0.1 * mm / std::max(rig.height_m(), 1e-9);
}

Json toJson(const std::vector<RigBakeReport::Motion>& motions, const RiggedModel& rig) {
  Json::List list;
  for (const RigBakeReport::Motion& m : motions)
    list.push_back(Json::Object{{"motion", m.name},
                                {"rms_mm", m.error.rms_mm},
                                {"max_mm", m.error.max_mm},
                                {"rms_percent", percentOf(m.error.rms_mm, rig)},
                                {"max_percent", percentOf(m.error.max_mm, rig)}});
  return list;
}

std::string added(const RigBakeReport& report, const RigBakeOptions& options) {
  if (report.plain) return "nothing moves beyond the rig's own skinning, nothing added";
  if (options.as == "morphs") return fmt::format("{} morph targets added", report.added);
  if (options.as == "cache") return "every vertex of every frame";
  return fmt::format("{} helper bones added", report.added);
}

// Whether the helpers did what was asked.
void sayHelpers(const RigBakeReport& report, const RigBakeOptions& options, const RiggedModel& rig,
                const Console& console) {
  if (report.plain || options.tolerance_percent <= 0) return;
  double rms_percent = 0;  // of the motion that has the largest
  for (const RigBakeReport::Motion& m : report.baked)
    rms_percent = std::max(rms_percent, percentOf(m.error.rms_mm, rig));
  const auto asked = static_cast<std::size_t>(options.helpers);
  const bool reached = rms_percent <= options.tolerance_percent;
  if (reached && report.added > asked)
    console.say(fmt::format("  {} more than --helpers {}, for an error below {:.3g} %",
                            report.added - asked, asked, options.tolerance_percent));
  if (!reached)
    console.say(fmt::format("  the error stays above {:.3g} % of the height: {}",
                            options.tolerance_percent,
                            options.influences < 8 ? "--influences 8 or --as morphs come closer"
                                                   : "more --helpers or --as morphs come closer"));
}

void sayOthers(const RigBakeReport& report, const RiggedModel& rig, const Console& console) {
  if (report.others.empty()) return;
  double worst = 0;
  std::size_t beyond = 0;
  for (const RigBakeReport::Motion& m : report.others) {
    const double percent = percentOf(m.error.max_mm, rig);
    worst = std::max(worst, percent);
    if (percent <= kMostChange_percent) continue;
    ++beyond;
    console.say(fmt::format("  {}, which is not baked, changes by up to {:.2g} % of the height",
                            m.name, percent));
  }
  const std::size_t within = report.others.size() - beyond;
  if (within == 0) return;
  console.say(fmt::format("  {} {} not baked {} within {:.2g} % of the rig's own skinning", within,
                          within == 1 ? "motion" : "motions", within == 1 ? "stays" : "stay",
                          beyond ? kMostChange_percent : worst));
}

}  // namespace

void RigBakeOptions::addTo(CLI::App& command) {
  command_ = &command;
  command
      .add_option(
          "--as", as,
          "How a .glb moves: bones, morphs or cache (default: bones; without a rig: morphs)")
      ->type_name("WAY")
      ->check(CLI::IsMember({"bones", "morphs", "cache"}).description(""));
  command.add_option("--helpers", helpers, "Helper bones that --as bones adds (default: 20)")
      ->type_name("N")
      ->check(numberIn(0, 512));
  command
      .add_option("--tolerance", tolerance_percent,
                  "More helpers come by themselves until the error is below, in percent of the "
                  "height; 0 = no more (default: 0.2)")
      ->type_name("PERCENT")
      ->check(numberIn(0, 100));
  command.add_option("--influences", influences, "Weights per vertex, 4 or 8 (default: 4)")
      ->type_name("N")
      ->check(CLI::IsMember({4, 8}).description(""));
  command
      .add_option(
          "--targets", targets,
          "Most targets that --as morphs makes (default: 16; without a rig: as the error asks for)")
      ->type_name("N")
      ->check(numberIn(1, 256));
  command
      .add_option("--spring-bones", springs,
                  "Swinging chains of a VRM: keep, or replace those that the bake moves already "
                  "(default: keep)")
      ->type_name("HOW")
      ->check(CLI::IsMember({"keep", "replace"}).description(""));
}

std::vector<RigBakeOptions::Given> RigBakeOptions::given() const {
  std::vector<Given> all;
  for (const Given& g :
       {Given{"--as", ""}, Given{"--helpers", "bones"}, Given{"--tolerance", "bones"},
        Given{"--influences", "bones"}, Given{"--targets", "morphs"}, Given{"--spring-bones", ""}})
    if (command_ && command_->count(g.option) > 0) all.push_back(g);
  return all;
}

void checkRigBake(const Character& character, const RigBakeOptions& options,
                  const std::vector<std::string>& outputs) {
  const std::string usual = character.def().rig ? "bones" : "morphs";
  const std::string way = options.as.empty() ? usual : options.as;
  const bool anyGlb = std::any_of(outputs.begin(), outputs.end(), isGlb);
  for (const RigBakeOptions::Given& g : options.given()) {
    Issue issue;
    if (!character.skin() && !character.def().rig)
      issue.message = g.option + " says how a skin moves, and this character has none";
    else if (!anyGlb)
      issue.message = g.option + " says how a .glb moves, and none is to be written";
    else if (!g.way.empty() && g.way != way)
      issue.message = g.option + " belongs to --as " + g.way + ", not to --as " + way;
    else
      continue;
    issue.hint = "leave " + g.option + " out";
    throw Error(std::move(issue));
  }
}

std::vector<std::string> filesOf(const Character& character, const RigBakeOptions& options,
                                 const std::string& output) {
  if (!character.def().rig || options.as != "cache" || !isGlb(output)) return {output};
  return filesOfRigCache(*character.def().rig->model, output);
}

RigBakeReport writeRigBake(const CharacterDef& def, std::span<const Shot> shots,
                           const RigBakeOptions& options, const std::string& path,
                           const Console& console) {
  const RigDef& rig = *def.rig;
  std::vector<RigClip> clips;
  for (const Shot& shot : shots)
    clips.push_back(
        {*rig.model, shot.recording, shot.joints_world, shot.recording.motion, rig.scale});
  const RigFileOptions file{.replaceSprings = options.springs == "replace"};
  if (options.as == "cache") return writeRigAsCache(clips.front(), path);
  if (options.as == "morphs") {
    ProgressBar progress(console, "fitting morph targets");
    progress.update(0);  // how long it takes is not known
    return writeRigAsMorphs(clips, MorphOptions{.targets = options.targets}, path, file);
  }
  ProgressBar progress(console, "fitting bones");
  DecompositionOptions fit;
  fit.helperBones = options.helpers;
  fit.influences = options.influences;
  fit.tolerance_m = kMargin * 0.01 * options.tolerance_percent * rig.model->height_m();
  fit.mostHelpers = std::max(options.helpers, kMostHelpers);
  fit.progress = [&](double share) { progress.update(share); };
  return writeRigAsBones(clips, fit, path, file);
}

Json describe(const RigBakeReport& report, const RigBakeOptions& options, const RiggedModel& rig,
              const std::string& path, const Console& console) {
  const BakeError& error = report.error;
  console.say(
      fmt::format("{}: {}; error {:.3g} mm RMS, {:.3g} mm at most ({:.2g} % and {:.2g} % of the "
                  "height)",
                  path, added(report, options), error.rms_mm, error.max_mm,
                  percentOf(error.rms_mm, rig), percentOf(error.max_mm, rig)));
  if (report.baked.size() > 1)
    for (const RigBakeReport::Motion& m : report.baked)
      console.say(fmt::format("  {}: {:.2g} % RMS, {:.2g} % at most", m.name,
                              percentOf(m.error.rms_mm, rig), percentOf(m.error.max_mm, rig)));
  if (options.as.empty() || options.as == "bones") sayHelpers(report, options, rig, console);
  if (options.as != "cache") sayOthers(report, rig, console);
  Json::List notes;
  for (const std::string& note : report.notes) {
    console.say("  note: " + note);
    notes.emplace_back(note);
  }
  return Json::Object{{"file", path},
                      {"added", static_cast<int>(report.added)},
                      {"plain", report.plain},
                      {"rms_mm", error.rms_mm},
                      {"max_mm", error.max_mm},
                      {"rms_percent", percentOf(error.rms_mm, rig)},
                      {"max_percent", percentOf(error.max_mm, rig)},
                      {"baked", toJson(report.baked, rig)},
                      {"others", toJson(report.others, rig)},
                      {"notes", std::move(notes)}};
}

}  // namespace fascia
