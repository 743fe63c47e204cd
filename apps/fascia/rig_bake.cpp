#include "rig_bake.h"

#include <algorithm>

#include <fascia/render/rig_joints.h>

#include "interrupt.h"
#include "outputs.h"
#include "progress.h"
#include "simulation_options.h"

namespace fascia {
namespace {

// World frames of the rig's joints in every frame of the recording.
std::vector<std::vector<Transform>> jointFrames(const Character& character,
                                                const Recording& recording) {
  const RigJoints joints(character);
  Posture posture = character.skeleton().restPosture();
  PosedSkeleton posed;
  std::vector<std::vector<Transform>> frames(recording.frames.size());
  for (std::size_t f = 0; f < frames.size(); ++f) {
    posture.values = recording.frames[f].posture;
    character.skeleton().pose(posture, posed);
    joints.world(posed, frames[f]);
  }
  return frames;
}

}  // namespace

void RigBakeOptions::addTo(CLI::App& command) {
  command_ = &command;
  command
      .add_option("--as", as, "How a .glb of a rig moves: bones, morphs or cache (default: bones)")
      ->type_name("WAY")
      ->check(CLI::IsMember({"bones", "morphs", "cache"}).description(""));
  command.add_option("--helpers", helpers, "Helper bones that --as bones adds (default: 20)")
      ->type_name("N")
      ->check(numberIn(0, 512));
  command.add_option("--influences", influences, "Weights per vertex, 4 or 8 (default: 4)")
      ->type_name("N")
      ->check(CLI::IsMember({4, 8}).description(""));
  command.add_option("--targets", targets, "Most targets that --as morphs makes (default: 16)")
      ->type_name("N")
      ->check(numberIn(1, 256));
}

std::vector<RigBakeOptions::Given> RigBakeOptions::given() const {
  std::vector<Given> all;
  for (const Given& g : {Given{"--as", ""}, Given{"--helpers", "bones"},
                         Given{"--influences", "bones"}, Given{"--targets", "morphs"}})
    if (command_ && command_->count(g.option) > 0) all.push_back(g);
  return all;
}

void checkRigBake(const Character& character, const RigBakeOptions& options,
                  const std::vector<std::string>& outputs) {
  const std::string way = options.as.empty() ? "bones" : options.as;
  const bool anyGlb = std::any_of(outputs.begin(), outputs.end(),
                                  [](const std::string& path) { return endingOf(path) == ".glb"; });
  for (const RigBakeOptions::Given& g : options.given()) {
    Issue issue;
    if (!character.def().rig)
      issue.message = g.option + " needs a character with a rig; this one's skin is a grid";
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
  if (!character.def().rig || options.as != "cache" || endingOf(output) != ".glb") return {output};
  return filesOfRigCache(*character.def().rig->model, output);
}

RigBakeReport writeRigBake(const Character& character, const Recording& recording,
                           const RigBakeOptions& options, const std::string& path,
                           const Console& console) {
  const RigDef& rig = *character.def().rig;
  const std::vector<std::vector<Transform>> joints = jointFrames(character, recording);
  const RigClip clip{*rig.model, recording, joints, recording.motion, rig.scale};
  if (options.as == "cache") return writeRigAsCache(clip, path);
  if (options.as == "morphs")
    return writeRigAsMorphs(clip, MorphOptions{.targets = options.targets}, path);
  ProgressBar progress(console, "fitting bones");
  DecompositionOptions fit;
  fit.helperBones = options.helpers;
  fit.influences = options.influences;
  fit.progress = [&](double share) {
    if (!progress.update(share)) throw Interrupted{};
  };
  return writeRigAsBones(clip, fit, path);
}

}  // namespace fascia
