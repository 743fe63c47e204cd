#pragma once

#include <fascia/math/types.h>

namespace fascia {

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
};

using Mat9 = Eigen::Matrix<double, 9, 9>;

// exact: the second derivative. positive: without the parts that make it indefinite away from
// rest, for Newton steps that must go downhill.
enum class Curvature { exact, positive };

// ψ(F) = k_e ‖FᵀF − I‖² + k_c (det F − 1)², J/m³, of the deformation gradient F = ∂x/∂X.
double strainEnergyDensity(const BodyMaterial& material, const Mat3& F);
// ∂ψ/∂F = 4 k_e F (FᵀF − I) + 2 k_c (det F − 1) cof F, Pa: the first Piola–Kirchhoff stress.
Mat3 strainStress(const BodyMaterial& material, const Mat3& F);
// ∂²ψ/∂F∂F, Pa, F taken column by column.
Mat9 strainStiffness(const BodyMaterial& material, const Mat3& F, Curvature curvature);

// Stress of the relaxation at F for the rate Ḟ (1/s): linear in Ḟ, and never feeds energy in.
Mat3 relaxationStress(const BodyMaterial& material, const Mat3& F, const Mat3& rate_per_s);
// Its derivative by Ḟ, Pa s; symmetric, not negative.
Mat9 relaxationViscosity(const BodyMaterial& material, const Mat3& F);

// The matrix of cofactors, ∂ det F / ∂F.
Mat3 cofactors(const Mat3& F);

}  // namespace fascia
