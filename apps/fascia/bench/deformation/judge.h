#pragma once

#include <fascia/measure/deformation.h>
#include <fascia/rig/hinge.h>

#include "bench/deformation/contenders.h"

namespace fascia {

// What there is to say about a bent joint.
struct BendScore {
  double volume_loss = 0;     // share of the joint's volume
  double loss_at_rest = 0;    // … of that, before it bends: what the skin's own rest loses
  std::size_t crossings = 0;  // pairs of triangles; without those of the bind pose
  EdgeStretch stretch;        // near the joint
  SkinSlide slide;            // near the joint
};

// … and about a clip; of what changes with time, the worst.
struct ClipScore {
  std::size_t crossings = 0;
  EdgeStretch stretch;
  SkinSlide slide;
  double jitter_m = 0;
};

// Measures deformations of one model against its bind pose.
class Judge {
 public:
  explicit Judge(const RiggedModel& model);

  // The last frame of a performance, in which this hinge is bent.
  BendScore judgeBend(const Hinge& hinge, const ContestStage& stage,
                      const ContestFrames& performance) const;
  ClipScore judgeClip(const ContestStage& stage, const ContestFrames& performance) const;
  std::size_t crossingsAtRest() const { return restCrossings_.size(); }

 private:
  const RiggedModel& model_;
  std::vector<std::uint32_t> bones_;  // of every point the dominant joint
  std::vector<Eigen::Vector3f> normals_;
  std::vector<CrossingPair> restCrossings_;
};

}  // namespace fascia
