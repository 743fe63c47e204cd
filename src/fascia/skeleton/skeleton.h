#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fascia/base/error.h>
#include <fascia/base/ids.h>
#include <fascia/base/tunable.h>
#include <fascia/math/types.h>

namespace fascia {

enum class Dof { tx, ty, tz, rx, ry, rz };
inline constexpr bool isRotation(Dof dof) {
  return dof >= Dof::rx;
}
std::string_view name(Dof dof);  // "tx" … "rz"
std::optional<Dof> dofFromName(std::string_view text);

struct DofDef {
  Dof dof = Dof::rx;
  double min = -1e9, max = 1e9;  // metre or radian; these two stand for "no limit"
  double rest = 0;               // value in the rest posture, within [min, max]
  bool operator==(const DofDef&) const = default;
};
// Limits, and values at rest and of keys.
inline constexpr TunableInfo kDofAngle{
    "rx, ry, rz", "deg", {-36000, 36000}, "Turning about an axis: limits, rest and keys"};
inline constexpr TunableInfo kDofShift{
    "tx, ty, tz", "m", {-1e6, 1e6}, "Moving along an axis: limits, rest and keys"};
constexpr const TunableInfo& dofInfo(Dof dof) {
  return isRotation(dof) ? kDofAngle : kDofShift;
}

// A joint's frame in its parent's: translate by offset, turn by orientation, then by its own
// degrees of freedom: translation (tx,ty,tz), then Rz·Ry·Rx.
struct JointDef {
  std::string name;    // unique
  std::string parent;  // empty = the root; parents come before children, and there is one root
  Vec3 offset_m = Vec3::Zero();
  Vec3 orientation_rad = Vec3::Zero();  // intrinsic Rz·Ry·Rx
  std::vector<DofDef> dofs;             // any subset of the six
  bool operator==(const JointDef&) const = default;
};
constexpr auto tunables(const JointDef*) {
  return std::tuple{
      tunable(&JointDef::offset_m, "offset_m", "m", {-1e6, 1e6}, "From the parent's origin"),
      tunable(&JointDef::orientation_rad, "orientation_deg", "deg", {-36000, 36000},
              "Turns about x, y, z at rest; applied as Rz Ry Rx")};
}
// More than any figure has; bounds what a hostile file can cost.
inline constexpr std::size_t kMostJoints = 1024;

struct SkeletonDef {
  std::vector<JointDef> joints;
  bool operator==(const SkeletonDef&) const = default;
};

// A joint's own turn as a rotation, where three angles would lose a direction (gimbal lock).
struct JointRotation {
  JointId joint;
  Quat rotation;           // unit; from the joint's frame at zero angles
  Vec3 angular_rad_per_s;  // in that frame
};

// The values of every degree of freedom, and their rates: one entry per Skeleton value.
struct Posture {
  std::vector<double> values;  // metre or radian
  std::vector<double> rates;   // per second
  // By joint, one each at most, of joints that have rx, ry and rz: they count instead of the
  // joint's angles, which say the same as well as angles can.
  std::vector<JointRotation> rotations{};
};

// World frames and velocities of every joint.
struct PosedSkeleton {
  std::vector<Transform> joint_world;
  std::vector<Twist> twist_world;  // origin_m = the joint's position
};

// Constant once built.
class Skeleton {
 public:
  Skeleton() = default;
  // Reports every fault of `def` to `diagnostics`; with errors the result must not be used.
  // `pointer` leads to the array of joints: "/skeleton" gives "/skeleton/3/parent".
  Skeleton(const SkeletonDef& def, const std::string& pointer, Diagnostics& diagnostics);

  std::size_t jointCount() const { return joints_.size(); }
  std::size_t valueCount() const { return valueDofs_.size(); }
  const JointDef& joint(JointId id) const { return joints_[id.index()]; }
  JointId parent(JointId id) const { return parents_[id.index()]; }
  JointId find(std::string_view name) const;     // invalid if there is none
  int valueIndex(JointId joint, Dof dof) const;  // -1 if the joint lacks it
  const DofDef& valueDof(int index) const { return valueDofs_[static_cast<std::size_t>(index)]; }
  JointId valueJoint(int index) const { return valueJoints_[static_cast<std::size_t>(index)]; }

  Posture restPosture() const;
  // Sets the angles of joints that have rotations: of all triples that turn alike, one close to
  // that in `near` (the values of a former posture; empty: of rest), so that angles go on where
  // they were, and within limits if one is. Of joints that lack angles or whose limits forbid the
  // rotation only the angles are left. Sorts the rotations, and drops those that are none.
  void resolveRotations(std::span<const double> near, Posture& posture) const;
  // A clamped value's rate becomes 0; a value that is not a number goes to rest.
  void clampToLimits(Posture& posture) const;

  // Forward kinematics with velocities. `posture` has valueCount() values and rates, and rotations
  // as resolveRotations() leaves them.
  // `out` is resized on first use, then reused.
  void pose(const Posture& posture, PosedSkeleton& out) const;

 private:
  struct Local;  // a joint's shift and angles, and their rates
  Local local(std::size_t joint, const Posture& posture) const;
  bool resolveRotation(const JointRotation& turn, std::span<const double> near,
                       Posture& posture) const;

  std::vector<JointDef> joints_;
  std::vector<JointId> parents_;
  std::vector<int> firstValue_;  // joint -> its first value; one more entry than joints
  std::vector<DofDef> valueDofs_;
  std::vector<JointId> valueJoints_;
  std::vector<Transform> restFrames_;  // offset and orientation in the parent's frame
};

}  // namespace fascia
