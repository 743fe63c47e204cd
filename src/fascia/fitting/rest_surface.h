#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <fascia/fitting/fit_flesh.h>
#include <fascia/geometry/triangle_hierarchy.h>

namespace fascia {

// A small piece of the skin, evenly spread whatever the triangles' sizes are.
struct SurfaceSample {
  static constexpr std::size_t kMostJoints = 4;
  Vec3 position_m, normal;
  double area_m2 = 0;
  double radius_m = 0;      // half the local thickness of the body; 0: no inside beneath
  double fat_m = 0;         // wanted distance of the flesh
  std::uint32_t piece = 0;  // RiggedModel::component
  std::array<std::uint16_t, kMostJoints> joint{};  // heaviest first
  std::array<double, kMostJoints> weight{};

  double weightOf(std::size_t wanted) const {
    for (std::size_t i = 0; i < kMostJoints; ++i) {
      if (joint[i] == wanted && weight[i] > 0) return weight[i];
    }
    return 0;
  }
};

// The rest skin as fitting sees it: samples with local thickness, and what is inside.
class RestSurface {
 public:
  RestSurface(const RiggedModel& model, const FitOptions& options);
  RestSurface(const RestSurface&) = delete;
  RestSurface& operator=(const RestSurface&) = delete;

  double height_m() const { return height_m_; }
  double area_m2() const { return area_m2_; }
  double leastFat_m() const { return leastFat_m_; }
  double fat_m(double radius_m) const;  // that a body of this local radius gets
  // Without what lies hidden inside of another piece of the surface: eyeballs, teeth, the ends of
  // overlapping parts.
  const std::vector<SurfaceSample>& samples() const { return samples_; }
  double hiddenShare() const { return hiddenShare_; }            // of the area
  const std::vector<Vec3>& corners() const { return corners_; }  // of its triangles, once each

  // Whether the surface surrounds the point: rays in several directions vote, so that holes (eyes,
  // cuffs) and doubled sheets do not decide. `except`: a connected piece that does not count.
  bool inside(const Vec3& p, std::uint32_t except = ~0u) const;
  // The nearest point of what is not hidden; the distance is negative inside by the normal there.
  struct Nearest {
    Vec3 position_m;
    double distance_m;
  };
  Nearest nearest(const Vec3& p) const;
  double signedDistance(const Vec3& p) const { return nearest(p).distance_m; }
  // Distance through the body along a direction that goes in at `p`; 0: nothing is behind.
  double thickness(const Vec3& p, const Vec3& inward, double limit_m) const;

 private:
  void addSamples(const RiggedModel& model, std::uint32_t triangle, double spacing_m);
  void thinOutCrowd();
  void measureThickness(SurfaceSample& sample) const;
  void dropHidden();
  void keepTriangles(const std::vector<char>& sampled, const std::vector<char>& seen);
  void addCorners(const std::vector<std::pair<std::uint32_t, std::uint32_t>>& candidates);

  TriangleMesh mesh_;  // welded, with smooth normals
  std::vector<Vec3> faceNormals_;
  std::vector<std::uint32_t> component_;  // per triangle
  TriangleHierarchy hierarchy_;
  TriangleMesh visible_;  // the same without the hidden triangles
  std::optional<TriangleHierarchy> visibleHierarchy_;
  double height_m_ = 0, size_m_ = 0, area_m2_ = 0, leastFat_m_ = 0, fatShare_ = 0, hiddenShare_ = 0;
  std::vector<SurfaceSample> samples_;
  std::vector<std::uint32_t> sampleTriangle_;  // only while it is built
  std::vector<Vec3> corners_;
};

}  // namespace fascia
