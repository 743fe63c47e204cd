#pragma once

#include <cstddef>
#include <span>

#include <fascia/base/ids.h>
#include <fascia/geometry/box_tree.h>

namespace fascia {

// Which solids are near: a bounding hierarchy over their boxes. Built once per character, refitted
// per pose; its shape stays that of the pose it was built in.
class SolidHierarchy {
 public:
  void build(std::span<const Box> bounds) { tree_.build(bounds); }
  void refit(std::span<const Box> bounds) { tree_.refit(bounds); }  // as many as built with
  std::size_t solidCount() const { return tree_.itemCount(); }

  // The solids whose boxes, grown by margin_m, meet `box`: written to `out` in ascending order.
  // Returns how many. `out` must have room for all solids; allocates nothing.
  std::size_t query(const Box& box, double margin_m, std::span<SolidId> out) const;

 private:
  BoxTree tree_;
};

}  // namespace fascia
