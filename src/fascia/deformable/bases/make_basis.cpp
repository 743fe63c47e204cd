#include <fascia/deformable/bases/basis.h>

namespace fascia {

BasisPtr makeBasis(const BodyBasisDef& def, int dimension, const Box& box_m) {
  switch (def.kind) {
    case BodyBasisDef::Kind::polynomial:
      return makePolynomialBasis(dimension, def.order, box_m);
    case BodyBasisDef::Kind::lattice:
      return makeBernsteinBasis(dimension, def.cells, box_m);
    case BodyBasisDef::Kind::affine:
      break;
  }
  return makeAffineBasis(dimension);
}

}  // namespace fascia
