#include "rig_bake.h"

#include <fascia/render/rig_joints.h>

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

void checkRigBake(const Character& character, const RigBakeOptions& options) {
  if (options.as.empty() || character.def().rig) return;
  Issue issue;
  issue.message = "--as " + options.as + " needs a character with a rig; this one's skin is a grid";
  issue.hint = "leave --as out";
  throw Error(std::move(issue));
}

RigBakeReport writeRigBake(const Character& character, const Recording& recording,
                           const RigBakeOptions& options, const std::string& path) {
  const RigDef& rig = *character.def().rig;
  const std::vector<std::vector<Transform>> joints = jointFrames(character, recording);
  const RigClip clip{*rig.model, recording, joints, recording.motion, rig.scale};
  if (options.as == "cache") return writeRigAsCache(clip, path);
  if (options.as == "morphs")
    return writeRigAsMorphs(clip, MorphOptions{.targets = options.targets}, path);
  return writeRigAsBones(
      clip, DecompositionOptions{.helperBones = options.helpers, .influences = options.influences},
      path);
}

}  // namespace fascia
