#include <fascia/material/body_def.h>

#include <fascia/base/suggest.h>

namespace fascia {
namespace {

class Ranges {
 public:
  Ranges(std::string pointer, Diagnostics& diagnostics)
      : pointer_(std::move(pointer)), diagnostics_(diagnostics) {}

  void check(const std::string& key, double found, double low, double high,
             bool lowItself = true) const {
    if ((lowItself ? found >= low : found > low) && found <= high) return;  // false for NaN
    diagnostics_.error(pointer_ + key, "found " + shortNumber(found) + ", expected a number in " +
                                           (lowItself ? "[" : "(") + shortNumber(low) + ", " +
                                           shortNumber(high) + "]");
  }

 private:
  std::string pointer_;
  Diagnostics& diagnostics_;
};

}  // namespace

void validate(const BodyBasisDef& def, const std::string& pointer, Diagnostics& diagnostics) {
  const Ranges ranges(pointer, diagnostics);
  if (def.kind == BodyBasisDef::Kind::polynomial)
    ranges.check("/polynomial", def.order, 1, kMaxPolynomialOrder);
  if (def.kind != BodyBasisDef::Kind::lattice) return;
  for (int axis = 0; axis < 3; ++axis)
    ranges.check("/lattice/" + std::to_string(axis), def.cells[axis], 1, kMaxLatticeCells);
}

void validate(const BodyMaterialDef& def, const std::string& pointer, Diagnostics& diagnostics) {
  const Ranges ranges(pointer, diagnostics);
  ranges.check("/density_kg_per_m3", def.density_kg_per_m3, 0, 1e6, false);
  ranges.check("/rigidity_Pa", def.rigidity_Pa, 0, 1e12);
  ranges.check("/volume_Pa", def.volume_Pa, 0, 1e12);
  ranges.check("/relaxation_s", def.relaxation_s, 0, 1e3);
  ranges.check("/power_damping_s_per_J", def.power_damping_s_per_J, 0, 1e6);
  ranges.check("/drag_per_s", def.drag_per_s, 0, 1e6);
}

}  // namespace fascia
