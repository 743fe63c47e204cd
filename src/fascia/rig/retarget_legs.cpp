#include <fascia/rig/retarget_legs.h>

#include <algorithm>
#include <cmath>

namespace fascia {
namespace {

// Of the leg's length. Nearer to straight, the knee would snap: its angle changes with the square
// root of what is left. What the motion itself stretches further stays.
constexpr double kReach = 0.995;
// Of the product of the bones' lengths: below this sine of the knee's angle its plane is noise, and
// the knee's own axis takes over.
constexpr double kStraightSine = 0.05;

double cornerAngle(double a, double b, double opposite) {
  return std::acos(std::clamp((a * a + b * b - opposite * opposite) / (2 * a * b), -1.0, 1.0));
}

Mat3 about(const Vec3& axis, double angle_rad) {
  return Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
}

}  // namespace

std::vector<DrivenLeg> legsOf(std::span<const DrivenJoint> driven) {
  std::vector<DrivenLeg> legs;
  for (const BodySide side : {BodySide::left, BodySide::right}) {
    DrivenLeg leg;
    for (std::size_t d = 0; d < driven.size(); ++d) {
      if (driven[d].meaning.side != side) continue;
      const int id = static_cast<int>(d);
      switch (driven[d].meaning.part) {
        case BodyPart::upperLeg:
          leg.upper.push_back(id);
          break;
        case BodyPart::lowerLeg:
          leg.lower.push_back(id);
          break;
        case BodyPart::foot:
          leg.foot = leg.foot < 0 ? id : leg.foot;
          break;
        case BodyPart::toe:
          leg.planted = leg.planted < 0 ? id : leg.planted;
          break;
        default:
          break;
      }
    }
    if (leg.upper.empty() || leg.lower.empty() || leg.foot < 0) continue;
    if (leg.planted < 0) leg.planted = leg.foot;
    legs.push_back(std::move(leg));
  }
  return legs;
}

LegTurns reach(const Vec3& hip, const Vec3& knee, const Vec3& ankle, const Vec3& kneeAxis,
               const Vec3& goal) {
  const double thigh = (knee - hip).norm(), shin = (ankle - knee).norm();
  const double before = (ankle - hip).norm();
  if (thigh == 0 || shin == 0 || before == 0 || (goal - hip).norm() == 0) return {};
  const double longest = std::max(before, kReach * (thigh + shin));
  const double shortest = std::min(before, 1.02 * std::abs(thigh - shin));
  const double after = std::clamp((goal - hip).norm(), shortest, longest);

  Vec3 hinge = (knee - hip).cross(ankle - knee) + kStraightSine * thigh * shin * kneeAxis;
  hinge -= (ankle - hip) * hinge.dot(ankle - hip) / (before * before);
  if (hinge.norm() == 0) return {};
  hinge.normalize();
  // Flexing about the hinge moves the shin back; the angles of hip and knee in the triangle differ.
  const double atHip = cornerAngle(thigh, before, shin) - cornerAngle(thigh, after, shin);
  const double atKnee = cornerAngle(thigh, shin, before) - cornerAngle(thigh, shin, after);
  LegTurns turns;
  turns.upper = about(hinge, atHip);
  turns.lower = about(hinge, atHip + atKnee);
  const Vec3 reached = turns.upper * (knee - hip) + turns.lower * (ankle - knee);
  const Mat3 swing = shortestArc(reached, goal - hip);
  turns.upper = swing * turns.upper;
  turns.lower = swing * turns.lower;
  return turns;
}

}  // namespace fascia
