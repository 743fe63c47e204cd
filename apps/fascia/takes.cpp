#include "takes.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <set>

#include <fmt/format.h>

#include <fascia/baking/close_cycle.h>
#include <fascia/flesh/bind.h>
#include <fascia/io/documents/character_file.h>
#include <fascia/render/rig_joints.h>
#include <fascia/rig/blend_skinning.h>

#include "report_map.h"

namespace fascia {
namespace {

// Motion capture files are put onto the rig; then all are names.
std::vector<std::string> namesOf(const TakeOptions& takes, const SimulationOptions& options,
                                 CharacterDef& def, const Console& console) {
  std::vector<std::string> names;
  bool anyFile = false;
  for (const std::string& motion : takes.motions) {
    if (!isMotionFile(motion)) {
      names.push_back(motion);
      continue;
    }
    anyFile = true;
    if (!def.rig) throw Error("the motion '" + motion + "' needs a character with a rig");
    RiggedModel model = *def.rig->model;
    MotionFile file = readMotionFile(motion, model, options.joint_map);
    model.motions.push_back(ontoRig(file, model));
    reportMap(file, model, console);
    names.push_back(model.motions.back().name);
    def.rig->model = std::make_shared<const RiggedModel>(std::move(model));
  }
  if (!options.joint_map.empty() && !anyFile)
    throw Error("--joint-map belongs to a motion from a file, such as --motion walk.bvh");
  return names;
}

// A motion of the rig that the character has no own one for, by its name.
int rigMotion(const CharacterDef& def, const std::string& name) {
  if (!def.rig) return -1;
  for (const MotionDef& own : def.motions)
    if (own.name == name) return -1;
  const std::vector<SampledMotion>& motions = def.rig->model->motions;
  const auto found = std::find_if(motions.begin(), motions.end(),
                                  [&](const SampledMotion& m) { return m.name == name; });
  return found == motions.end() ? -1 : static_cast<int>(found - motions.begin());
}

// Cycles that do not repeat by themselves, as they travel or nearly close only, played twice: the
// character must know these motions when it is built.
class Doubles {
 public:
  explicit Doubles(const CharacterDef& def) {
    if (def.rig) model_ = *def.rig->model;
  }
  // The name of the motion to play for two cycles.
  std::string nameOf(int motion, const MotionCycle& cycle) {
    const SampledMotion& once = model_.motions[static_cast<std::size_t>(motion)];
    if (once.loop) return once.name;
    SampledMotion twice = playedTwice(model_, motion, cycle);
    const auto taken = [&](const SampledMotion& m) { return m.name == twice.name; };
    while (std::any_of(model_.motions.begin(), model_.motions.end(), taken)) twice.name += " twice";
    model_.motions.push_back(std::move(twice));
    return model_.motions.back().name;
  }
  void putInto(CharacterDef& def) {
    if (def.rig) def.rig->model = std::make_shared<const RiggedModel>(std::move(model_));
  }

 private:
  RiggedModel model_;
};

std::vector<std::string> allMotions(const CharacterDef& def) {
  std::vector<std::string> names;
  for (const MotionDef& own : def.motions) names.push_back(own.name);
  if (!def.rig) return names;
  for (const SampledMotion& m : def.rig->model->motions)
    if (std::find(names.begin(), names.end(), m.name) == names.end()) names.push_back(m.name);
  return names;
}

void checkNames(const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), names[i]) !=
        names.begin() + static_cast<std::ptrdiff_t>(i))
      throw Error("the motion '" + names[i] + "' is named twice");
}

void checkLoop(const TakeOptions& takes, const SimulationOptions& options,
               const CharacterDef& def) {
  if (takes.loop != "on") return;
  if (!def.rig) throw Error("--loop on needs a character with a rig; this one has none");
  if (options.duration_s > 0) throw Error("--loop on needs the whole motion: leave --duration out");
}

std::optional<MotionCycle> cycleFor(const CharacterDef& def, const std::string& name,
                                    const TakeOptions& takes, const SimulationOptions& options) {
  const int motion = rigMotion(def, name);
  std::optional<MotionCycle> cycle;
  if (takes.loop != "off" && options.duration_s <= 0 && motion >= 0)
    cycle = cycleOf(*def.rig->model, motion);
  if (takes.loop == "on" && !cycle) {
    Issue issue;
    issue.message = "the motion '" + name + "' does not end as it begins: it cannot loop";
    issue.hint = "--loop auto closes the motions that do";
    throw Error(std::move(issue));
  }
  return cycle;
}

std::vector<std::vector<Transform>> jointFrames(const Character& character,
                                                const Recording& recording) {
  if (!character.def().rig) return {};
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

// Near to the wanted rate, but the beginning and the end of the cycle, and of the motion, fall on
// frames: or the last would not be the first.
double rateFor(const Cast& cast, const Take& take, double wanted_hz) {
  const double period_s = take.cycle->period_s;
  const double duration_s = cast.character.motion(static_cast<std::size_t>(take.index)).duration_s;
  const double missing_s = period_s - duration_s;  // a frame of the motion, or nothing
  if (missing_s > 1e-6) return std::max(1.0, std::round(wanted_hz * missing_s)) / missing_s;
  return std::max(1.0, std::round(period_s * wanted_hz)) / period_s;
}

// The second time of a motion, as if it were the first, with ends that meet.
void closeEnds(const Cast& cast, const Take& take, Shot& shot) {
  const Character& character = cast.character;
  const RiggedModel& model = *cast.def.rig->model;
  const BoundClip& clip = character.motion(static_cast<std::size_t>(take.index));
  Recording& recording = shot.recording;
  recording.motion = take.motion;
  Posture posture = character.skeleton().restPosture();
  PointFrames frames;
  for (std::size_t f = 0; f < recording.frames.size(); ++f) {
    Recording::Frame& frame = recording.frames[f];
    frame.time_s = static_cast<double>(f) / recording.frame_rate_hz;
    samplePosture(clip, character.skeleton(), frame.time_s, posture);
    frame.posture = posture.values;
    for (Eigen::Vector3f& p : frame.skin_m) p -= take.cycle->travel_m.cast<float>();
    frames.push_back(std::move(frame.skin_m));
  }
  shot.joints_world = jointFrames(character, recording);
  BoneFrames bones(frames.size());
  for (std::size_t f = 0; f < bones.size(); ++f) restToFrame(model, shot.joints_world[f], bones[f]);
  const std::vector<std::uint32_t> dominant = dominantJoints(model);
  std::vector<std::uint32_t> carrier;
  for (const RigVertex& v : model.vertices) carrier.push_back(dominant[v.point]);
  shot.gap_m = closeCycle(frames, bones, carrier, take.cycle->travel_m);
  for (std::size_t f = 0; f < frames.size(); ++f) recording.frames[f].skin_m = std::move(frames[f]);
  recording.skin.positions = recording.frames.front().skin_m;
}

}  // namespace

void TakeOptions::addTo(CLI::App& command) {
  CLI::Option* one =
      command
          .add_option(
              "--motion", motions,
              "A motion (default: the first), may be given several times; a .bvh or .glb file is "
              "put onto the rig")
          ->type_name("NAME")
          ->allow_extra_args(false);
  command.add_option("--motions", all, "'all': every motion of the character")
      ->type_name("all")
      ->check(CLI::IsMember({"all"}).description(""))
      ->excludes(one);
  command
      .add_option("--loop", loop,
                  "Whether motions on a rig that end as they begin are made to repeat without a "
                  "step: auto, on or off (default: auto)")
      ->type_name("WHEN")
      ->check(CLI::IsMember({"auto", "on", "off"}).description(""));
}

Cast prepareCast(const std::string& path, const TakeOptions& takes, SimulationOptions& options,
                 const Console& console) {
  if (options.seed != 0) throw Error("--seed is for scenes; a character has nothing to scatter");
  CharacterFile file = readCharacterFile(path);
  std::vector<std::string> names = namesOf(takes, options, file.def, console);
  if (takes.all == "all") names = allMotions(file.def);
  checkNames(names);
  checkLoop(takes, options, file.def);
  if (names.empty()) {
    const std::vector<std::string> known = allMotions(file.def);
    names.push_back(known.empty() ? std::string() : known.front());
  }
  const CharacterDef def = file.def;
  Doubles doubles(def);
  std::vector<Take> list;
  std::vector<std::string> played;
  for (const std::string& name : names) {
    list.push_back({name, -1, -1, cycleFor(def, name, takes, options)});
    played.push_back(list.back().cycle ? doubles.nameOf(rigMotion(def, name), *list.back().cycle)
                                       : name);
  }
  doubles.putInto(file.def);
  Cast cast{def, buildCharacter(file, options.buildOptions()), std::move(list)};
  console.warn(cast.character.warnings());
  for (std::size_t k = 0; k < cast.takes.size(); ++k) {
    cast.takes[k].index = chooseMotion(cast.character, names[k]);
    cast.takes[k].played = chooseMotion(cast.character, played[k]);
  }
  return cast;
}

Shot shoot(const Cast& cast, const Take& take, const SimulationOptions& options,
           const Console& console, const CharacterState* from) {
  Shot shot;
  RecordOptions record;
  record.frame_rate_hz = options.frame_rate_hz;
  record.duration_s = options.duration_s;
  record.from = from;
  record.last = &shot.last;
  const std::string what = cast.takes.size() > 1 ? "simulating " + take.motion : "simulating";
  if (!take.cycle) {
    shot.recording = simulate(cast.character, take.played, record, console, what);
    shot.joints_world = jointFrames(cast.character, shot.recording);
    return shot;
  }
  const double rate_hz =
      record.frame_rate_hz > 0 ? record.frame_rate_hz : cast.def.simulation.frame_rate_hz;
  record.frame_rate_hz = rateFor(cast, take, rate_hz);
  record.duration_s = 2 * take.cycle->period_s;
  record.start_s = take.cycle->period_s;
  shot.recording = simulate(cast.character, take.played, record, console, what);
  closeEnds(cast, take, shot);
  return shot;
}

std::string fileOf(const std::string& path, const std::vector<Take>& takes, std::size_t take) {
  if (takes.size() < 2) return path;
  std::set<std::string> taken;
  std::string fresh;
  for (std::size_t k = 0; k <= take; ++k) {
    std::string clean;
    for (const char c : takes[k].motion) {
      const auto u = static_cast<unsigned char>(c);
      clean += std::isalnum(u) || c == '-' || c == '_' ? c : '_';
    }
    fresh = clean;
    for (int n = 2; !taken.insert(fresh).second; ++n) fresh = clean + "_" + std::to_string(n);
  }
  const std::filesystem::path whole(path);
  std::filesystem::path out = whole;
  out.replace_extension();
  return out.string() + "." + fresh + whole.extension().string();
}

}  // namespace fascia
