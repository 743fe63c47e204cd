#pragma once

#include <array>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/skin/grid/grid_layout.h>

namespace fascia {

// Carries a smooth per-point vector from a coarse grid to a fine one: cubic (Catmull–Rom) in
// material coordinates, so that the fine surface shows no creases along the coarse rows. Weights
// are prepared once; apply() allocates nothing after its first call.
class Prolongation {
 public:
  Prolongation() = default;
  Prolongation(const GridLayout& coarse, const GridLayout& fine);

  // fine = P coarse, pads included.
  void apply(const VectorArray& coarse, VectorArray& fine);

 private:
  struct Taps {
    std::array<int, 4> index;
    std::array<float, 4> weight;
  };
  static std::vector<Taps> makeTaps(int coarse, int fine, bool periodic);
  void applyAxis(const FloatArray& coarse, FloatArray& fine, std::size_t row, float* scratch) const;

  GridLayout coarse_, fine_;
  std::vector<Taps> columns_, rows_;
  FloatArray scratch_;  // a blended coarse row per fine row
};

}  // namespace fascia
