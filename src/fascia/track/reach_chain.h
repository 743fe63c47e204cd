#pragma once

#include <optional>
#include <vector>

#include <fascia/flesh/posture_source.h>

namespace fascia {

// What a chain's end is to do at one moment.
struct ReachGoal {
  Vec3 position_m = Vec3::Zero();     // in the character's space
  std::optional<Quat> orientation{};  // of the end's joint there; empty: as it comes
  double weight = 1;                  // [0, 1]; 0 = the posture as it is
};

struct ReachChainDef {
  JointId root, end;            // the first and the last joint that may turn
  Vec3 point_m = Vec3::Zero();  // what reaches, in the frame of the end's joint
};

// A chain of joints solved by itself.
//
// Damped least squares with the damping of Sugihara, "Solvability-Unconcerned Inverse Kinematics by
// the Levenberg–Marquardt Method" (IEEE Trans. Robotics 27(5), 2011), eq. 17: half the squared
// residual plus a small bias. It needs no decisions, so that the solution moves smoothly with the
// goal, and stays calm where the goal is out of reach. Lengths count over the chain's, angles in
// radians. Changed: values that would leave their limits are held there for the step (the paper has
// none), and a solution that is stuck at a limit is tried for once more from the middle of ranges.
class ReachChain {
 public:
  ReachChain(const Skeleton& skeleton, const ReachChainDef& def);

  bool valid() const { return !turns_.empty(); }
  // Sets the chain's angles in `posture`, whose skeleton is `posed`.
  void solve(const ReachGoal& goal, const PosedSkeleton& posed, Posture& posture) const;
  // The values that it sets.
  struct Turn {
    std::size_t joint;  // in joints_
    int axis;           // 0 to 2: x, y, z
    std::size_t value;  // in Posture::values
    double min, max;
  };
  const std::vector<Turn>& turns() const { return turns_; }
  bool contains(JointId joint) const;
  Vec3 pointIn(const PosedSkeleton& posed) const {
    return posed.joint_world[joints_.back().id.index()].point(point_m_);
  }

 private:
  struct Joint {
    JointId id;
    Transform rest;  // in the parent's frame
    int values[6];   // tx … rz in Posture::values; -1: none
  };
  using Residual = Eigen::Matrix<double, 6, 1>;
  struct Wanted;
  void follow(const Posture& posture, const Transform& base) const;
  Residual residual(const Wanted& wanted) const;
  void findColumns(bool turned) const;
  void findChanges(const Residual& residual, const Posture& posture) const;
  double approach(const Wanted& wanted, Posture& posture) const;

  JointId parent_;  // of the root
  Vec3 point_m_;
  double length_m_ = 0;
  std::vector<Joint> joints_;  // from the root to the end
  std::vector<Turn> turns_;
  // Scratch: where the joints are, and the axis that each value turns about.
  mutable std::vector<Transform> frames_;
  mutable std::vector<Vec3> axes_;
  mutable std::vector<char> held_;
  mutable std::vector<double> change_, first_;
  mutable std::vector<Residual> columns_;
};

}  // namespace fascia
