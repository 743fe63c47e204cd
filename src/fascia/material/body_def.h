#pragma once

#include <string>

#include <fascia/base/error.h>
#include <fascia/math/types.h>

namespace fascia {

inline constexpr int kMaxPolynomialOrder = 8, kMaxLatticeCells = 6;

// Which shapes a body can take, as files say it.
struct BodyBasisDef {
  enum class Kind { affine, polynomial, lattice };
  Kind kind = Kind::affine;
  int order = 2;                                    // of a polynomial, [1, 8]
  Eigen::Vector3i cells = Eigen::Vector3i::Ones();  // of a lattice, along x, y, z; each in [1, 6]

  bool operator==(const BodyBasisDef&) const = default;
};

// What a body is made of. In two dimensions read Pa as N/m and m³ as m².
struct BodyMaterial {
  // Witkin & Welch's V_e and V_c per volume (§2.4). For small strains they are Hooke's law with the
  // Lamé constants µ = 4 rigidity, λ = 2 volume.
  double rigidity_Pa = 2.5e4;  // k_e, [0, 1e12]; 1e3 jelly, 1e9 nearly rigid
  double volume_Pa = 5e4;      // k_c, [0, 1e12]; large: keeps its volume

  // Force against the rate of strain in proportion to the rigidity, stress 4 k_e τ F d(FᵀF)/dt:
  // damps small swings evenly and leaves rigid motion alone (Kelvin & Voigt).
  double relaxation_s = 0;  // τ, [0, 1e3]
  // The paper's damping −k_d V̇ ∂V/∂R (§2.4); fades out near the rest shape, where ∂V/∂R vanishes.
  double power_damping_s_per_J = 0;  // k_d, [0, 1e6]
  // Force against the motion in proportion to the mass.
  double drag_per_s = 0;  // [0, 1e6]

  bool operator==(const BodyMaterial&) const = default;
};

// What a body is made of, as files say it.
struct BodyMaterialDef : BodyMaterial {
  double density_kg_per_m3 = 1000;  // (0, 1e6]; kg/m² in two dimensions

  bool operator==(const BodyMaterialDef&) const = default;
};

// Report what is out of its range, with JSON pointers below `pointer`.
void validate(const BodyBasisDef& def, const std::string& pointer, Diagnostics& diagnostics);
void validate(const BodyMaterialDef& def, const std::string& pointer, Diagnostics& diagnostics);

}  // namespace fascia
