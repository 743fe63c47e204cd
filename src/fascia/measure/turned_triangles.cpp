#include <fascia/measure/deformation.h>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

Eigen::Vector3f normalOf(const std::array<std::uint32_t, 3>& t, PointList points) {
  FASCIA_ASSERT(areBelow(t, points.size()), "corners are points");
  return (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
}

}  // namespace

std::size_t turnedTriangles(TriangleList triangles, PointList rest,
                            std::span<const Eigen::Matrix3f> carried, PointList points) {
  std::size_t turned = 0;
  for (const auto& t : triangles) {
    const Eigen::Matrix3f turn = carried[t[0]] + carried[t[1]] + carried[t[2]];
    const Eigen::Vector3f expected = turn * normalOf(t, rest);
    turned += normalOf(t, points).dot(expected) >= 0 ? 0 : 1;
  }
  return turned;
}

}  // namespace fascia
