#pragma once

#include <string>

#include <fascia/base/error.h>
#include <fascia/body/basis.h>
#include <fascia/body/strain_energy.h>

namespace fascia {

// Which shapes a body can take, as files say it.
struct BodyBasisDef {
  enum class Kind { affine, polynomial, lattice };
  Kind kind = Kind::affine;
  int order = 2;                                    // of a polynomial, [1, 8]
  Eigen::Vector3i cells = Eigen::Vector3i::Ones();  // of a lattice, along x, y, z; each in [1, 6]

  bool operator==(const BodyBasisDef&) const = default;
};

// What a body is made of, as files say it.
struct BodyMaterialDef : BodyMaterial {
  double density_kg_per_m3 = 1000;  // (0, 1e6]; kg/m² in two dimensions
};

// Report what is out of its range, with JSON pointers below `pointer`.
void validate(const BodyBasisDef& def, const std::string& pointer, Diagnostics& diagnostics);
void validate(const BodyMaterialDef& def, const std::string& pointer, Diagnostics& diagnostics);

// Over a box around the undeformed body. Throws Error for numbers out of their ranges.
BasisPtr makeBasis(const BodyBasisDef& def, int dimension, const Box& box_m);

}  // namespace fascia
