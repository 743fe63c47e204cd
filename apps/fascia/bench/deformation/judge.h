#pragma once

#include <fascia/measure/deformation.h>
#include <fascia/rig/joint_pose.h>

#include "bench/deformation/contenders.h"

namespace fascia {

// What there is to say about a pose, of its last frame; and about a clip, of what changes with time
// the worst.
struct Score {
  std::size_t crossings = 0;           // pairs of triangles; without those of the bind pose
  std::size_t crossings_in_piece = 0;  // … of these, of one connected piece with itself
  std::size_t turned = 0;              // triangles
  Lumpiness lumpiness;                 // this and the next two: near the joint in poses
  EdgeStretch stretch;
  SkinSlide slide;
  double volume_loss = 0;   // poses: share of the joint's volume
  double loss_at_rest = 0;  // … of that, before it moves: what the skin's own rest loses
  double rest_error_m = 0;  // poses: how far the first frame lies from the bind pose, at most
  double jitter_m = 0;      // clips
};

// Measures deformations of one model against its bind pose.
class Judge {
 public:
  explicit Judge(const RiggedModel& model);

  // The last frame of a performance, in which this region's joint is turned.
  Score judgePose(const HingeRegion& region, const ContestStage& stage,
                  const ContestFrames& performance) const;
  Score judgeClip(const ContestStage& stage, const ContestFrames& performance) const;

  std::vector<CrossingPair> crossingsOf(PointList points) const;  // the new ones
  std::size_t crossingsAtRest() const { return restCrossings_.size(); }

 private:
  void countCrossings(PointList points, Score& score) const;
  std::size_t turnedOf(const std::vector<Transform>& motion, PointList points) const;

  const RiggedModel& model_;
  std::vector<std::uint32_t> bones_;  // of every point the dominant joint
  std::vector<Eigen::Vector3f> normals_;
  std::vector<CrossingPair> restCrossings_;
  double touching_m_;
  RestDetail detail_;
};

}  // namespace fascia
