#include <algorithm>
#include <cmath>

#include <fascia/measure/deformation.h>

namespace fascia {

SkinSlide skinSlide(std::span<const std::uint32_t> which, PointList rest, PointList restNormals,
                    const Carriers& carriers, PointList points) {
  SkinSlide slide;
  double squares = 0;
  for (const std::uint32_t p : which) {
    const Transform& motion = carriers.motion[carriers.bone[p]];
    const Vec3 moved = points[p].cast<double>() - motion.point(rest[p].cast<double>());
    const Vec3 normal = motion.vector(restNormals[p].cast<double>());
    const double along = (moved - moved.dot(normal) * normal).squaredNorm();
    squares += along;
    slide.largest_m = std::max(slide.largest_m, std::sqrt(along));
  }
  if (!which.empty()) slide.rms_m = std::sqrt(squares / static_cast<double>(which.size()));
  return slide;
}

void intoBones(const Carriers& carriers, PointList points, std::vector<Eigen::Vector3f>& seen) {
  std::vector<Transform> back(carriers.motion.size());
  for (std::size_t b = 0; b < back.size(); ++b) back[b] = carriers.motion[b].inverse();
  seen.resize(points.size());
  for (std::size_t p = 0; p < points.size(); ++p)
    seen[p] = back[carriers.bone[p]].point(points[p].cast<double>()).cast<float>();
}

double jitter_m(std::span<const std::vector<Eigen::Vector3f>> framesInBones) {
  if (framesInBones.size() < 4 || framesInBones.front().empty()) return 0;
  double squares = 0;
  const std::size_t points = framesInBones.front().size();
  for (std::size_t f = 3; f < framesInBones.size(); ++f)
    for (std::size_t p = 0; p < points; ++p) {
      const Eigen::Vector3f third = (framesInBones[f][p] - framesInBones[f - 3][p]) -
                                    3 * (framesInBones[f - 1][p] - framesInBones[f - 2][p]);
      squares += static_cast<double>(third.squaredNorm());
    }
  return std::sqrt(squares / static_cast<double>(points * (framesInBones.size() - 3)));
}

}  // namespace fascia
