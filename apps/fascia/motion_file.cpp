#include "motion_file.h"

#include <algorithm>

#include <fmt/format.h>

#include <fascia/io/motion/bvh.h>
#include <fascia/io/motion/joint_map_file.h>
#include <fascia/rig/retarget.h>

namespace fascia {
namespace {

bool endsWithAnyCase(std::string_view text, std::string_view ending) {
  if (text.size() < ending.size()) return false;
  return std::equal(
      ending.begin(), ending.end(), text.end() - static_cast<long>(ending.size()),
      [](char wanted, char found) { return wanted == (found | 0x20) || wanted == found; });
}

}  // namespace

bool isMotionFile(std::string_view motion) {
  return endsWithAnyCase(motion, ".bvh") || endsWithAnyCase(motion, ".bvh.gz");
}

MotionFile readMotionFile(const std::string& path, const RiggedModel& rig,
                          const std::string& joint_map) {
  JointMap given;
  if (!joint_map.empty()) given = readJointMap(joint_map);
  const BvhMotion motion = readBvh(path);
  MotionFile file;
  file.notes = motion.notes;
  file.figure = figureOf(motion, guessBvhUnit_m(motion, &file.unit));
  file.map = guessJointMap(file.figure.joints, rig.joints, given, &file.notes);
  return file;
}

SampledMotion ontoRig(MotionFile& file, const RiggedModel& rig) {
  SampledMotion motion = retarget(file.figure, rig, file.map, {}, &file.notes);
  motion.name = file.figure.motion.name;
  const auto taken = [&](const SampledMotion& m) { return m.name == motion.name; };
  while (std::any_of(rig.motions.begin(), rig.motions.end(), taken)) motion.name += " (mapped)";
  return motion;
}

void reportMap(const MotionFile& file, const RiggedModel& rig, const Console& console) {
  const auto driven = std::count_if(file.map.begin(), file.map.end(), [](const JointPair& pair) {
    return !pair.source.empty() && !pair.target.empty();
  });
  console.say(fmt::format("{}: {} joints in {}; drives {} of the rig's {}", file.figure.motion.name,
                          file.figure.joints.size(), file.unit, driven, rig.joints.size()));
  console.detail(printJointMap(file.map));
  for (const std::string& note : file.notes) console.detail(note);
}

}  // namespace fascia
