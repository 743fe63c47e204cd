#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include <fascia/math/ode/system.h>

namespace fascia {

struct OdeState {
  double t_s = 0;
  std::vector<double> r, v;  // system.size() each: m, m/s

  void resize(std::size_t n) { r.resize(n), v.resize(n); }
};

// The scaling of errors (Turner & Gobbetti 1998, eq. 8): an error in x is divided by
// max(|x|, threshold), so that tolerances are relative for large x and absolute for small x.
struct ErrorScale {
  double threshold = 1;  // > 0
  bool relative = true;  // false: divide by threshold only; the same wherever the origin is

  double operator()(double x) const {
    return 1 / (relative ? std::max(std::abs(x), threshold) : threshold);
  }
};

struct IntegratorSettings {
  ErrorScale position_scale{.threshold = 1};
  ErrorScale velocity_scale{.threshold = 1};
  double velocity_tolerance = 1e-6;  // ε_v of inner iterations, after scaling
  int max_iterations = 30;           // inner iterations before a step counts as failed
};

// Returned by Integrator::step for a step that could not be done (no convergence, singular matrix).
inline constexpr double kStepFailed = std::numeric_limits<double>::infinity();

// One step of one method. Methods keep scratch memory and warm starts, nothing that changes what
// they compute beyond their inner tolerance; reset() forgets it (after a jump, for equal bits).
class Integrator {
 public:
  virtual ~Integrator() = default;

  virtual std::string_view name() const = 0;
  virtual int order() const = 0;
  // Order of the embedded lower-order formula; 0 = none: fixed steps only.
  virtual int embeddedOrder() const { return 0; }
  bool adaptive() const { return embeddedOrder() > 0; }

  // Computes the state h seconds after `from`. Returns the scaled difference of the positions to
  // those of the embedded formula (0 if there is none); NaN if some of them are not finite; or
  // kStepFailed: `to` is then unspecified.
  virtual double step(SecondOrderSystem& system, const OdeState& from, double h_s,
                      OdeState& to) = 0;
  virtual void reset() {}

  void setSettings(const IntegratorSettings& settings) { settings_ = settings; }
  const IntegratorSettings& settings() const { return settings_; }

 protected:
  IntegratorSettings settings_;
};

// Takes numbers and knows whether all were finite. Without branches and comparisons, which loops on
// vectors of 64 bits need not have: an exponent of ones carries over into the sign.
class FiniteCheck {
 public:
  void add(double x) { carried_ |= (std::bit_cast<std::uint64_t>(x) & kExponent) + kUnit; }
  bool allFinite() const { return carried_ >> 63 == 0; }

 private:
  static constexpr std::uint64_t kExponent = 0x7ff0000000000000, kUnit = 0x0010000000000000;
  std::uint64_t carried_ = 0;
};

// max_i |error(i)| factor(i) for i in [0, count); NaN if any component is not finite.
template <class Error, class Factor>
double largestScaled(std::size_t count, Error&& error, Factor&& factor) {
  // No early way out, and several maxima side by side: the loop then runs on vectors.
  constexpr std::size_t kLanes = 4;
  std::array<double, kLanes> largest{};
  FiniteCheck check;
  const auto take = [&](std::size_t i, double& most) {
    const double e = std::abs(error(i)) * factor(i);
    most = e > most ? e : most;
    check.add(e);
  };
  const std::size_t whole = count / kLanes * kLanes;
  for (std::size_t i = 0; i < whole; i += kLanes)
    for (std::size_t l = 0; l < kLanes; ++l) take(i + l, largest[l]);
  for (std::size_t i = whole; i < count; ++i) take(i, largest[i - whole]);
  if (!check.allFinite()) return std::numeric_limits<double>::quiet_NaN();
  return *std::max_element(largest.begin(), largest.end());
}

// max_i |error(i)| scale(reference[i]); NaN if any component is not finite.
template <class Error>
double scaledNorm(std::span<const double> reference, const ErrorScale& scale, Error&& error) {
  const std::size_t count = reference.size();
  if (scale.relative)
    return largestScaled(count, error, [&](std::size_t i) { return scale(reference[i]); });
  return largestScaled(count, error, [one = scale(0)](std::size_t) { return one; });
}

}  // namespace fascia
