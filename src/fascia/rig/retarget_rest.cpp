#include <fascia/rig/retarget_rest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

// Rigs place the joints of trunk and hands differently: up to here a difference of directions is
// taken for that, not for another posture. Smaller: the trunk bends over; larger: a bowed figure
// stays bowed.
constexpr double kTrunkTolerance_rad = radians(40);
constexpr double kHandTolerance_rad = radians(30);
// An upright figure leans less than this; its axes are snapped to the world's.
constexpr double kSnapUp_rad = radians(30), kSnapHeading_rad = radians(20);
// Shins that lean more than this are splayed, and the soles with them.
constexpr double kSplayed_rad = radians(10);

std::optional<Vec3> placeOf(std::span<const Transform> world,
                            std::span<const JointMeaning> meanings, JointMeaning meaning) {
  for (std::size_t j = 0; j < world.size(); ++j) {
    if (meanings[j] == meaning) return world[j].translation_m;
  }
  return std::nullopt;
}

std::optional<Vec3> betweenSides(std::span<const Transform> world,
                                 std::span<const JointMeaning> meanings, BodyPart part) {
  const auto left = placeOf(world, meanings, {part, BodySide::left});
  const auto right = placeOf(world, meanings, {part, BodySide::right});
  if (!left || !right) return std::nullopt;
  return 0.5 * (*left + *right);
}

double angle(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

Vec3 nearestAxis(const Vec3& direction) {
  Eigen::Index axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  return Vec3::Unit(axis) * (direction[axis] < 0 ? -1 : 1);
}

// Where each driven joint's bone leads to: the one driven joint it holds; -1: a fork, or an end.
std::vector<int> bonesOf(std::span<const DrivenJoint> driven) {
  std::vector<int> next(driven.size(), -1);
  std::vector<int> held(driven.size(), 0);
  for (std::size_t d = 0; d < driven.size(); ++d) {
    // Joints of a run move as one bone: it leads to what the last of them holds.
    if (driven[d].above < 0 || driven[d].inRun > 0) continue;
    const auto above = static_cast<std::size_t>(driven[d].above);
    const std::size_t first = above - static_cast<std::size_t>(driven[above].inRun);
    ++held[first];
    next[first] = static_cast<int>(d);
  }
  for (std::size_t d = 0; d < driven.size(); ++d) {
    if (held[d] != 1) next[d] = -1;
  }
  return next;
}

double toleranceOf(BodyPart part) {
  if (part == BodyPart::pelvis) return kPi;  // no bone of its own in the body
  if (isTrunk(part) || part == BodyPart::clavicle) return kTrunkTolerance_rad;
  return part == BodyPart::hand ? kHandTolerance_rad : 0;
}

Vec3 perpendicular(const Vec3& v, const Vec3& normal) {
  return v - normal * normal.dot(v);
}

}  // namespace

Mat3 shortestArc(const Vec3& from, const Vec3& to) {
  FASCIA_ASSERT(from.allFinite() && to.allFinite(), "directions are finite");
  if (from.squaredNorm() == 0 || to.squaredNorm() == 0) return Mat3::Identity();
  return Quat::FromTwoVectors(from, to).normalized().toRotationMatrix();
}

Mat3 figureAxes(std::span<const Transform> world, std::span<const JointMeaning> meanings) {
  const auto hips = placeOf(world, meanings, {BodyPart::hips, BodySide::middle});
  const auto head = placeOf(world, meanings, {BodyPart::head, BodySide::middle});
  const auto feet = betweenSides(world, meanings, BodyPart::foot);
  Vec3 up = Vec3::Zero();
  if (hips && head) up += *head - *hips;
  if (hips && feet) up += *hips - *feet;
  for (const BodyPart part : {BodyPart::upperLeg, BodyPart::upperArm}) {
    const auto left = placeOf(world, meanings, {part, BodySide::left});
    const auto right = placeOf(world, meanings, {part, BodySide::right});
    if (!left || !right || up.norm() == 0) continue;
    if (angle(up, nearestAxis(up)) < kSnapUp_rad) up = nearestAxis(up);
    up.normalize();
    Vec3 toLeft = perpendicular(*left - *right, up);
    if (toLeft.norm() < 1e-6 * (*left - *right).norm() + 1e-12) continue;
    const Vec3 snapped = perpendicular(nearestAxis(toLeft), up);
    if (angle(toLeft, snapped) < kSnapHeading_rad) toLeft = snapped;
    toLeft.normalize();
    Mat3 axes;
    axes << toLeft, up, toLeft.cross(up);
    return axes;
  }
  return Mat3::Identity();
}

double stanceError_rad(std::span<const Transform> world, std::span<const JointMeaning> meanings) {
  const Vec3 up = figureAxes(world, meanings).col(1);
  double error = 0;
  double elevation[2] = {};
  for (const BodySide side : {BodySide::left, BodySide::right}) {
    const auto place = [&](BodyPart part) { return placeOf(world, meanings, {part, side}); };
    const auto hip = place(BodyPart::upperLeg), knee = place(BodyPart::lowerLeg);
    const auto ankle = place(BodyPart::foot), shoulder = place(BodyPart::upperArm);
    const auto elbow = place(BodyPart::lowerArm), wrist = place(BodyPart::hand);
    if (!hip || !knee || !ankle || !shoulder || !elbow || !wrist) {
      return std::numeric_limits<double>::infinity();
    }
    error = std::max({error, angle(*knee - *hip, -up), angle(*ankle - *knee, -up),
                      angle(*elbow - *shoulder, *wrist - *elbow)});
    elevation[side == BodySide::left ? 0 : 1] = angle(*wrist - *shoulder, up);
  }
  return std::max(error, std::abs(elevation[0] - elevation[1]));
}

namespace {

// Turns the target's rest pose onto the source's, joint by joint from the root on.
class Aligner {
 public:
  Aligner(std::span<const DrivenJoint> driven, std::span<const Transform> sourceRest,
          std::span<const Transform> targetRest, RestAlignment& out)
      : driven_(driven),
        next_(bonesOf(driven)),
        sourceRest_(sourceRest),
        targetRest_(targetRest),
        out_(out) {}

  void run() {
    out_.turn.assign(driven_.size(), Mat3::Identity());
    out_.axis.assign(driven_.size(), Vec3::Zero());
    for (std::size_t d = 0; d < driven_.size(); ++d) align(d);
  }

 private:
  void align(std::size_t d) {
    // Carried along with what holds it, so that no bone twists against its parent.
    const DrivenJoint& joint = driven_[d];
    const auto above = static_cast<std::size_t>(joint.above);
    if (joint.above >= 0) out_.turn[d] = out_.turn[above];
    if (joint.inRun > 0) {
      out_.axis[d] = out_.axis[above];
    } else if (joint.meaning.part == BodyPart::foot && joint.above >= 0) {
      alignSole(d, above);
    } else if (next_[d] >= 0 && joint.meaning.part != BodyPart::toe) {
      const auto next = static_cast<std::size_t>(next_[d]);
      const Vec3 from = out_.turn[d] * (target(next) - target(d));
      out_.axis[d] = source(next) - source(d);
      if (angle(from, out_.axis[d]) > toleranceOf(joint.meaning.part)) {
        out_.turn[d] = shortestArc(from, out_.axis[d]) * out_.turn[d];
      }
    }
  }

  // Both stand with flat soles, however high their ankles lie: only the heading may differ.
  void alignSole(std::size_t d, std::size_t shin) {
    const Vec3 down = -Vec3::UnitY();
    const bool splayed = angle(out_.axis[shin], down) > kSplayed_rad;
    const Mat3 sole = splayed ? shortestArc(down, out_.axis[shin]) : Mat3::Identity();
    out_.turn[d] = sole;
    if (next_[d] < 0) return;
    const auto next = static_cast<std::size_t>(next_[d]);
    const Vec3 up = sole.col(1);
    out_.axis[d] = source(next) - source(d);
    out_.turn[d] = shortestArc(perpendicular(sole * (target(next) - target(d)), up),
                               perpendicular(out_.axis[d], up)) *
                   sole;
  }

  Vec3 source(std::size_t d) const {
    return out_.toTarget * sourceRest_[static_cast<std::size_t>(driven_[d].source)].translation_m;
  }
  Vec3 target(std::size_t d) const {
    return targetRest_[static_cast<std::size_t>(driven_[d].target)].translation_m;
  }

  std::span<const DrivenJoint> driven_;
  std::vector<int> next_;
  std::span<const Transform> sourceRest_, targetRest_;
  RestAlignment& out_;
};

}  // namespace

RestAlignment alignRest(std::span<const DrivenJoint> driven, std::span<const Transform> sourceRest,
                        std::span<const JointMeaning> sourceMeanings,
                        std::span<const Transform> targetRest,
                        std::span<const JointMeaning> targetMeanings) {
  RestAlignment out;
  out.toTarget =
      figureAxes(targetRest, targetMeanings) * figureAxes(sourceRest, sourceMeanings).transpose();
  Aligner(driven, sourceRest, targetRest, out).run();
  return out;
}

}  // namespace fascia
