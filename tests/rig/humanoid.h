#pragma once

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <fascia/base/random.h>
#include <fascia/rig/motion_figure.h>

namespace fascia {

// A stick figure for tests, with the names that CMU's captures use.
struct Humanoid {
  double size = 1;          // of all lengths; 1: hips 1 m above the floor
  double shinShare = 0.5;   // of the leg
  double armsDown_rad = 0;  // 0: T-pose
  double legsApart_rad = 0;
  int spines = 2;
  int upperArms = 1;               // bones that share the upper arm
  Mat3 turned = Mat3::Identity();  // the whole figure
  bool oddFrames = false;          // joints' axes point anywhere

  std::vector<RigJoint> joints() const;
  RiggedModel model() const {
    RiggedModel m;
    m.joints = joints();
    return m;
  }
};

inline std::size_t jointNamed(const std::vector<RigJoint>& joints, const std::string& name) {
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (joints[j].name == name) return j;
  }
  throw std::out_of_range(name);
}

inline Mat3 turn(const Vec3& axis, double angle_rad) {
  return Eigen::AngleAxisd(angle_rad, axis.normalized()).toRotationMatrix();
}

namespace humanoid_detail {

class Builder {
 public:
  explicit Builder(const Humanoid& figure) : figure_(figure), random_(7) {}

  int add(const std::string& name, int parent, const Vec3& place) {
    Transform frame;
    if (figure_.oddFrames) {
      const Vec3 axis(random_.uniform(-1, 1), random_.uniform(-1, 1), 1);
      frame.rotation = turn(axis, random_.uniform(-3, 3));
    }
    frame.rotation = figure_.turned * frame.rotation;
    frame.translation_m = figure_.turned * (figure_.size * place);
    joints.push_back({name, parent, frame, -1});
    return static_cast<int>(joints.size()) - 1;
  }

  std::vector<RigJoint> joints;

 private:
  const Humanoid& figure_;
  Random random_;
};

}  // namespace humanoid_detail

inline std::vector<RigJoint> Humanoid::joints() const {
  humanoid_detail::Builder b(*this);
  const int hips = b.add("Hips", -1, {0, 1, 0});
  int chest = hips;
  for (int s = 0; s < spines; ++s) {
    chest = b.add("Spine" + std::to_string(s), chest, {0, 1.1 + 0.3 * (s + 1) / spines, 0});
  }
  const int neck = b.add("Neck", chest, {0, 1.5, 0});
  b.add("Head", neck, {0, 1.6, 0});
  for (const double side : {1.0, -1.0}) {
    const std::string name = side > 0 ? "Left" : "Right";
    const auto place = [&](Vec3 from, double length, const Vec3& along) -> Vec3 {
      return from + length * along.normalized();
    };
    const Vec3 arm(side * std::cos(armsDown_rad), -std::sin(armsDown_rad), 0);
    Vec3 at(side * 0.15, 1.45, 0);
    const int clavicle = b.add(name + "Shoulder", chest, {side * 0.03, 1.4, 0});
    int up = clavicle;
    for (int k = 0; k < upperArms; ++k) {
      const Vec3 here = place(at, 0.3 * k / upperArms, arm);
      up = b.add(k == 0 ? name + "Arm" : name + "Arm0" + std::to_string(k + 1), up, here);
    }
    at = place(at, 0.3, arm);
    const int fore = b.add(name + "ForeArm", up, at);
    at = place(at, 0.25, arm);
    const int hand = b.add(name + "Hand", fore, at);
    b.add(name + "HandIndex1", hand, place(at, 0.1, arm));

    const Vec3 leg(side * std::sin(legsApart_rad), -std::cos(legsApart_rad), 0);
    at = Vec3(side * 0.1, 0.95, 0);
    const int thigh = b.add(name + "UpLeg", hips, at);
    at = place(at, 0.85 * (1 - shinShare), leg);
    const int shin = b.add(name + "Leg", thigh, at);
    at = place(at, 0.85 * shinShare, leg);
    const int foot = b.add(name + "Foot", shin, at);
    b.add(name + "ToeBase", foot, at + Vec3(0, -0.07, 0.15));
  }
  return b.joints;
}

// Every joint swings in its own way about its rest pose; the hips travel.
inline MotionFigure dancing(const Humanoid& figure, double swing_rad, int frames = 20) {
  MotionFigure out;
  out.joints = figure.joints();
  out.motion.name = "dance";
  out.motion.rate_hz = 30;
  const std::size_t count = out.joints.size();
  for (const RigJoint& joint : out.joints) out.motion.joints.push_back(joint.name);
  for (int f = 0; f < frames; ++f) {
    for (std::size_t j = 0; j < count; ++j) {
      const RigJoint& joint = out.joints[j];
      const Transform rest =
          joint.parent < 0
              ? joint.rest_world
              : out.joints[static_cast<std::size_t>(joint.parent)].rest_world.inverse() *
                    joint.rest_world;
      // About an axis of the world, so that figures with other frames can be told the same.
      const double phase = 0.3 * f + static_cast<double>(j);
      const Vec3 axis = figure.turned * Vec3(std::sin(phase), std::cos(1.7 * phase), 0.5);
      const Mat3 inJoint = joint.rest_world.rotation.transpose() *
                           turn(axis, swing_rad * std::sin(phase)) * joint.rest_world.rotation;
      Vec3 place = rest.translation_m;
      if (joint.parent < 0) place += figure.turned * (figure.size * Vec3(0.01 * f, 0, 0.03 * f));
      out.motion.rotation.push_back(Quat(rest.rotation * inJoint).normalized().cast<float>());
      out.motion.translation_m.push_back(place.cast<float>());
    }
  }
  return out;
}

}  // namespace fascia
