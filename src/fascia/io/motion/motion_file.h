#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <fascia/rig/joint_map.h>
#include <fascia/rig/motion_figure.h>
#include <fascia/rig/rigged_model.h>

namespace fascia {

// Whether a text names a file instead of a motion, by its ending: motion capture (.bvh, .bvh.gz),
// or a rig's file, of which the first motion is taken (.glb, .gltf, .vrm, .vrma; .fbx and .dae with
// their meshes).
bool isMotionFile(std::string_view motion);

// A file that holds a motion, and how its joints drive a rig's.
struct MotionFile {
  std::string path;
  MotionFigure figure;  // metres
  std::string unit;     // what its lengths were taken for
  JointMap map;
  std::vector<std::string> notes;
  // What the motion's and the rig's files say of their joints (see guessMeanings).
  std::vector<std::string> sourceSaid, said;
};

// joint_map: a file of pairs that win over the guesses; empty = all guessed. Throws Error.
MotionFile readMotionFile(const std::string& path, const RiggedModel& rig,
                          const std::string& joint_map);

// The motion on the rig, under a name that the rig does not have yet. Adds to the notes.
SampledMotion ontoRig(MotionFile& file, const RiggedModel& rig);

}  // namespace fascia
