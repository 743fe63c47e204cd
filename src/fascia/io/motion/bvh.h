#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fascia/rig/motion_figure.h>

namespace fascia {

enum class BvhChannel { xPosition, yPosition, zPosition, xRotation, yRotation, zRotation };
inline constexpr bool isRotation(BvhChannel channel) {
  return channel >= BvhChannel::xRotation;
}

struct BvhJoint {
  std::string name;                  // unique
  int parent = -1;                   // smaller than this joint's own index; joint 0 is the root
  Vec3 offset = Vec3::Zero();        // from the parent, in the file's unit
  std::vector<BvhChannel> channels;  // in the file's order; any subset, each at most once
  std::size_t firstChannel = 0;      // of the frame's values
  std::optional<Vec3> endSite;       // the tip of the last joint of a limb
};

// A BVH file as it is written: lengths in the file's unit, angles in degrees.
struct BvhMotion {
  std::string name;  // the file's, without its ending
  std::vector<BvhJoint> joints;
  double frameTime_s = 1.0 / 30;
  std::size_t channelCount = 0;
  std::vector<float> values;       // frame * channelCount + channel; at least one frame
  std::vector<std::string> notes;  // what was mended

  std::size_t frameCount() const { return channelCount == 0 ? 0 : values.size() / channelCount; }
};

// Throws Error with the line, what was found and what was expected.
BvhMotion parseBvh(std::string_view text, const std::string& file);
BvhMotion readBvh(const std::string& path);  // .bvh, or packed as .bvh.gz

// BVH does not say what its lengths are. The unit, in metres, that makes the figure nearest to a
// person's height: m, dm, cm, mm, inch, or CMU's (an inch divided by 0.45). `what` gets its name.
double guessBvhUnit_m(const BvhMotion& motion, std::string* what = nullptr);

// The same in metres, with rotations. Rest pose: all channels zero, which is what offsets describe.
MotionFigure figureOf(const BvhMotion& motion, double unit_m);

}  // namespace fascia
