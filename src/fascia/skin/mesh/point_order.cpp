#include <fascia/skin/mesh/point_order.h>

#include <algorithm>
#include <numeric>

#include <fascia/math/types.h>
#include <fascia/skin/point/point_kernels.h>

namespace fascia {

// Halves along the longest side, in whole blocks, until one is left.
void sortIntoBlocks(std::span<const Eigen::Vector3f> points_m, std::span<std::uint32_t> order) {
  if (order.size() <= PointBlock::kCapacity) {
    std::sort(order.begin(), order.end());
    return;
  }
  Box box;
  for (const std::uint32_t p : order) box.add(points_m[p].cast<double>());
  Eigen::Index axis;
  box.size().maxCoeff(&axis);
  const std::size_t blocks = (order.size() + PointBlock::kCapacity - 1) / PointBlock::kCapacity;
  const std::size_t middle = (blocks / 2) * PointBlock::kCapacity;
  std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(middle), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     const float x = points_m[a][axis], y = points_m[b][axis];
                     return x < y || (x == y && a < b);
                   });
  sortIntoBlocks(points_m, order.first(middle));
  sortIntoBlocks(points_m, order.subspan(middle));
}

std::vector<std::uint32_t> orderInBlocks(std::span<const Eigen::Vector3f> points_m) {
  std::vector<std::uint32_t> order(points_m.size());
  std::iota(order.begin(), order.end(), 0u);
  sortIntoBlocks(points_m, order);
  return order;
}

}  // namespace fascia
