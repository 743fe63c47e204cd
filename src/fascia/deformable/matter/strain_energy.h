#pragma once

#include <fascia/material/body_def.h>
#include <fascia/math/types.h>

namespace fascia {

using Mat9 = Eigen::Matrix<double, 9, 9>;

// free: the energies of the paper, which let matter be crushed and turned inside out. resisted:
// below a fifth of its volume it hardens without bound, which only implicit steps can follow.
enum class Crushing { free, resisted };

// exact: the second derivative. positive: without the parts that make it indefinite away from
// rest, for Newton steps that must go downhill.
enum class Curvature { exact, positive };

// ψ(F) = k_e ‖FᵀF − I‖² + k_c (det F − 1)², J/m³, of the deformation gradient F = ∂x/∂X. The
// paper's energy is finite for matter that is flat or inside out, and may be at rest so; here a
// LogBarrier of det F is added, of stiffness 4 k_e + 2 k_c, where less than a fifth of the volume
// is left.
double strainEnergyDensity(const BodyMaterial& material, const Mat3& F,
                           Crushing crushing = Crushing::free);
// ∂ψ/∂F = 4 k_e F (FᵀF − I) + 2 k_c (det F − 1) cof F + …, Pa: the first Piola–Kirchhoff stress.
Mat3 strainStress(const BodyMaterial& material, const Mat3& F, Crushing crushing = Crushing::free);
// ∂²ψ/∂F∂F, Pa, F taken column by column.
Mat9 strainStiffness(const BodyMaterial& material, const Mat3& F, Curvature curvature,
                     Crushing crushing = Crushing::free);

// Stress of the relaxation at F for the rate Ḟ (1/s): linear in Ḟ, and never feeds energy in.
Mat3 relaxationStress(const BodyMaterial& material, const Mat3& F, const Mat3& rate_per_s);
// Its derivative by Ḟ, Pa s; symmetric, not negative.
Mat9 relaxationViscosity(const BodyMaterial& material, const Mat3& F);

// The matrix of cofactors, ∂ det F / ∂F.
Mat3 cofactors(const Mat3& F);

}  // namespace fascia
