#pragma once

#include <memory>
#include <vector>

#include <fascia/base/random.h>
#include <fascia/deformable/body/body.h>

// Bodies for the tests.
namespace fascia::test {

inline Box boxOf(const Vec3& size) {
  return {-0.5 * size, 0.5 * size};
}

inline const Vec3 kBarSize_m{0.4, 0.1, 0.1};

inline std::vector<BasisPtr> allBases() {
  const Box box = boxOf(kBarSize_m);
  const auto everywhere = [](const Vec3&) { return true; };
  return {makeAffineBasis(2),
          makeAffineBasis(3),
          makePolynomialBasis(2, 3, box),
          makePolynomialBasis(3, 2, box),
          makeBernsteinBasis(2, {3, 2, 0}, box),
          makeBernsteinBasis(3, {2, 1, 1}, box),
          makeSkinningModesBasis(2, 3, box, 0.02, everywhere),
          makeSkinningModesBasis(3, 2, box, 0.05, everywhere)};
}

inline std::shared_ptr<const BodyShape> makeBar(const BasisPtr& basis,
                                                const BodyMaterial& material = {},
                                                const Vec3& size_m = kBarSize_m,
                                                double density = 1000,
                                                Crushing crushing = Crushing::free) {
  return std::make_shared<BodyShape>(BodyDef{
      basis, boxMatter(basis->dimension(), boxOf(size_m), density, MatterDetail::of(*basis)),
      material, crushing});
}

// A bar that is turned and bent out of shape by about `amount` of its size.
inline Eigen::VectorXd deformed(const BodyShape& shape, double amount, std::uint64_t seed) {
  Random random(seed);
  Eigen::VectorXd q(shape.coordinateCount());
  Transform place;
  place.rotation = Eigen::AngleAxisd(0.7, Vec3::UnitZ()).toRotationMatrix();
  place.translation_m = Vec3(0.1, -0.2, 0);
  shape.setRest(place, {q.data(), static_cast<std::size_t>(q.size())});
  const double scale = amount * shape.size_m() * std::sqrt(shape.mass_kg());
  for (double& x : q) x += scale * random.uniform(-1, 1);
  return q;
}

inline std::span<const double> view(const Eigen::VectorXd& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}
inline std::span<double> view(Eigen::VectorXd& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}

}  // namespace fascia::test
