#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <fascia/base/parallel.h>
#include <fascia/io/character_file.h>
#include <fascia/io/rig_file.h>
#include <fascia/io/rig_import.h>

#include "bench/benches.h"
#include "bench/deformation/judge.h"
#include "bench/deformation/pictures.h"
#include "bench/machine.h"
#include "outputs.h"
#include "simulation_options.h"

namespace fascia {
namespace {

constexpr const char* kFooter =
    R"(Linear blending, dual quaternions, delta mush and Fascia on the same rig: elbow and knee bent to
--angles, and a motion. A rigged file that is no character (.glb …) is shown without Fascia;
'fascia flesh' makes a character of it. What is measured: docs/deformation.md.

Examples:
  fascia bench deformation fox.fascia.json
  fascia bench deformation fox.fascia.json human.fascia.json --motion Walk --pictures /tmp/bends
  fascia bench deformation human.glb --poses --angles 90 --json)";

// Limbs that are bent as far in the bind pose already show nothing.
constexpr double kLeastTurn_deg = 10;

struct DeformationOptions {
  std::vector<std::string> files;
  std::string motion;
  std::vector<double> angles_deg = {90, 120};
  double seconds = 4;
  bool posesOnly = false;
  std::string pictures;
};

// What a file gives: a rig, and a character if it is one.
struct Entrant {
  std::string name;
  std::shared_ptr<const RiggedModel> model;
  std::optional<CharacterDef> character;
};

Entrant readEntrant(const std::string& path) {
  const std::string name = std::filesystem::path(path).filename().string();
  if (endingOf(path) != ".json")
    return {name, std::make_shared<const RiggedModel>(readRiggedModel(path)), std::nullopt};
  CharacterFile file = readCharacterFile(path);
  if (!file.def.rig) {
    Issue issue;
    issue.where.file = path;
    issue.message = "has no rig, and so nothing that other ways of skinning could deform";
    issue.hint = "make a character of a rigged file with 'fascia flesh'";
    throw Error(issue);
  }
  if (!file.def.rig->model) file.def.rig->model = loadRig(file.def);
  std::shared_ptr<const RiggedModel> model = file.def.rig->model;
  return {name, std::move(model), std::move(file.def)};
}

// The motion of that name; without one a walk, or else the first. nullptr: there is none.
const SampledMotion* findMotion(const RiggedModel& model, const std::string& name) {
  const auto named = [&name](const SampledMotion& motion) {
    std::string lower = motion.name;
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return name.empty() ? lower.find("walk") != std::string::npos : motion.name == name;
  };
  const auto found = std::find_if(model.motions.begin(), model.motions.end(), named);
  if (found != model.motions.end()) return &*found;
  if (name.empty()) return model.motions.empty() ? nullptr : &model.motions.front();
  std::string known;
  for (const SampledMotion& motion : model.motions)
    known += (known.empty() ? "" : ", ") + motion.name;
  throw Error("no motion is named '" + name + "'; there are: " + known);
}

Json toJson(const EdgeStretch& stretch, const SkinSlide& slide, std::size_t crossings) {
  return Json::Object{{"new_crossings", static_cast<int>(crossings)},
                      {"stretch_percentile99", stretch.percentile99},
                      {"stretch_largest", stretch.largest},
                      {"slide_rms_m", slide.rms_m},
                      {"slide_largest_m", slide.largest_m}};
}

std::string commonColumns(const std::string& name, std::size_t crossings,
                          const EdgeStretch& stretch, const SkinSlide& slide) {
  return fmt::format("{:17} {:9} {:8.3f} {:8.3f} {:8.1f} {:8.1f}", name, crossings,
                     stretch.percentile99, stretch.largest, 1e3 * slide.rms_m,
                     1e3 * slide.largest_m);
}

constexpr const char* kHeadings = "                        new    edge stretch        slide (mm)";
constexpr const char* kColumns = "                  crossings     99 %  largest      RMS  largest";

// One rig against all its contenders.
class Contest {
 public:
  Contest(const Entrant& entrant, const DeformationOptions& options, const Console& console)
      : entrant_(entrant),
        model_(*entrant.model),
        options_(options),
        console_(console),
        judge_(model_),
        contenders_(makeContenders(model_, entrant.character ? &*entrant.character : nullptr)) {}

  Json run() {
    console_.say(fmt::format("\n{}: {} points, {} triangles, {} joints; {} crossings at rest",
                             entrant_.name, model_.points_m.size(), model_.triangles.size(),
                             model_.joints.size(), judge_.crossingsAtRest()));
    if (!entrant_.character)
      console_.hint(entrant_.name + " is a rig without flesh: Fascia does not take part");
    Json::List bends;
    for (const Hinge& hinge : findHinges(model_))
      for (const double angle_deg : options_.angles_deg)
        if (degrees(hinge.turnFor_rad(radians(angle_deg))) > kLeastTurn_deg)
          bends.push_back(bend(hinge, angle_deg));
    if (bends.empty()) console_.say("no joint bends so far like an elbow or a knee");
    Json result = Json::Object{{"name", entrant_.name},
                               {"points", static_cast<int>(model_.points_m.size())},
                               {"triangles", static_cast<int>(model_.triangles.size())},
                               {"crossings_at_rest", static_cast<int>(judge_.crossingsAtRest())},
                               {"bends", std::move(bends)}};
    if (options_.posesOnly) return result;
    if (const SampledMotion* motion = findMotion(model_, options_.motion))
      result.set("clip", clip(*motion));
    return result;
  }

 private:
  Json bend(const Hinge& hinge, double angle_deg) {
    const std::string& joint = model_.joints[hinge.joint].name;
    const double turn_deg = degrees(hinge.turnFor_rad(radians(angle_deg)));
    console_.say(
        fmt::format("\n{} bent to {:.0f}° (turned by {:.0f}°)", joint, angle_deg, turn_deg));
    console_.say(fmt::format("{}  volume lost (%)", kHeadings));
    console_.say(fmt::format("{}    total at rest", kColumns));
    const ContestStage stage =
        makeContestStage(model_, bendMotion(model_, hinge, radians(angle_deg)), 2);
    std::optional<BendPictures> pictures;
    if (!options_.pictures.empty()) pictures.emplace(model_, hinge);
    Json::List rows;
    for (const auto& contender : contenders_) {
      const ContestFrames performance = contender->perform(stage, console_);
      const BendScore score = judge_.judgeBend(hinge, stage, performance);
      console_.say(
          fmt::format("{} {:8.1f} {:7.1f}",
                      commonColumns(contender->name(), score.crossings, score.stretch, score.slide),
                      100 * score.volume_loss, 100 * score.loss_at_rest));
      Json row = toJson(score.stretch, score.slide, score.crossings);
      row.set("method", contender->name());
      row.set("volume_loss", score.volume_loss);
      row.set("volume_loss_at_rest", score.loss_at_rest);
      rows.push_back(std::move(row));
      if (pictures) pictures->add(renderer(), performance.frames.back());
    }
    if (pictures) pictures->write(pictureFile(joint, angle_deg));
    return Json::Object{
        {"joint", joint}, {"angle_deg", angle_deg}, {"turn_deg", turn_deg}, {"results", rows}};
  }

  Json clip(const SampledMotion& motion) {
    const ContestStage stage = makeContestStage(model_, motion, options_.seconds);
    console_.say(fmt::format("\n{}, {} frames", motion.name, stage.motions.size()));
    console_.say(fmt::format("{}   jitter        ms", kHeadings));
    console_.say(fmt::format("{}     (µm)    /frame", kColumns));
    Json::List rows;
    for (const auto& contender : contenders_) {
      const ContestFrames performance = contender->perform(stage, console_);
      const ClipScore score = judge_.judgeClip(stage, performance);
      console_.say(
          fmt::format("{} {:8.1f} {:9.3f}",
                      commonColumns(contender->name(), score.crossings, score.stretch, score.slide),
                      1e6 * score.jitter_m, 1e3 * performance.frame_s));
      Json row = toJson(score.stretch, score.slide, score.crossings);
      row.set("method", contender->name());
      row.set("jitter_m", score.jitter_m);
      row.set("frame_s", performance.frame_s);
      rows.push_back(std::move(row));
    }
    return Json::Object{{"motion", motion.name},
                        {"frames", static_cast<int>(stage.motions.size())},
                        {"results", rows}};
  }

  Renderer& renderer() {
    if (!renderer_) renderer_.emplace();
    return *renderer_;
  }

  std::string pictureFile(std::string joint, double angle_deg) const {
    for (char& c : joint)
      if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
    const std::string stem = entrant_.name.substr(0, entrant_.name.find('.'));
    return fmt::format("{}/{}-{}-{:.0f}.png", options_.pictures, stem, joint, angle_deg);
  }

  const Entrant& entrant_;
  const RiggedModel& model_;
  const DeformationOptions& options_;
  const Console& console_;
  Judge judge_;
  std::vector<std::unique_ptr<Contender>> contenders_;
  std::optional<Renderer> renderer_;
};

void runDeformation(const DeformationOptions& options, const Console& console) {
  const ThreadLimit oneThread(1);
  if (!options.pictures.empty()) checkFolders({options.pictures + "/picture.png"});
  console.say(machineLine() + ", of which 1 is used");
  Json::List results;
  for (const std::string& file : options.files) {
    const Entrant entrant = readEntrant(file);
    results.push_back(Contest(entrant, options, console).run());
  }
  console.answer(
      Json::Object{{"ok", true}, {"machine", machineInfo()}, {"results", std::move(results)}});
}

}  // namespace

void addDeformationBench(CLI::App& group, Console& console) {
  CLI::App& command =
      *group.add_subcommand("deformation", "How well joints bend, beside other ways of skinning");
  const auto options = std::make_shared<DeformationOptions>();
  command.add_option("characters", options->files, "Characters with a rig, or rigged files")
      ->required()
      ->type_name("FILE …");
  command.add_option("--motion", options->motion, "Motion to show (default: a walk, or the first)")
      ->type_name("NAME");
  command
      .add_option("--angles", options->angles_deg, "Between the limb's segments (default: 90,120)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("LIST")
      ->check(numberIn(0, 170));
  command.add_option("--seconds", options->seconds, "At most so much of the motion (default: 4)")
      ->type_name("SECONDS")
      ->check(numberIn(0.1, 600));
  command.add_flag("--poses", options->posesOnly, "Bent joints only, no motion");
  command.add_option("--pictures", options->pictures, "Draw the bends, methods side by side")
      ->type_name("FOLDER");
  console.addFlags(command);
  command.footer(kFooter);
  command.callback([options, &console] { runDeformation(*options, console); });
}

}  // namespace fascia
