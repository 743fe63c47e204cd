#pragma once

#include <string>
#include <vector>

#include <fascia/render/renderer.h>
#include <fascia/rig/joint_pose.h>

#include "bench/deformation/judge.h"

namespace fascia {

// Pictures of one turned joint side by side, in clay, triangles that cross others (and did not in
// the bind pose) in red. All from the side where most of the joint is seen and the turn is seen in
// profile.
class PosePictures {
 public:
  PosePictures(const RiggedModel& model, const JointPose& pose, const HingeRegion& region,
               const Judge& judge);
  // Appends a picture on the right. Throws Error when it cannot be drawn.
  void add(Renderer& renderer, const std::vector<Eigen::Vector3f>& points);
  void write(const std::string& path) const;  // PNG

 private:
  Camera camera(const std::vector<Eigen::Vector3f>& points) const;
  Vec3 bestSide(const std::vector<Eigen::Vector3f>& points) const;

  const RiggedModel& model_;
  const JointPose& pose_;
  const HingeRegion& region_;
  const Judge& judge_;
  Camera camera_;  // of the first picture, for all
  std::vector<Pixels> pictures_;
};

}  // namespace fascia
