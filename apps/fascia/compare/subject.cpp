#include "compare/subject.h"

#include <fmt/core.h>

#include <fascia/character/flesh_character.h>
#include <fascia/io/cache/cache.h>
#include <fascia/io/cache/scene_cache.h>
#include <fascia/io/documents/character_file.h>
#include <fascia/io/documents/scene_file.h>
#include <fascia/io/rig_import/rig_import.h>

#include "film_parts.h"
#include "input_kind.h"
#include "outputs.h"
#include "progress.h"

namespace fascia {
namespace {

[[noreturn]] void refuse(const std::string& file, const std::string& message,
                         const std::string& hint) {
  Issue issue;
  issue.where.file = file;
  issue.message = message;
  issue.hint = hint;
  throw Error(std::move(issue));
}

constexpr const char* kWhatFor =
    "compare shows a rig's own skinning beside ours: give a rigged mesh (.glb, .fbx, …) or the "
    "character that 'fascia flesh' made of one";

void requireRig(const CharacterDef& def, const std::string& input) {
  if (!def.rig)
    refuse(input, "has a grid around its flesh for a skin, which moves in no other way", kWhatFor);
  if (!def.skin) refuse(input, "has no skin, and so nothing to compare with its rig", kWhatFor);
}

CharacterFile readSubject(const std::string& input, const Console& console) {
  if (endingOf(input) == ".json") {
    if (isSceneFile(input)) refuse(input, "is a scene, not a character", kWhatFor);
    return readCharacterFile(input);
  }
  CharacterFile file;
  const auto model = std::make_shared<const RiggedModel>(readRiggedModel(input));
  for (const std::string& note : model->notes) console.detail("note: " + note);
  ProgressBar progress(console, "fitting flesh");
  progress.update(0);  // how long it takes is not known
  file.def = fleshCharacter(model).def;
  return file;
}

Subject cachedSubject(const std::string& input) {
  if (isSceneCache(readCacheBytes(input)))
    refuse(input, "holds a scene, not a character", kWhatFor);
  Cache cache = readCache(input);
  requireRig(cache.def, input);
  return {Character(cache.def), std::move(cache.recording)};
}

Subject subjectOf(const std::string& input, SimulationOptions& options,
                  std::optional<double> only_s, const Console& console) {
  if (endingOf(input) == ".fcache") {
    if (!options.motion.empty()) throw Error("--motion: a cache holds one motion already");
    return cachedSubject(input);
  }
  CharacterFile file = readSubject(input, console);
  requireRig(file.def, input);
  Character character = prepareCharacter(std::move(file), options, console);
  const int motion = chooseMotion(character, options.motion);
  if (motion < 0)
    refuse(input, "has no motion, and both sides are the same at rest",
           "--motion walk.bvh puts a motion capture file onto it");
  RecordOptions record = options.recordOptions();
  const double rate_hz =
      record.frame_rate_hz > 0 ? record.frame_rate_hz : character.def().simulation.frame_rate_hz;
  const double length_s = character.motion(static_cast<std::size_t>(motion)).duration_s;
  if (only_s && *only_s > length_s + 0.5 / rate_hz)
    throw Error(fmt::format("--time {:g}: the motion '{}' ends at {:g} s", *only_s,
                            character.motion(static_cast<std::size_t>(motion)).name, length_s));
  if (only_s) keepOnly(*only_s, rate_hz, record);
  Recording recording = simulate(character, motion, record, console);
  return {std::move(character), std::move(recording)};
}

}  // namespace

Subject prepareSubject(const std::string& input, SimulationOptions& options,
                       std::optional<double> only_s, const Console& console) {
  std::optional<Subject> subject;
  withInput(input, {.command = "compare", .character = true, .recording = true, .model = true},
            [&] { subject = subjectOf(input, options, only_s, console); });
  return std::move(*subject);
}

}  // namespace fascia
