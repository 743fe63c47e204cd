#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace fascia {

// Puts points that lie together next to each other: compact runs of PointBlock::kCapacity, the last
// one shorter. `order`: numbers of points.
void sortIntoBlocks(std::span<const Eigen::Vector3f> points_m, std::span<std::uint32_t> order);

// All points in such an order.
std::vector<std::uint32_t> orderInBlocks(std::span<const Eigen::Vector3f> points_m);

}  // namespace fascia
