#pragma once

#include <cstddef>
#include <vector>

#include <fascia/track/ball_joints.h>

namespace fascia {

// Postures at times, and the smooth way through them. Holds the newest `capacity`; between two it
// moves along a cubic with a steady velocity (Catmull–Rom; rotations along one of their
// quaternions), before the first it stands, after the last it goes on for a moment and comes to a
// stop.
class PostureFrames {
 public:
  // coast_s ≥ 0: how long it goes on.
  PostureFrames(const Figure& figure, std::size_t capacity, double coast_s);

  // In any order; one of a time that is there already replaces it, one older than all that are held
  // is dropped when there is no room. What is not finite is made fit. Allocates nothing once all
  // room is taken.
  void put(double time_s, const PostureSample& sample);
  bool empty() const { return count_ == 0; }
  double newest_s() const { return frame(count_ - 1).time_s; }  // not of an empty one

  // Rest where there are none.
  void sample(double time_s, PostureSample& out) const;

 private:
  struct Frame {
    double time_s = 0;
    PostureSample sample;
    std::vector<Eigen::Vector4d> turns;  // of the ball joints: quaternions
  };
  // Where a time lies: between frames 1 and 2, with their neighbours, or beyond the last.
  struct Place;
  Place place(double time_s) const;
  const Frame& frame(std::size_t i) const { return ring_[(first_ + i) % ring_.size()]; }
  Frame& frame(std::size_t i) { return ring_[(first_ + i) % ring_.size()]; }
  Frame& makeRoom(double time_s);
  void sampleTurns(const Place& at, Posture& out) const;
  void sampleMorphs(const Place& at, MorphPose& out) const;
  void sampleParameters(const Place& at, PostureSample& out) const;

  Figure figure_;
  BallJoints balls_;
  double coast_s_;
  std::vector<Frame> ring_;
  std::size_t first_ = 0, count_ = 0;
  std::vector<JointRotation> read_;  // scratch
};

}  // namespace fascia
