#pragma once

#include <fascia/rig/linear_blend.h>

namespace fascia {

struct DeltaMushOptions {
  int iterations =
      10;             // of Laplacian smoothing; more round wider joints, and thin out coarse limbs
  float step = 0.5f;  // (0, 1], towards the mean of the neighbours
};

// Delta mush (Mancewicz, Derksen, Rijpkema & Wilson 2014): smooths what linear blending gives, then
// adds the detail back that smoothing takes from the bind pose, in frames that ride on the smooth
// surface. Points on open edges are not smoothed, as is usual.
class DeltaMush : public BlendSkinning {
 public:
  explicit DeltaMush(const RiggedModel& model, const DeltaMushOptions& options = {});
  std::string_view name() const override { return "delta mush"; }
  void deform(std::span<const Transform> motion, std::span<Eigen::Vector3f> points) override;

 private:
  void findNeighbours(const RiggedModel& model);
  void smooth();  // `smooth_` in place
  // Unit axes of a point's frame on the smooth surface: normal, towards its first neighbour, third.
  Eigen::Matrix3f frame(std::size_t point) const;

  DeltaMushOptions options_;
  LinearBlend blend_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<std::uint32_t> firstNeighbour_, neighbours_;  // none: not smoothed
  std::vector<std::uint32_t> tangentTo_;                    // per point: a point of its triangles
  std::vector<Eigen::Vector3f> delta_;                      // per point, in its frame
  std::vector<Eigen::Vector3f> smooth_, before_, normals_;  // of the frame at hand
};

}  // namespace fascia
