#include <fascia/io/motion/motion_file.h>

#include <algorithm>

#include <fascia/base/error.h>
#include <fascia/io/file/file.h>
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

// Tells faults that name no file from the one that they are in.
template <class Work>
auto inFile(const std::string& path, const Work& work) {
  try {
    return work();
  } catch (const Error& error) {
    std::vector<Issue> issues = error.issues();
    for (Issue& issue : issues)
      if (issue.where.file.empty()) issue.where.file = path;
    throw Error(std::move(issues));
  }
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
  file.path = path;
  file.notes = motion.notes;
  file.figure = figureOf(motion, guessBvhUnit_m(motion, &file.unit));
  file.map = inFile(
      joint_map, [&] { return guessJointMap(file.figure.joints, rig.joints, given, &file.notes); });
  return file;
}

SampledMotion ontoRig(MotionFile& file, const RiggedModel& rig) {
  SampledMotion motion =
      inFile(file.path, [&] { return retarget(file.figure, rig, file.map, {}, &file.notes); });
  motion.name = file.figure.motion.name;
  const auto taken = [&](const SampledMotion& m) { return m.name == motion.name; };
  while (std::any_of(rig.motions.begin(), rig.motions.end(), taken)) motion.name += " (mapped)";
  return motion;
}

}  // namespace fascia
