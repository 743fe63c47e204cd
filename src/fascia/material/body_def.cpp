#include <fascia/material/body_def.h>

namespace fascia {

void validate(const BodyBasisDef& def, const std::string& pointer, Diagnostics& diagnostics) {
  if (def.kind == BodyBasisDef::Kind::polynomial)
    checkWhole(kBasisOrder, def.order, pointer + "/polynomial", diagnostics);
  if (def.kind != BodyBasisDef::Kind::lattice) return;
  for (int axis = 0; axis < 3; ++axis)
    checkWhole(kBasisCells, def.cells[axis],
               entryOf(pointer + "/lattice", static_cast<std::size_t>(axis)), diagnostics);
}

}  // namespace fascia
