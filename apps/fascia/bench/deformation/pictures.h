#pragma once

#include <string>
#include <vector>

#include <fascia/render/renderer.h>
#include <fascia/rig/hinge.h>

namespace fascia {

// Pictures of one bent joint side by side, in clay, triangles that cross others in red. All from
// where the bend is seen in profile.
class BendPictures {
 public:
  BendPictures(const RiggedModel& model, const Hinge& hinge);
  // Appends a picture on the right.
  void add(Renderer& renderer, const std::vector<Eigen::Vector3f>& points);
  void write(const std::string& path) const;  // PNG

 private:
  Camera camera(const std::vector<Eigen::Vector3f>& points) const;

  const RiggedModel& model_;
  const Hinge& hinge_;
  HingeRegion region_;
  Camera camera_;  // of the first picture, for all
  std::vector<Pixels> pictures_;
};

}  // namespace fascia
