#include <fascia/io/motion/motion_file.h>

#include <algorithm>
#include <filesystem>

#include <fascia/base/error.h>
#include <fascia/base/suggest.h>
#include <fascia/io/file/file.h>
#include <fascia/io/motion/bvh.h>
#include <fascia/io/motion/joint_map_file.h>
#include <fascia/io/rig_import/gltf/figure_from_gltf.h>
#include <fascia/io/rig_import/rig_import.h>
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

bool isGltfMotion(std::string_view path) {
  return endsWithAnyCase(path, ".glb") || endsWithAnyCase(path, ".gltf") ||
         endsWithAnyCase(path, ".vrm") || endsWithAnyCase(path, ".vrma");
}
bool isRigMotion(std::string_view path) {
  return endsWithAnyCase(path, ".fbx") || endsWithAnyCase(path, ".dae");
}

// What a VRM says of its joints; empty if the rig's file is none.
std::vector<std::string> saidBy(const RiggedModel& rig) {
  if (!isGltfFile(rig.sourceFile)) return {};
  return saidOf(GltfDocument::read(rig.sourceFile), rig);
}

// The first motion of a rig's file.
void takeFigure(const RiggedModel& model, const std::string& path, MotionFile& file) {
  if (model.motions.empty()) {
    Issue issue;
    issue.where.file = path;
    issue.message = "has no motion in it";
    throw Error(std::move(issue));
  }
  file.figure = figureOf(model, 0);
  file.unit = "metre";
  if (model.motions.size() > 1)
    file.notes.push_back("of its " + std::to_string(model.motions.size()) + " motions the first, " +
                         quotedName(model.motions[0].name) + ", is taken");
  file.figure.motion.name = std::filesystem::path(path).stem().string();
}

void readFigure(const std::string& path, MotionFile& file) {
  if (isGltfMotion(path)) {
    const GltfDocument document = GltfDocument::read(path);
    const RiggedModel model = figureFromGltf(document);
    file.sourceSaid = saidOf(document, model);
    takeFigure(model, path, file);
    return;
  }
  if (isRigMotion(path)) {
    takeFigure(readRiggedModel(path), path, file);
    return;
  }
  const BvhMotion motion = readBvh(path);
  file.notes = motion.notes;
  file.figure = figureOf(motion, guessBvhUnit_m(motion, &file.unit));
}

}  // namespace

bool isMotionFile(std::string_view motion) {
  return endsWithAnyCase(motion, ".bvh") || endsWithAnyCase(motion, ".bvh.gz") ||
         isGltfMotion(motion) || isRigMotion(motion);
}

MotionFile readMotionFile(const std::string& path, const RiggedModel& rig,
                          const std::string& joint_map) {
  JointMap given;
  if (!joint_map.empty()) given = readJointMap(joint_map);
  MotionFile file;
  file.path = path;
  readFigure(path, file);
  file.said = saidBy(rig);
  file.map = inFile(joint_map, [&] {
    return guessJointMap(file.figure.joints, rig.joints, given, &file.notes,
                         {file.sourceSaid, file.said});
  });
  return file;
}

SampledMotion ontoRig(MotionFile& file, const RiggedModel& rig) {
  SampledMotion motion = inFile(file.path, [&] {
    return retarget(file.figure, rig, file.map, {.sourceSaid = file.sourceSaid, .said = file.said},
                    &file.notes);
  });
  motion.name = file.figure.motion.name;
  const auto taken = [&](const SampledMotion& m) { return m.name == motion.name; };
  while (std::any_of(rig.motions.begin(), rig.motions.end(), taken)) motion.name += " (mapped)";
  return motion;
}

}  // namespace fascia
