#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <fascia/math/types.h>

namespace fascia {

// A motion as frames at a constant rate, the way files and motion capture bring it: for every joint
// its frame in its parent joint's frame; and weights of morphs. Knows names only.
struct SampledMotion {
  std::string name;
  double rate_hz = 60;
  bool loop = false;                // the last frame is followed by the first
  std::vector<std::string> joints;  // any subset of a figure's joints
  // frame * joints.size() + joint; at least one frame, all of one length
  std::vector<Eigen::Quaternionf> rotation;  // unit, neighbours in time in one hemisphere
  std::vector<Eigen::Vector3f> translation_m;
  std::vector<std::string> morphs{};  // any subset of a figure's morphs
  std::vector<float> weights{};       // frame * morphs.size() + morph

  std::size_t frameCount() const { return joints.empty() ? 0 : rotation.size() / joints.size(); }
  double duration_s() const {
    const auto frames = static_cast<double>(frameCount());
    return (loop ? frames : frames - 1) / rate_hz;
  }
};

// A joint's frame in its parent's at a time of a motion; clamped, or wrapped if the motion loops.
// Between frames it moves along a cubic that passes through them with a steady velocity (straight
// pieces would kick soft skin at every frame) and that does not swing over where it jumps or stops.
// `joint` counts within the motion.
Transform sampleJoint(const SampledMotion& motion, std::size_t joint, double time_s);
// The same of a morph's weight.
double sampleWeight(const SampledMotion& motion, std::size_t morph, double time_s);

}  // namespace fascia
