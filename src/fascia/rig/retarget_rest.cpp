#include <fascia/rig/retarget_rest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

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

// Where a driven joint's bone leads to: the one driven joint it holds. None: a fork, or an end.
struct Bones {
  std::vector<int> next;  // per driven joint; -1
};

Bones bonesOf(std::span<const DrivenJoint> driven) {
  Bones bones;
  bones.next.assign(driven.size(), -1);
  std::vector<int> held(driven.size(), 0);
  for (std::size_t d = 0; d < driven.size(); ++d) {
    // Joints of a run move as one bone: it leads to what the last of them holds.
    if (driven[d].above < 0 || driven[d].inRun > 0) continue;
    const auto above = static_cast<std::size_t>(driven[d].above);
    const std::size_t first = above - static_cast<std::size_t>(driven[above].inRun);
    ++held[first];
    bones.next[first] = static_cast<int>(d);
  }
  for (std::size_t d = 0; d < driven.size(); ++d) {
    if (held[d] != 1) bones.next[d] = -1;
  }
  return bones;
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

RestAlignment alignRest(std::span<const DrivenJoint> driven, std::span<const Transform> sourceRest,
                        std::span<const JointMeaning> sourceMeanings,
                        std::span<const Transform> targetRest,
                        std::span<const JointMeaning> targetMeanings) {
  RestAlignment out;
  out.toTarget =
      figureAxes(targetRest, targetMeanings) * figureAxes(sourceRest, sourceMeanings).transpose();
  out.turn.assign(driven.size(), Mat3::Identity());
  out.axis.assign(driven.size(), Vec3::Zero());
  const Bones bones = bonesOf(driven);
  const auto source = [&](int d) {
    return Vec3(out.toTarget *
                sourceRest[static_cast<std::size_t>(driven[static_cast<std::size_t>(d)].source)]
                    .translation_m);
  };
  const auto target = [&](int d) {
    return targetRest[static_cast<std::size_t>(driven[static_cast<std::size_t>(d)].target)]
        .translation_m;
  };
  for (std::size_t d = 0; d < driven.size(); ++d) {
    const int self = static_cast<int>(d), next = bones.next[d];
    if (driven[d].above >= 0) out.turn[d] = out.turn[static_cast<std::size_t>(driven[d].above)];
    if (driven[d].inRun > 0) {
      out.axis[d] = out.axis[static_cast<std::size_t>(driven[d].above)];
      continue;
    }
    const BodyPart part = driven[d].meaning.part;
    if (part == BodyPart::foot || part == BodyPart::toe) {
      // Both stand with flat soles, however high the ankle lies: only the heading may differ.
      if (driven[d].above < 0 || part == BodyPart::toe) continue;
      const auto shin = static_cast<std::size_t>(driven[d].above);
      const Vec3 down = -Vec3::UnitY();
      const bool splayed = angle(out.axis[shin], down) > kSplayed_rad;
      const Mat3 sole = splayed ? shortestArc(down, out.axis[shin]) : Mat3::Identity();
      out.turn[d] = sole;
      if (next < 0) continue;
      const Vec3 up = sole.col(1);
      out.axis[d] = source(next) - source(self);
      const Vec3 from = perpendicular(sole * (target(next) - target(self)), up);
      const Vec3 to = perpendicular(out.axis[d], up);
      out.turn[d] = shortestArc(from, to) * sole;
      continue;
    }
    if (next < 0) continue;
    const Vec3 from = out.turn[d] * (target(next) - target(self));
    out.axis[d] = source(next) - source(self);
    if (angle(from, out.axis[d]) > toleranceOf(part)) {
      out.turn[d] = shortestArc(from, out.axis[d]) * out.turn[d];
    }
  }
  return out;
}

}  // namespace fascia
