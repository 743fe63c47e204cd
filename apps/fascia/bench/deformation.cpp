#include <memory>

#include <CLI/CLI.hpp>

#include <fascia/base/parallel.h>

#include "bench/benches.h"
#include "bench/deformation/contest.h"
#include "bench/machine.h"
#include "example_files.h"
#include "input_kind.h"
#include "outputs.h"
#include "simulation_options.h"

namespace fascia {
namespace {

constexpr const char* kDeformationFooter =
    R"(Linear blending, dual quaternions, delta mush and Fascia on the same rig: single joints turned from
the bind pose, and motions. A rigged file that is no character (.glb …) is shown without Fascia;
'fascia flesh' makes a character of it. What is measured: docs/deformation.md.

Poses: bends (elbow and knee, to --angles), hips, shoulders, wrists, neck; all or none of them.
Motions: the file's own by name, all or none of them; motion capture (.bvh) is put onto the rig.

Examples:
  fascia bench deformation fox.glb
  fascia bench deformation fox.glb --poses none --motion Walk --motion Run
  fascia bench deformation fox.glb --poses bends,neck --motion Sit --pictures .
  fascia bench deformation fox.glb --poses bends --motion none --angles 90 --json)";

struct DeformationOptions : ContestOptions {
  std::vector<std::string> files;
};

void addIssues(std::vector<Issue>& issues, const Error& error, const std::string& file) {
  for (Issue issue : error.issues()) {
    if (issue.where.file.empty()) issue.where.file = file;
    issues.push_back(std::move(issue));
  }
}

// Every file that can be shown is; what is wrong with others, or could not be drawn, comes last.
void runDeformation(const DeformationOptions& options, const Console& console) {
  const ThreadLimit oneThread(1);
  if (!options.pictures.empty()) checkFolders({options.pictures + "/picture.png"});
  console.say(machineLine() + ", of which 1 is used");
  Json::List results;
  std::vector<Issue> issues;
  for (const std::string& file : options.files) {
    try {
      std::vector<Issue> found;
      withInput(file, {.command = "bench deformation", .character = true, .model = true}, [&] {
        const Entrant entrant = readEntrant(file);
        results.push_back(runContest(entrant, options, console, found));
      });
      if (!found.empty()) throw Error(std::move(found));
    } catch (const Error& error) {
      addIssues(issues, error, file);
    }
  }
  Json answer = Json::Object{
      {"ok", issues.empty()}, {"machine", machineInfo()}, {"results", std::move(results)}};
  if (!issues.empty()) answer.set("issues", toJson(issues));
  console.answer(answer);
  if (!issues.empty()) throw Error(std::move(issues));
}

}  // namespace

void addDeformationBench(CLI::App& group, Console& console) {
  CLI::App& command =
      *group.add_subcommand("deformation", "How well joints bend, beside other ways of skinning");
  const auto options = std::make_shared<DeformationOptions>();
  command.add_option("characters", options->files, "Characters with a rig, or rigged files")
      ->required()
      ->transform(exampleFiles())
      ->type_name("FILE …");
  command
      .add_option("--motion,--motions", options->motions,
                  "Motion to show, once or more (default: a walk, or the first)")
      ->allow_extra_args(false)
      ->type_name("NAME");
  command.add_option("--poses", options->poses, "Joints to turn, by commas (default: all)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("LIST")
      ->check(CLI::IsMember({"all", "none", "bends", "hips", "shoulders", "wrists", "neck"})
                  .description(""));
  command
      .add_option("--angles", options->angles_deg, "Of bends, between segments (default: 90,120)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("LIST")
      ->check(numberIn(0, 170));
  command.add_option("--seconds", options->seconds, "At most so much of a motion (default: 4)")
      ->type_name("SECONDS")
      ->check(numberIn(0.1, 600));
  command.add_option("--pictures", options->pictures, "Draw the poses, methods side by side")
      ->type_name("FOLDER");
  console.addFlags(command);
  command.footer(kDeformationFooter);
  command.callback([options, &console] { runDeformation(*options, console); });
}

}  // namespace fascia
