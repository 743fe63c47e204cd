#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fascia/math/ode/integrators.h>
#include <fascia/math/ode/system.h>

// Systems with known solutions for the tests of the ODE library.
namespace fascia::test {

// One mass on a spring, m r̈ = −k r − c v; counts how often its forces are asked for.
class Oscillator : public SecondOrderSystem {
 public:
  Oscillator(double stiffness, double damping, double mass = 1)
      : k_(stiffness), c_(damping), inverseMass_{1 / mass} {}
  std::size_t size() const override { return 1; }
  std::span<const double> inverseMass() const override { return inverseMass_; }
  bool hasVelocityForces() const override { return c_ != 0; }
  void addPositionForces(double, std::span<const double> r, std::span<double> f) override {
    ++positionCalls;
    f[0] -= k_ * r[0];
  }
  void addVelocityForces(double, std::span<const double>, std::span<const double> v,
                         std::span<double> f) override {
    ++velocityCalls;
    f[0] -= c_ * v[0];
  }
  double energy(const OdeState& s) const {
    return 0.5 * s.v[0] * s.v[0] / inverseMass_[0] + 0.5 * k_ * s.r[0] * s.r[0];
  }
  // Under-damped motion from r = 1, v = 0.
  double exact(double t) const {
    const double decay = 0.5 * c_ * inverseMass_[0];
    const double omega = std::sqrt(k_ * inverseMass_[0] - decay * decay);
    return std::exp(-decay * t) * (std::cos(omega * t) + decay / omega * std::sin(omega * t));
  }
  int positionCalls = 0, velocityCalls = 0;

 private:
  double k_, c_;
  std::vector<double> inverseMass_;
};

// r̈ = −9 r − v + drive(t) with the drive that makes sin 2t its solution.
class DrivenOscillator : public SecondOrderSystem {
 public:
  std::size_t size() const override { return 1; }
  std::span<const double> inverseMass() const override { return inverseMass_; }
  bool hasVelocityForces() const override { return true; }
  bool forcesDependOnTime() const override { return true; }
  void addPositionForces(double t, std::span<const double> r, std::span<double> f) override {
    f[0] += -9 * r[0] + (9 - 4) * std::sin(2 * t) + 2 * std::cos(2 * t);
  }
  void addVelocityForces(double, std::span<const double>, std::span<const double> v,
                         std::span<double> f) override {
    f[0] -= v[0];
  }
  static double exact(double t) { return std::sin(2 * t); }

 private:
  std::vector<double> inverseMass_{1};
};

// A body around a fixed centre, r̈ = −r/|r|³, on an ellipse of semi-major axis 1.
class Kepler : public SecondOrderSystem {
 public:
  explicit Kepler(double eccentricity) : e_(eccentricity) {}
  std::size_t size() const override { return 2; }
  std::span<const double> inverseMass() const override { return inverseMass_; }
  void addPositionForces(double, std::span<const double> r, std::span<double> f) override {
    const double d = std::hypot(r[0], r[1]);
    f[0] -= r[0] / (d * d * d);
    f[1] -= r[1] / (d * d * d);
  }
  OdeState start() const { return {0, {1 - e_, 0}, {0, std::sqrt((1 + e_) / (1 - e_))}}; }
  // Kepler's equation t = E − e sin E, by Newton's method; then r = (cos E − e, √(1−e²) sin E).
  std::vector<double> exact(double t) const {
    double anomaly = t;
    for (int i = 0; i < 50; ++i)
      anomaly -= (anomaly - e_ * std::sin(anomaly) - t) / (1 - e_ * std::cos(anomaly));
    return {std::cos(anomaly) - e_, std::sqrt(1 - e_ * e_) * std::sin(anomaly)};
  }

 private:
  double e_;
  std::vector<double> inverseMass_{1, 1};
};

// A unit mass on a spring whose other end is driven with constant velocity u: in the end's frame
// r = r_end + cos ωt − (u/ω) sin ωt for a start at distance 1 and at rest.
class TowedMass : public SecondOrderSystem {
 public:
  static constexpr double kStiffness = 4, kSpeed = 0.5;
  std::size_t size() const override { return 2; }
  std::span<const double> inverseMass() const override { return inverseMass_; }
  void addPositionForces(double, std::span<const double> r, std::span<double> f) override {
    const double pull = kStiffness * (r[1] - r[0]);
    f[0] += pull;
    f[1] -= pull;  // acts on the driven end, which must not care
  }
  static OdeState start() { return {0, {1, 0}, {0, kSpeed}}; }
  static double exact(double t) {
    const double omega = std::sqrt(kStiffness);
    return kSpeed * t + std::cos(omega * t) - kSpeed / omega * std::sin(omega * t);
  }

 private:
  std::vector<double> inverseMass_{1, 0};
};

// Planar points joined by damped springs of unit rest length into a chain whose first point is
// driven; with its own sparse derivatives.
class SpringChain : public SecondOrderSystem {
 public:
  SpringChain(std::size_t points, double stiffness, double damping, MatrixKind kind)
      : inverseMass_(2 * points, 1.0), k_(stiffness), c_(damping), kind_(kind) {
    inverseMass_[0] = inverseMass_[1] = 0;
  }
  std::size_t size() const override { return inverseMass_.size(); }
  std::span<const double> inverseMass() const override { return inverseMass_; }
  bool hasVelocityForces() const override { return true; }
  MatrixKind jacobianKind() const override { return kind_; }

  void addPositionForces(double, std::span<const double> r, std::span<double> f) override {
    for (std::size_t a = 0; a + 3 < size(); a += 2) {
      const double dx = r[a + 2] - r[a], dy = r[a + 3] - r[a + 1], length = std::hypot(dx, dy);
      const double tension = k_ * (length - 1) / length;
      f[a] += tension * dx, f[a + 1] += tension * dy;
      f[a + 2] -= tension * dx, f[a + 3] -= tension * dy;
    }
    for (std::size_t i = 1; i < size(); i += 2) f[i] -= 9.81;
  }
  void addVelocityForces(double, std::span<const double>, std::span<const double> v,
                         std::span<double> f) override {
    for (std::size_t i = 0; i < size(); ++i) f[i] -= c_ * v[i];
  }
  void forceJacobian(double, std::span<const double> r, std::span<const double>, SparseMatrix& dfdr,
                     SparseMatrix& dfdv) override {
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t a = 0; a + 3 < size(); a += 2) addSpring(a, r, entries);
    const auto n = static_cast<Eigen::Index>(size());
    dfdr.resize(n, n), dfdv.resize(n, n);
    dfdr.setFromTriplets(entries.begin(), entries.end());
    dfdv.setIdentity();
    dfdv *= -c_;
  }
  OdeState start() const {
    OdeState s{0, std::vector<double>(size()), std::vector<double>(size())};
    for (std::size_t i = 0; i < size(); i += 2) s.r[i] = 1.05 * static_cast<double>(i) / 2;
    return s;
  }

 private:
  void addSpring(std::size_t a, std::span<const double> r,
                 std::vector<Eigen::Triplet<double>>& entries) const {
    const double d[2] = {r[a + 2] - r[a], r[a + 3] - r[a + 1]}, length = std::hypot(d[0], d[1]);
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        const double along = d[i] * d[j] / (length * length);
        const double k = k_ * (along + (1 - 1 / length) * ((i == j) - along));
        const int p = static_cast<int>(a) + i, q = static_cast<int>(a) + j;
        entries.emplace_back(p, q, -k), entries.emplace_back(p + 2, q + 2, -k);
        entries.emplace_back(p, q + 2, k), entries.emplace_back(p + 2, q, k);
      }
    }
  }
  std::vector<double> inverseMass_;
  double k_, c_;
  MatrixKind kind_;
};

// A point mass above a floor at height 0, without bounce.
class FallingBall : public SecondOrderSystem {
 public:
  static constexpr double kGravity = 9.81;
  explicit FallingBall(bool tellsDepth = true) : tellsDepth_(tellsDepth) {}
  std::size_t size() const override { return 1; }
  std::span<const double> inverseMass() const override { return inverseMass_; }
  void addPositionForces(double, std::span<const double>, std::span<double> f) override {
    f[0] -= gravity_m_per_s2;
  }
  double violation(double, std::span<const double> r) override {
    return tellsDepth_ ? std::max(0.0, -r[0]) : 0;
  }
  double project(double t, std::span<double> r, std::span<double> v) override {
    const double depth = std::max(0.0, -r[0]);
    if (depth > 0) {
      touchTime_s = std::min(touchTime_s, t);
      r[0] = 0;
      v[0] = std::max(0.0, v[0]);
    }
    return depth;
  }
  double gravity_m_per_s2 = kGravity;
  double touchTime_s = HUGE_VAL;  // the earliest at which it was found inside the floor

 private:
  bool tellsDepth_;
  std::vector<double> inverseMass_{1};
};

// Runs `count` equal steps of a method from a state.
inline OdeState runSteps(Integrator& method, SecondOrderSystem& system, OdeState state,
                         double end_s, int count) {
  OdeState next;
  for (int i = 0; i < count; ++i) {
    const double error = method.step(system, state, end_s / count, next);
    if (error == kStepFailed) return {0, std::vector<double>(system.size(), HUGE_VAL), {}};
    std::swap(state, next);
  }
  return state;
}

inline IntegratorSettings tightSettings() {
  IntegratorSettings settings;
  settings.velocity_tolerance = 1e-13;
  settings.position_scale.relative = false;
  return settings;
}

}  // namespace fascia::test
