#include <fascia/rig/hinge.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include <fascia/base/assert.h>
#include <fascia/rig/joint_meaning.h>

namespace fascia {
namespace {

// Of the model's size. Shorter segments are fingers and toes; joints nearer to the middle belong to
// spine and tail.
constexpr double kShortest = 0.05, kMidline = 0.015;
// Bent more than this, the bind pose tells which way a limb bends.
constexpr double kClearlyBent_rad = radians(15);
// Shorter sums of unit vectors point nowhere in particular.
constexpr double kLeastAxis = 0.01;

// The elbows and knees by their names: the first joint of each lower arm and leg, or of what is
// called lower on four legs.
std::vector<bool> namedHinges(const RiggedModel& model) {
  const std::vector<JointMeaning> meanings = guessMeanings(model.joints);
  const auto isLower = [&](std::size_t j) {
    const BodyPart part = meanings[j].part;
    if (part == BodyPart::lowerArm || part == BodyPart::lowerLeg) return true;
    const std::string& name = model.joints[j].name;
    return name.find("lower") != std::string::npos || name.find("Lower") != std::string::npos;
  };
  std::vector<bool> named(meanings.size(), false);
  for (std::size_t j = 1; j < named.size(); ++j)
    named[j] = isLower(j) && !isLower(static_cast<std::size_t>(model.joints[j].parent));
  return named;
}

// The tree as seen from above: who hangs from whom.
class Joints {
 public:
  explicit Joints(const RiggedModel& model)
      : model_(model), children_(model.joints.size()), below_(model.joints.size(), 0) {
    for (std::size_t j = model.joints.size(); j-- > 1;) {
      const auto parent = static_cast<std::size_t>(model.joints[j].parent);
      children_[parent].push_back(j);
      below_[parent] += below_[j] + 1;
    }
  }

  const Vec3& place(std::size_t j) const { return model_.joints[j].rest_world.translation_m; }
  bool isRoot(std::size_t j) const { return model_.joints[j].parent < 0; }
  std::size_t parent(std::size_t j) const {
    return static_cast<std::size_t>(model_.joints[j].parent);
  }
  bool isLeaf(std::size_t j) const { return children_[j].empty(); }
  // Where a joint's segment leads: to the child with most below it, the farthest among equals.
  std::size_t next(std::size_t j) const {
    return *std::max_element(children_[j].begin(), children_[j].end(),
                             [&](std::size_t a, std::size_t b) {
                               if (below_[a] != below_[b]) return below_[a] < below_[b];
                               return (place(a) - place(j)).norm() < (place(b) - place(j)).norm();
                             });
  }
  bool isBelow(std::size_t j, std::size_t ancestor) const {
    for (;; j = parent(j)) {
      if (j == ancestor) return true;
      if (isRoot(j)) return false;
    }
  }

 private:
  const RiggedModel& model_;
  std::vector<std::vector<std::size_t>> children_;
  std::vector<std::size_t> below_;  // how many joints
};

Transform restInParent(const RiggedModel& model, std::size_t joint) {
  FASCIA_ASSERT(joint < model.joints.size(), "the joint exists");
  const RigJoint& j = model.joints[joint];
  if (j.parent < 0) return j.rest_world;
  return model.joints[static_cast<std::size_t>(j.parent)].rest_world.inverse() * j.rest_world;
}

// The axis about which the model's own motions turn a joint, world, as far as it is perpendicular
// to `along`; zero without motions. Elbows and knees bend one way only, so that the sum has a
// sense.
Vec3 turnInMotions(const RiggedModel& model, std::size_t joint, const Vec3& along) {
  constexpr std::size_t kFrames = 64;  // that are looked at in each motion
  const RigJoint& rig = model.joints[joint];
  const Mat3 rest = restInParent(model, joint).rotation;
  Vec3 sum = Vec3::Zero();
  for (const SampledMotion& motion : model.motions) {
    if (motion.joints.size() != model.joints.size()) continue;
    const std::size_t count = std::min(kFrames, motion.frameCount());
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t frame = i * motion.frameCount() / count;
      const Mat3 now = motion.rotation[frame * motion.joints.size() + joint]
                           .cast<double>()
                           .normalized()
                           .toRotationMatrix();
      const Eigen::AngleAxisd turn(Mat3(rest.transpose() * now));
      sum += turn.angle() * (rig.rest_world.rotation * turn.axis());
    }
  }
  return sum - sum.dot(along) * along;
}

// Which way a limb bends: further, if it is clearly bent at rest; else as its motions do; else
// further, if it is bent at all, or forwards.
Vec3 bendAxis(const RiggedModel& model, const Hinge& hinge) {
  const Vec3 lower = hinge.lower_m.normalized();
  const Vec3 further = hinge.upper_m.normalized().cross(lower);
  if (hinge.flexion_rad() > kClearlyBent_rad) return further.normalized();
  const Vec3 turned = turnInMotions(model, hinge.joint, lower);
  for (const Vec3& axis : {turned, further, Vec3(lower.cross(Vec3::UnitZ()))})
    if (axis.norm() > kLeastAxis) return axis.normalized();
  return lower.unitOrthogonal();
}

// A hinge at this joint, if it has the shape of one.
std::optional<Hinge> hingeAt(const RiggedModel& model, const Joints& joints, std::size_t joint) {
  if (joints.isRoot(joint) || joints.isLeaf(joint)) return std::nullopt;
  Hinge hinge;
  hinge.joint = joint;
  hinge.center_m = joints.place(joint);
  hinge.lower_m = joints.place(joints.next(joint)) - hinge.center_m;
  // Some rigs divide a limb into short joints for twisting: their sum is the segment.
  hinge.upper = joints.parent(joint);
  const auto upper_m = [&] { return Vec3(hinge.center_m - joints.place(hinge.upper)); };
  while (!joints.isRoot(hinge.upper) && upper_m().norm() < 0.5 * hinge.lower_m.norm())
    hinge.upper = joints.parent(hinge.upper);
  hinge.upper_m = upper_m();
  const double size_m = model.size_m();
  const double nearest_m = std::min(hinge.center_m.x(), joints.place(hinge.upper).x());
  if (nearest_m < kMidline * size_m || joints.isRoot(hinge.upper)) return std::nullopt;
  if (hinge.shorter_m() < kShortest * size_m) return std::nullopt;
  hinge.axis = bendAxis(model, hinge);
  return hinge;
}

}  // namespace

double Hinge::flexion_rad() const {
  const double cosine = upper_m.normalized().dot(lower_m.normalized());
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

double Hinge::turnFor_rad(double flexion) const {
  // With u, l the unit segments and a the axis, the turned segment is cos θ l + sin θ a × l:
  // cos flexion = cos θ u·l + sin θ u·(a × l) = r cos(θ − φ).
  const Vec3 u = upper_m.normalized(), l = lower_m.normalized();
  const double along = u.dot(l), across = u.dot(axis.cross(l));
  const double r = std::hypot(along, across);
  if (!(r > 0)) return 0;
  return std::atan2(across, along) + std::acos(std::clamp(std::cos(flexion) / r, -1.0, 1.0));
}

std::vector<Hinge> findHinges(const RiggedModel& model, std::size_t most) {
  const Joints joints(model);
  const std::vector<bool> named = namedHinges(model);
  std::vector<Hinge> candidates;
  for (std::size_t j = 0; j < model.joints.size(); ++j)
    if (const std::optional<Hinge> hinge = hingeAt(model, joints, j)) candidates.push_back(*hinge);
  std::stable_sort(candidates.begin(), candidates.end(), [&](const Hinge& a, const Hinge& b) {
    if (named[a.joint] != named[b.joint]) return static_cast<bool>(named[a.joint]);
    return a.shorter_m() > b.shorter_m();
  });
  std::vector<Hinge> hinges;
  for (const Hinge& hinge : candidates) {
    const auto sameLimb = [&](const Hinge& h) {
      return joints.isBelow(hinge.joint, h.upper) || joints.isBelow(h.joint, hinge.upper);
    };
    if (hinges.size() < most && std::none_of(hinges.begin(), hinges.end(), sameLimb))
      hinges.push_back(hinge);
  }
  return hinges;
}

SampledMotion turnMotion(const RiggedModel& model, std::size_t joint, const Vec3& axis_world,
                         double turn_rad) {
  constexpr int kRate_hz = 60;
  SampledMotion motion;
  motion.rate_hz = kRate_hz;
  motion.name = "turn " + model.joints[joint].name;
  for (const RigJoint& each : model.joints) motion.joints.push_back(each.name);
  std::vector<Transform> rest;
  for (std::size_t j = 0; j < model.joints.size(); ++j) rest.push_back(restInParent(model, j));
  const Vec3 axis = model.joints[joint].rest_world.rotation.transpose() * axis_world;
  for (int frame = 0; frame <= 2 * kRate_hz; ++frame) {
    const double t = std::min(1.0, static_cast<double>(frame) / kRate_hz);
    const double eased = t * t * t * (t * (6 * t - 15) + 10);  // starts and stops softly
    const Eigen::AngleAxisd turn(eased * turn_rad, axis);
    for (std::size_t j = 0; j < rest.size(); ++j) {
      Quat rotation(j == joint ? Mat3(rest[j].rotation * turn) : rest[j].rotation);
      rotation.normalize();
      // Turns of more than 90° may come out in the other hemisphere.
      if (frame > 0 &&
          rotation.coeffs().dot(
              motion.rotation[motion.rotation.size() - rest.size()].coeffs().cast<double>()) < 0)
        rotation.coeffs() *= -1;
      motion.rotation.push_back(rotation.cast<float>());
      motion.translation_m.push_back(rest[j].translation_m.cast<float>());
    }
  }
  return motion;
}

SampledMotion bendMotion(const RiggedModel& model, const Hinge& hinge, double flexion_rad) {
  SampledMotion motion = turnMotion(model, hinge.joint, hinge.axis, hinge.turnFor_rad(flexion_rad));
  motion.name = "bend " + model.joints[hinge.joint].name;
  return motion;
}

HingeRegion regionOf(const RiggedModel& model, const Hinge& hinge) {
  const Joints joints(model);
  std::vector<bool> moved(model.joints.size());
  for (std::size_t j = 0; j < moved.size(); ++j) moved[j] = joints.isBelow(j, hinge.upper);
  const Vec3 up = -hinge.upper_m.normalized(), down = hinge.lower_m.normalized();
  const double reach_m = 0.5 * hinge.shorter_m();
  std::vector<bool> limb(model.points_m.size()), near(model.points_m.size());
  HingeRegion region;
  for (std::uint32_t p = 0; p < limb.size(); ++p) {
    const Vec3 from = model.points_m[p].cast<double>() - hinge.center_m;
    limb[p] = moved[model.weights[p].joint[0]];
    near[p] = limb[p] && from.dot(up) <= reach_m && from.dot(down) <= reach_m;
    if (near[p]) region.pointsNearJoint.push_back(p);
  }
  for (const auto& t : model.triangles) {
    if (!limb[t[0]] || !limb[t[1]] || !limb[t[2]]) continue;
    region.limb.push_back(t);
    if (near[t[0]] || near[t[1]] || near[t[2]]) region.nearJoint.push_back(t);
  }
  return region;
}

}  // namespace fascia
