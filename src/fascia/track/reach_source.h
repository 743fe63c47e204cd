#pragma once

#include <functional>
#include <vector>

#include <fascia/track/ball_joints.h>
#include <fascia/track/reach_chain.h>

namespace fascia {

// Inverse kinematics on top of another source: chains of joints bend so that a point of their last
// one is where it is wanted, within the joints' limits, from the posture that the source gives.
// What is out of reach is reached for.
class ReachSource final : public PostureSource {
 public:
  // The base must outlive it.
  ReachSource(const Figure& figure, const PostureSource& base);

  // The goal is asked for at any time of a frame, like the source; it must not throw or allocate.
  // Chains that share joints: one added later is solved on top of those before it.
  using Goal = std::function<ReachGoal(double time_s)>;
  // `root` must be `end` or above it. Throws Error otherwise, or if no joint between them turns.
  std::size_t add(const ReachChainDef& chain, Goal goal);
  // How far the chain's point is from its goal, which it gets to by its weight, m.
  double distance_m(std::size_t chain, double time_s) const;

  void sample(double time_s, PostureSample& out) const override;
  Info info() const override { return base_.info(); }

 private:
  struct Entry {
    ReachChain chain;
    Goal goal;
  };
  // The posture at a moment, with values that the chains have set; posed_ is its skeleton.
  void solve(double time_s, PostureSample& out) const;

  Figure figure_;
  const PostureSource& base_;
  BallJoints balls_;
  std::vector<bool> solved_;  // per ball joint: part of a chain
  std::vector<Entry> entries_;
  mutable PostureSample before_, after_;  // scratch
  mutable PosedSkeleton posed_;
};

}  // namespace fascia
