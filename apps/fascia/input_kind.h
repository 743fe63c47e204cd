#pragma once

#include <functional>
#include <string>

namespace fascia {

// What a file on the command line turns out to be, by its content where that tells, else by its
// ending.
enum class InputKind {
  character,
  scene,
  recording,   // .fcache
  model,       // a mesh, rigged or not: glTF, FBX, Collada, VRM, …
  motion,      // motion capture, .bvh
  pointCache,  // .pc2, .mdd
  picture,
  video,
  script,  // .lua
  folder,
  empty,
  unknown,  // also: there is none, or it may not be read
};

InputKind kindOfInput(const std::string& path);

// A command, and the kinds of files that it takes.
struct Wanted {
  std::string command;  // "bake"
  bool character = false, scene = false, recording = false, model = false;
};

// Runs `work`, which reads `path`. Where it fails and the file is of a kind that the command does
// not take, the error that is thrown says instead what the file is and what to do with it.
void withInput(const std::string& path, const Wanted& wanted, const std::function<void()>& work);

// Refuses the name of a motion that looks like a file which motions are not read from. Throws
// Error.
void refuseMotionFile(const std::string& motion);

}  // namespace fascia
