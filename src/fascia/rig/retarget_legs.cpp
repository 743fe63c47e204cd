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

// The least turn δ of a bone `b` about an axis that brings the end of the chain a + R(δ) b to a
// distance, or as near to it as it goes: |a + R(δ) b|² = d² is A cos δ + B sin δ = C.
double turnToDistance(const Vec3& a, const Vec3& b, const Vec3& axis, double distance) {
  const Vec3 along = axis * axis.dot(b), across = b - along;
  const double cosine = a.dot(across), sine = a.dot(axis.cross(across));
  const double wanted =
      0.5 * (distance * distance - a.squaredNorm() - b.squaredNorm()) - a.dot(along);
  const double size = std::hypot(cosine, sine);
  if (size == 0) return 0;
  const double straight = std::atan2(sine, cosine);
  const double bend = std::acos(std::clamp(wanted / size, -1.0, 1.0));
  const auto wrapped = [](double angle) { return std::remainder(angle, 2 * kPi); };
  const double one = wrapped(straight - bend), other = wrapped(straight + bend);
  return std::abs(one) < std::abs(other) ? one : other;
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
  if (hinge.norm() == 0) return {};
  hinge.normalize();
  const Mat3 bend = Eigen::AngleAxisd(turnToDistance(knee - hip, ankle - knee, hinge, after), hinge)
                        .toRotationMatrix();
  const Mat3 swing = shortestArc(knee - hip + bend * (ankle - knee), goal - hip);
  return {swing, swing * bend};
}

}  // namespace fascia
