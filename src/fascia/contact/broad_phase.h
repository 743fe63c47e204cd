#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <fascia/geometry/box_tree.h>

namespace fascia {

// Which boxes of a set meet a box. The boxes may all move from one update to the next.
class BroadPhase {
 public:
  // Empty boxes are never found. Allocates only when there are more boxes than ever before.
  void update(std::span<const Box> boxes);
  // The numbers of those that meet `box`, ascending. Any number of threads, each with its own list.
  void find(const Box& box, std::vector<std::uint32_t>& found) const;

 private:
  std::vector<Box> boxes_;             // those that are not empty
  std::vector<std::uint32_t> number_;  // of each
  std::vector<std::uint32_t> order_;   // scratch
  BoxTree tree_;
};

}  // namespace fascia
