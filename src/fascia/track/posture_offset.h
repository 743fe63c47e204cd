#pragma once

#include <vector>

#include <fascia/track/ball_joints.h>

namespace fascia {

// What is left of the difference between two samples, dying away: a posture that must not jump
// goes on from where it is, with the speed it has, and is where it should be a moment later. Each
// difference moves like a critically damped spring.
class PostureOffset {
 public:
  // reach_s: after it two thirds of a difference are gone, after three times as long 99 %.
  PostureOffset(const Figure& figure, double reach_s);

  // From time_s on apply() turns `goal` into `actual`, less and less. Both as sampleFit() gives
  // them.
  void start(double time_s, const PostureSample& actual, const PostureSample& goal);
  void clear() { active_ = false; }
  // A time before the start is as if the difference had just begun.
  void apply(double time_s, PostureSample& goal) const;

 private:
  struct Left {
    double share, rateShare;          // of the difference, and of its rate at the start
    double shareRate, rateShareRate;  // their derivatives, 1/s
  };
  Left left(double time_s) const;
  void startTurns(const Posture& actual, const Posture& goal);
  void applyTurns(const Left& left, Posture& goal) const;

  Figure figure_;
  BallJoints balls_;
  double stiffness_per_s_;
  bool active_ = false;
  double start_s_ = 0;
  std::vector<double> values_, rates_;         // differences of values
  std::vector<double> weights_, weightRates_;  // of morphs
  std::vector<Vec3> turns_, turnRates_;        // and of ball joints: rotation vectors
  mutable std::vector<JointRotation> goal_;    // scratch
};

}  // namespace fascia
