#include <fascia/skin/contact/culled_solids.h>

#include <cmath>
#include <limits>

namespace fascia {

void CulledSolids::resize(std::size_t count) {
  count_ = count;
  values_.assign(kLists * padded(), 0.f);
}

// Rounded outwards: a solid too many is tested in vain, one too few would be missed.
void CulledSolids::setBox(std::size_t solid, const Box& box) {
  const auto outwards = [](double side) {
    constexpr float kRounding = 2.4e-7f;  // more than a float's last digit
    return kRounding * static_cast<float>(std::abs(side)) + std::numeric_limits<float>::min();
  };
  for (int a = 0; a < 3; ++a) {
    list(a)[solid] = static_cast<float>(box.low[a]) - outwards(box.low[a]);
    list(3 + a)[solid] = static_cast<float>(box.high[a]) + outwards(box.high[a]);
  }
}

void CulledSolids::setMotion(std::size_t solid, const Motion& m) {
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) list(6 + 3 * a + b)[solid] = m.change(a, b);
    list(15 + a)[solid] = m.origin[a];
    list(18 + a)[solid] = m.shift[a];
  }
  list(21)[solid] = m.turn;
  list(22)[solid] = m.extra_m;
  list(23)[solid] = m.steepness;
}

}  // namespace fascia
