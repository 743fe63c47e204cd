#include <fascia/io/motion/bvh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include <fascia/io/file/gzip.h>

namespace fascia {
namespace {

constexpr std::size_t kMaxBvhBytes = std::size_t{512} << 20;

struct Unit {
  const char* name;
  double metres;
};
// CMU's converted files: inches divided by 0.45 (cgspeed, "The Motionbuilder-friendly BVH
// release").
constexpr std::array<Unit, 6> kUnits = {{{"metres", 1},
                                         {"decimetres", 0.1},
                                         {"centimetres", 0.01},
                                         {"millimetres", 0.001},
                                         {"inches", 0.0254},
                                         {"CMU's inch/0.45", 0.0254 / 0.45}}};

Vec3 axisOf(BvhChannel channel) {
  return Vec3::Unit(static_cast<int>(channel) % 3);
}

std::vector<Vec3> restPositions(const BvhMotion& motion) {
  std::vector<Vec3> position;
  for (const BvhJoint& joint : motion.joints) {
    const Vec3 from =
        joint.parent < 0 ? Vec3::Zero() : position[static_cast<std::size_t>(joint.parent)];
    position.push_back(from + joint.offset);
  }
  return position;
}

bool hasPosition(const BvhJoint& joint) {
  return std::any_of(joint.channels.begin(), joint.channels.end(),
                     [](BvhChannel c) { return !isRotation(c); });
}

// A joint's frame in its parent's, in the file's unit: channels turn in the order they are listed.
Transform localFrame(const BvhJoint& joint, const float* values, bool positionIsAdded) {
  Quat rotation = Quat::Identity();
  Vec3 translation = joint.offset;
  if (!positionIsAdded) {
    for (const BvhChannel c : joint.channels) {
      if (!isRotation(c)) translation -= axisOf(c).cwiseProduct(joint.offset);
    }
  }
  for (std::size_t k = 0; k < joint.channels.size(); ++k) {
    const Vec3 axis = axisOf(joint.channels[k]);
    const double value = values[joint.firstChannel + k];
    if (isRotation(joint.channels[k])) {
      rotation = rotation * Eigen::AngleAxisd(radians(value), axis);
    } else {
      translation += value * axis;
    }
  }
  return {rotation.normalized().toRotationMatrix(), translation};
}

// Programs disagree whether a position channel replaces the offset or is added to it. The root's is
// its place; any other joint stays near its offset, so the first frame tells.
bool positionIsAdded(const BvhJoint& joint, const float* firstFrame) {
  if (joint.parent < 0 || !hasPosition(joint)) return false;
  const Vec3 added = localFrame(joint, firstFrame, true).translation_m;
  const Vec3 replaced = localFrame(joint, firstFrame, false).translation_m;
  return (added - joint.offset).squaredNorm() < (replaced - joint.offset).squaredNorm();
}

}  // namespace

BvhMotion readBvh(const std::string& path) {
  BvhMotion motion = parseBvh(readFileUnpacked(path, kMaxBvhBytes), path);
  std::filesystem::path name = std::filesystem::path(path).filename();
  if (name.extension() == ".gz") name = name.stem();
  motion.name = name.stem().string();
  return motion;
}

double guessBvhUnit_m(const BvhMotion& motion, std::string* what) {
  constexpr double kPerson_m = 1.7;
  const std::vector<Vec3> rest = restPositions(motion);
  Box box;
  for (std::size_t j = 0; j < rest.size(); ++j) {
    box.add(rest[j]);
    if (motion.joints[j].endSite) box.add(rest[j] + *motion.joints[j].endSite);
  }
  // The up-axis is not known yet: legs and trunk are about as long as the arms' span, so that the
  // longest side serves for either.
  const double extent = box.empty() ? 0 : box.size().maxCoeff();
  const Unit* best = &kUnits[0];
  double bestFactor = std::numeric_limits<double>::infinity();
  for (const Unit& unit : kUnits) {
    const double factor = std::abs(std::log(std::max(extent, 1e-9) * unit.metres / kPerson_m));
    if (factor < bestFactor) bestFactor = factor, best = &unit;
  }
  if (what) *what = best->name;
  return best->metres;
}

MotionFigure figureOf(const BvhMotion& motion, double unit_m) {
  MotionFigure figure;
  const std::vector<Vec3> rest = restPositions(motion);
  std::vector<bool> added;
  for (std::size_t j = 0; j < motion.joints.size(); ++j) {
    const BvhJoint& joint = motion.joints[j];
    figure.joints.push_back({joint.name, joint.parent, {Mat3::Identity(), unit_m * rest[j]}, -1});
    figure.motion.joints.push_back(joint.name);
    added.push_back(positionIsAdded(joint, motion.values.data()));
  }
  figure.motion.name = motion.name;
  figure.motion.rate_hz = 1 / motion.frameTime_s;
  const std::size_t count = motion.joints.size(), total = motion.frameCount() * count;
  figure.motion.rotation.resize(total);
  figure.motion.translation_m.resize(total);
  for (std::size_t i = 0; i < total; ++i) {
    const float* values = motion.values.data() + i / count * motion.channelCount;
    const Transform local = localFrame(motion.joints[i % count], values, added[i % count]);
    Quat turn(local.rotation);
    if (i >= count && turn.dot(figure.motion.rotation[i - count].cast<double>()) < 0) {
      turn.coeffs() *= -1;
    }
    figure.motion.rotation[i] = turn.cast<float>();
    figure.motion.translation_m[i] = (unit_m * local.translation_m).cast<float>();
  }
  return figure;
}

}  // namespace fascia
