#pragma once

#include <fascia/skin/point/point_model.h>

namespace fascia {

// The default scheme: leapfrog (velocities half a step behind positions, second order) with a mass
// that grows where the step is too long for the stiffness,
//
//   M' = max(M, h² K / 4),   K: Gershgorin bound of the stiffness at the point,
//
// which makes  v ← v + h M'⁻¹ f,  r ← r + h v  stable for any h and any stiffness: leapfrog needs
// h² λ(M'⁻¹K) ≤ 4. Where h resolves the point's stiffness, M' = M and nothing is changed; elsewhere
// the point answers more slowly but comes to rest in the same place, because M' divides all forces
// alike. A point with added mass takes over the share 1 − M/M' of its anchor's velocity changes, so
// that it is carried with the body instead of lagging behind. Explicit finite element codes know
// this as selective mass scaling.

// K is scaled by this before use: 1 is the limit itself, where the highest mode neither grows nor
// decays; larger wastes steps.
inline constexpr double kStabilityMargin = 1.1;

// How the material answers flesh contact; rates, so that it means the same at every step.
struct ContactResponse {
  double friction_per_s = 8;
  double restitution = 0;
};

// Schemes that are stable with any step by themselves add none.
enum class AddedMass { asNeeded, none };

// Fills `out` for step length h. Needs no memory when `out` already has the points' size.
void prepareStep(const PointModel& points, const ContactResponse& contact, double step_s,
                 StepCoefficients& out, AddedMass added = AddedMass::asNeeded);

// The longest step (s) at which added mass stays within `share` of the free points' mass.
// Bisection; used once when a skin is built.
double longestStep(const PointModel& points, double share);

}  // namespace fascia
