#include <fascia/math/ode/system.h>

#include <algorithm>
#include <vector>

#include <fascia/base/assert.h>
#include <fascia/math/finite_difference.h>

namespace fascia {
namespace {

std::span<const double> view(const Eigen::VectorXd& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}
Eigen::VectorXd copy(std::span<const double> x) {
  return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}

}  // namespace

void SecondOrderSystem::addVelocityForces(double, std::span<const double>, std::span<const double>,
                                          std::span<double>) {}

bool SecondOrderSystem::midpointKick(double, std::span<const double>, std::span<const double>,
                                     double, std::span<double>) {
  return false;
}

void SecondOrderSystem::forceJacobian(double t_s, std::span<const double> r,
                                      std::span<const double> v, SparseMatrix& dfdr,
                                      SparseMatrix& dfdv) {
  const auto force = [&](std::span<const double> atR, std::span<const double> atV) {
    std::vector<double> f(size());
    evaluateForces(*this, t_s, atR, atV, f);
    return copy(f);
  };
  dfdr = numericJacobian([&](const Eigen::VectorXd& x) { return force(view(x), v); }, copy(r))
             .sparseView();
  dfdv = numericJacobian([&](const Eigen::VectorXd& x) { return force(r, view(x)); }, copy(v))
             .sparseView();
}

double SecondOrderSystem::violation(double, std::span<const double>) {
  return 0;
}
double SecondOrderSystem::project(double, std::span<double>, std::span<double>) {
  return 0;
}

void evaluateForces(SecondOrderSystem& system, double t_s, std::span<const double> r,
                    std::span<const double> v, std::span<double> f) {
  FASCIA_ASSERT(r.size() == system.size() && v.size() == r.size() && f.size() == r.size(),
                "state and forces fit the system");
  std::ranges::fill(f, 0.0);
  system.addPositionForces(t_s, r, f);
  if (system.hasVelocityForces()) system.addVelocityForces(t_s, r, v, f);
}

}  // namespace fascia
