#include <fascia/field/hierarchy.h>

#include <algorithm>
#include <cassert>

namespace fascia {

std::size_t SolidHierarchy::query(const Box& box, double margin_m, std::span<SolidId> out) const {
  assert(out.size() >= solidCount());
  const Box grown{box.low - Vec3::Constant(margin_m), box.high + Vec3::Constant(margin_m)};
  std::size_t found = 0;
  tree_.visit([&](const Box& node) { return meets(node, grown); },
              [&](std::uint32_t item) { out[found++] = SolidId(item); });
  std::sort(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(found));
  return found;
}

}  // namespace fascia
