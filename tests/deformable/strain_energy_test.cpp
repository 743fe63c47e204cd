#include <gtest/gtest.h>

#include <fascia/deformable/matter/strain_energy.h>
#include <fascia/deformable/solve/body_stepper.h>
#include <fascia/math/finite_difference.h>

#include "bodies.h"

namespace fascia {
namespace {

constexpr BodyMaterial kJelly{.rigidity_Pa = 3000, .volume_Pa = 8000};

// Turned and sheared, with the determinant asked for.
Mat3 squeezed(double determinant) {
  Mat3 F = Eigen::AngleAxisd(0.6, Vec3(0.6, 0.48, 0.64)).toRotationMatrix();
  F.col(0) += 0.3 * F.col(1);
  F.col(2) *= determinant;
  return F;
}

TEST(StrainEnergy, DerivativesHoldWhereMatterIsSqueezedFlatAndInsideOut) {
  for (const double determinant : {0.19, 0.1, 0.02, 0.005, -0.05}) {
    const Mat3 F = squeezed(determinant);
    const auto at = [](const Eigen::VectorXd& f) { return Mat3(Eigen::Map<const Mat3>(f.data())); };
    const Eigen::VectorXd f = Eigen::Map<const Eigen::VectorXd>(F.data(), 9);
    const auto energy = [&](const Eigen::VectorXd& x) {
      return strainEnergyDensity(kJelly, at(x), Crushing::resisted);
    };
    const auto stress = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
      const Mat3 P = strainStress(kJelly, at(x), Crushing::resisted);
      return Eigen::Map<const Eigen::VectorXd>(P.data(), 9);
    };
    EXPECT_GT(stress(f).norm(), 1e3);
    EXPECT_LT(derivativeMismatch(stress(f), numericGradient(energy, f, 1e-6)), 1e-5) << determinant;
    const Eigen::MatrixXd K = strainStiffness(kJelly, F, Curvature::exact, Crushing::resisted);
    EXPECT_LT(derivativeMismatch(K, numericJacobian(stress, f, 1e-6)), 1e-5) << determinant;
  }
}

// The paper's energy alone may rest inside out.
TEST(StrainEnergy, ABodyThatStartsInsideOutTurnsBack) {
  for (const BasisPtr& basis : test::allBases()) {
    if (basis->dimension() != 3) continue;
    const Vec3 size_m(0.3, 0.2, 0.25);
    const auto shape =
        test::makeBar(basis, {.rigidity_Pa = 3000, .volume_Pa = 1000, .relaxation_s = 0.01}, size_m,
                      1000, Crushing::resisted);
    BodyModel model;
    model.add(shape);
    BodySystem system(std::move(model), {.gravity_m_per_s2 = Vec3::Zero()});
    OdeState state = system.model().restState();
    Transform mirror;
    mirror.rotation = Vec3(1, -0.3, 1).asDiagonal();
    shape->setRest(mirror, state.r);
    ASSERT_LT(shape->leastGrowth(state.r), -0.25);
    BodyStepper stepper(system);
    for (int i = 0; i < 240; ++i) stepper.step(1.0 / 60, state);
    EXPECT_NEAR(shape->leastGrowth(state.r), 1, 0.02) << basis->name();
    EXPECT_NEAR(shape->meanGrowth(state.r), 1, 0.02) << basis->name();
  }
}

}  // namespace
}  // namespace fascia
