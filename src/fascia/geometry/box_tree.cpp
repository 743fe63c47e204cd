#include <fascia/geometry/box_tree.h>

#include <algorithm>
#include <numeric>

#include <fascia/base/assert.h>

namespace fascia {

namespace {

Vec3 finiteCenter(const Box& box) {
  const Vec3 center = box.center();
  return center.allFinite() ? center : Vec3::Zero();
}

}  // namespace

void BoxTree::build(std::span<const Box> items) {
  std::vector<std::uint32_t> scratch;
  build(items, scratch);
}

void BoxTree::build(std::span<const Box> items, std::vector<std::uint32_t>& scratch) {
  nodes_.clear();
  if (items.empty()) return;
  nodes_.reserve(2 * items.size() - 1);
  scratch.resize(items.size());
  std::iota(scratch.begin(), scratch.end(), 0u);
  buildNode(items, scratch);
  refit(items);
}

// Halves the items at the median of their centres along the widest axis. Equal centres fall back to
// the items' numbers, so that the tree is the same everywhere.
void BoxTree::buildNode(std::span<const Box> items, std::span<std::uint32_t> order) {
  FASCIA_ASSERT(!order.empty() && areBelow(order, items.size()), "a node holds items");
  const std::size_t index = nodes_.size();
  nodes_.emplace_back();
  if (order.size() == 1) {
    nodes_[index].item = order.front();
    return;
  }
  Box centers;
  for (const std::uint32_t item : order) centers.add(finiteCenter(items[item]));
  Eigen::Index axis = 0;
  centers.size().maxCoeff(&axis);
  const std::size_t half = order.size() / 2;
  std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(half), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double ca = finiteCenter(items[a])[axis];
                     const double cb = finiteCenter(items[b])[axis];
                     return ca != cb ? ca < cb : a < b;
                   });
  buildNode(items, order.first(half));
  nodes_[index].right = static_cast<std::uint32_t>(nodes_.size());
  buildNode(items, order.subspan(half));
}

void BoxTree::refit(std::span<const Box> items) {
  FASCIA_ASSERT(items.size() == itemCount(), "as many boxes as the tree was built for");
  for (std::size_t i = nodes_.size(); i-- > 0;) {  // children come after their parents
    Node& node = nodes_[i];
    if (node.right == 0) {
      node.box = items[node.item];
    } else {
      node.box = nodes_[i + 1].box;
      node.box.add(nodes_[node.right].box);
    }
  }
}

}  // namespace fascia
