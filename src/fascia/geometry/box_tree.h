#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <fascia/base/assert.h>
#include <fascia/math/types.h>

namespace fascia {

// Empty boxes meet nothing.
inline bool meets(const Box& a, const Box& b) {
  return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all() &&
         !a.empty() && !b.empty();
}

// Larger by so much on every side.
inline Box inflated(const Box& box, double by_m) {
  return {box.low.array() - by_m, box.high.array() + by_m};
}

// Squared distance from a point to a box; 0 inside.
inline double squaredDistance(const Box& box, const Vec3& p) {
  return (box.low - p).cwiseMax(p - box.high).cwiseMax(0.0).squaredNorm();
}

// A binary tree of axis-aligned boxes over numbered items, one item per leaf. Built by median
// splits, so that its depth is at most 32; refitting keeps the tree and moves the boxes.
class BoxTree {
 public:
  void build(std::span<const Box> items);
  // The same for trees that are built again and again: allocates only for more items than before.
  void build(std::span<const Box> items, std::vector<std::uint32_t>& scratch);
  void refit(std::span<const Box> items);  // as many as built with; allocates nothing
  std::size_t itemCount() const { return (nodes_.size() + 1) / 2; }

  // Calls item(index) for every item all of whose boxes, from the root to its own, `enter`.
  // Depth first; allocates nothing. `enter` may grow stricter during the walk.
  template <class Enter, class Item>
  void visit(Enter&& enter, Item&& item) const {
    visitNearFirst([](const Box&) { return 0.0; }, enter, item);
  }

  // The same, the child with the smaller `key` first: for searches for the nearest.
  template <class Key, class Enter, class Item>
  void visitNearFirst(Key&& key, Enter&& enter, Item&& item) const {
    if (nodes_.empty()) return;
    std::array<std::uint32_t, kStackSize> stack;
    std::size_t top = 0;
    stack[top++] = 0;
    while (top > 0) {
      const std::uint32_t index = stack[--top];
      const Node& node = nodes_[index];
      FASCIA_ASSERT(top + 2 <= kStackSize, "the tree is no deeper than it can be");
      if (!enter(node.box)) continue;
      if (node.right == 0) {
        item(node.item);
        continue;
      }
      const bool rightFirst = key(nodes_[node.right].box) < key(nodes_[index + 1].box);
      stack[top++] = rightFirst ? index + 1 : node.right;
      stack[top++] = rightFirst ? node.right : index + 1;
    }
  }

 private:
  static constexpr std::size_t kStackSize = 40;  // > depth: 32 for 2^32 items
  // Preorder: the left child follows its parent.
  struct Node {
    Box box;
    std::uint32_t right = 0;  // 0: a leaf
    std::uint32_t item = 0;   // of a leaf
  };
  void buildNode(std::span<const Box> items, std::span<std::uint32_t> order);

  std::vector<Node> nodes_;
};

}  // namespace fascia
