#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include <fascia/rig/rigged_model.h>

namespace fascia {

// Motions of a file, of whatever kind its keys are, become frames at a constant rate.

// What a file says of a motion.
struct MotionSpan {
  std::string name;
  double duration_s = 0;
  double rate_hz = 0;  // that loses nothing
};

struct MotionPlan {
  double rate_hz = 0;
  std::size_t frames = 0;  // 0: the motion is left out
};

// Frames of all motions: the first and the last are a motion's first and last key. Where they are
// too many, fewer of all are kept, and noted. `nodes`: how many are evaluated per frame.
std::vector<MotionPlan> planMotions(std::span<const MotionSpan> motions, std::size_t nodes,
                                    std::vector<std::string>& notes);

// Appends a frame of all joints, given in the world; neighbouring rotations turn the short way.
void appendFrame(const RiggedModel& model, const std::vector<Transform>& world,
                 SampledMotion& motion);

// The last pose is the first again: a cycle. The doubled frame goes.
void closeLoop(double size_m, SampledMotion& motion);

// Of several motions of one name, the later ones get numbers: "walk (2)".
class MotionNames {
 public:
  std::string next(const std::string& name);

 private:
  std::map<std::string, int> counts_;
};

}  // namespace fascia
