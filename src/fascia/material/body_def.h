#pragma once

#include <string>

#include <fascia/base/tunable.h>
#include <fascia/math/types.h>

namespace fascia {

inline constexpr int kMaxPolynomialOrder = 8, kMaxLatticeCells = 6;

// Which shapes a body can take, as files say it.
struct BodyBasisDef {
  enum class Kind { affine, polynomial, lattice };
  Kind kind = Kind::affine;
  int order = 2;                                    // of a polynomial
  Eigen::Vector3i cells = Eigen::Vector3i::Ones();  // of a lattice, along x, y, z

  bool operator==(const BodyBasisDef&) const = default;
};
inline constexpr TunableInfo kBasisOrder{
    "polynomial", "", {1, kMaxPolynomialOrder}, "Order of a polynomial basis"};
inline constexpr TunableInfo kBasisCells{
    "lattice", "", {1, kMaxLatticeCells}, "Cells of a lattice along x, y, z"};

// What a body is made of. In two dimensions read Pa as N/m and m³ as m².
struct BodyMaterial {
  // Witkin & Welch's V_e and V_c per volume (§2.4). For small strains they are Hooke's law with the
  // Lamé constants µ = 4 rigidity, λ = 2 volume.
  double rigidity_Pa = 2.5e4;  // k_e
  double volume_Pa = 5e4;      // k_c

  // Force against the rate of strain in proportion to the rigidity, stress 4 k_e τ F d(FᵀF)/dt:
  // damps small swings evenly and leaves rigid motion alone (Kelvin & Voigt).
  double relaxation_s = 0;  // τ
  // The paper's damping −k_d V̇ ∂V/∂R (§2.4); fades out near the rest shape, where ∂V/∂R vanishes.
  double power_damping_s_per_J = 0;  // k_d
  // Force against the motion in proportion to the mass.
  double drag_per_s = 0;
  bool operator==(const BodyMaterial&) const = default;
};
constexpr auto tunables(const BodyMaterial*) {
  using M = BodyMaterial;
  return std::tuple{
      tunable(&M::rigidity_Pa, "rigidity_Pa", "Pa", {0, 1e12},
              "Against changes of shape; 1e3 jelly, 1e9 nearly rigid"),
      tunable(&M::volume_Pa, "volume_Pa", "Pa", {0, 1e12}, "Against changes of volume"),
      tunable(&M::relaxation_s, "relaxation_s", "s", {0, 1e3},
              "Damps swings: the time in which the material yields to a force"),
      tunable(&M::power_damping_s_per_J, "power_damping_s_per_J", "s/J", {0, 1e6},
              "Damps large swings only"),
      tunable(&M::drag_per_s, "drag_per_s", "1/s", {0, 1e6},
              "Against all motion, in proportion to the mass")};
}

// What a body is made of, as files say it.
struct BodyMaterialDef : BodyMaterial {
  double density_kg_per_m3 = 1000;
  bool operator==(const BodyMaterialDef&) const = default;
};
constexpr auto tunables(const BodyMaterialDef*) {
  return std::tuple_cat(
      std::tuple{tunable(&BodyMaterialDef::density_kg_per_m3, "density_kg_per_m3", "kg/m³",
                         positive(1e6), "Water has 1000; in two dimensions kg per m2")},
      tunables(static_cast<const BodyMaterial*>(nullptr)));
}

// Reports what is out of its range, with JSON pointers below `pointer`.
void validate(const BodyBasisDef& def, const std::string& pointer, Diagnostics& diagnostics);

}  // namespace fascia
