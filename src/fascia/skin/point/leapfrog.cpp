#include <fascia/skin/point/leapfrog.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace fascia {
namespace {

constexpr int kNewtonSteps = 12;
constexpr double kBracket = 1e-7;
constexpr std::size_t kSums = 8;  // side by side: one would wait for itself

double sumOf(const double (&parts)[kSums]) {
  return std::accumulate(parts, parts + kSums, 0.0);
}

double neededMass(double stiffness_N_per_m, double h) {
  return 0.25 * kStabilityMargin * h * h * stiffness_N_per_m;
}

}  // namespace

void prepareStep(const PointModel& p, const ContactResponse& contact, double h,
                 StepCoefficients& out, AddedMass added) {
  const std::size_t n = p.mass.size();
  for (FloatArray* a : {&out.gain, &out.keep, &out.weight, &out.strandGain, &out.carry})
    a->resize(n);
  out.step_s = static_cast<float>(h);
  out.slide = static_cast<float>(std::exp(-h * contact.friction_per_s));
  out.bounce = static_cast<float>(contact.restitution);
  for (std::size_t k = 0; k < n; ++k) {
    const bool isFree = p.free[k] > 0;
    const double needed = added == AddedMass::asNeeded ? neededMass(p.stiffnessBound[k], h) : 0.0;
    const double mass = std::max<double>(p.mass[k], needed);
    const double z = isFree ? 0.5 * h * p.drag[k] / mass : 0;
    out.gain[k] = isFree ? static_cast<float>(h / (mass * (1 + z))) : 0.f;
    out.keep[k] = isFree ? static_cast<float>(std::max(0.0, (1 - z) / (1 + z))) : 1.f;
    out.weight[k] = isFree ? p.mass[k] : 0.f;
    const double damping = h * p.tissueDamping[k];
    out.strandGain[k] = isFree ? static_cast<float>(damping / (mass + damping)) : 0.f;
    out.carry[k] = isFree ? std::max(p.carry, static_cast<float>(1 - p.mass[k] / mass)) : 0.f;
  }
}

double longestStep(const PointModel& p, double share) {
  std::vector<double> mass, stiffness;  // of free points
  double own = 0;
  for (std::size_t k = 0; k < p.mass.size(); ++k) {
    if (p.free[k] == 0) continue;
    mass.push_back(p.mass[k]);
    stiffness.push_back(p.stiffnessBound[k]);
    own += p.mass[k];
  }
  const auto addedShare = [&](double h) {
    const double perStiffness = neededMass(1, h);
    double added[kSums] = {};
    for (std::size_t k = 0; k < mass.size(); ++k)
      added[k % kSums] += std::max(0.0, perStiffness * stiffness[k] - mass[k]);
    return own > 0 ? sumOf(added) / own : 0.0;
  };
  double low = 1e-7, high = 1.0 / 12;
  if (addedShare(high) <= share) return high;
  // The share grows with h², convex: Newton's way from the high side never passes the root. What it
  // brackets need not be asked again below.
  double tooLong = high, shortEnough = low;
  for (int i = 0; i < kNewtonSteps; ++i) {
    const double perStiffness = neededMass(1, tooLong);
    double added[kSums] = {}, slope[kSums] = {};  // over neededMass(1, h)
    for (std::size_t k = 0; k < mass.size(); ++k) {
      const double lacking = perStiffness * stiffness[k] - mass[k];
      added[k % kSums] += std::max(0.0, lacking);
      slope[k % kSums] += lacking > 0 ? stiffness[k] : 0.0;
    }
    const double root =
        perStiffness - (sumOf(added) - share * own) / std::max(1e-300, sumOf(slope));
    const double h = tooLong * std::sqrt(std::max(0.0, root / perStiffness)) * (1 + kBracket);
    if (!(h < tooLong * (1 - kBracket))) break;
    tooLong = h;
  }
  if (addedShare(tooLong) <= share) tooLong = high;  // rounding
  const double below = tooLong * (1 - 4 * kBracket);
  if (addedShare(below) <= share) shortEnough = below;
  // To a hundred-millionth: steps divide intervals into whole numbers anyway.
  for (int i = 0; i < 30; ++i) {
    const double middle = std::sqrt(low * high);
    const bool fits = middle <= shortEnough || (middle < tooLong && addedShare(middle) <= share);
    (fits ? low : high) = middle;
  }
  return low;
}

}  // namespace fascia
