#pragma once

#include <algorithm>
#include <cmath>
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

// max_i |error(i)| scale(reference[i]); NaN if any component is not finite.
template <class Error>
double scaledNorm(std::span<const double> reference, const ErrorScale& scale, Error&& error) {
  // No early way out: the loop then runs on vectors.
  double largest = 0;
  bool finite = true;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const double e = std::abs(error(i)) * scale(reference[i]);
    largest = e > largest ? e : largest;
    finite &= e < std::numeric_limits<double>::infinity();
  }
  return finite ? largest : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace fascia
