#include <fascia/contact/broad_phase.h>

#include <algorithm>

namespace fascia {

void BroadPhase::update(std::span<const Box> boxes) {
  boxes_.clear(), number_.clear();
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].empty()) continue;
    boxes_.push_back(boxes[i]);
    number_.push_back(static_cast<std::uint32_t>(i));
  }
  tree_.build(boxes_, order_);
}

void BroadPhase::find(const Box& box, std::vector<std::uint32_t>& found) const {
  found.clear();
  tree_.visit([&](const Box& other) { return meets(box, other); },
              [&](std::uint32_t item) { found.push_back(number_[item]); });
  std::ranges::sort(found);
}

}  // namespace fascia
