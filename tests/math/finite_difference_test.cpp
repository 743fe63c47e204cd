#include <fascia/math/finite_difference.h>

#include <gtest/gtest.h>

#include <limits>

namespace fascia {
namespace {

const Eigen::Vector3d kPoint(0.3, -1.7, 250);

TEST(NumericGradient, EqualsTheClosedForm) {
  const auto value = [](const Eigen::VectorXd& x) {
    return std::sin(x[0]) * x[1] * x[1] + x[2] * x[2] * 1e-2;
  };
  const Eigen::Vector3d exact(std::cos(0.3) * 1.7 * 1.7, 2 * std::sin(0.3) * -1.7, 2 * 250 * 1e-2);
  EXPECT_LT(derivativeMismatch(exact, numericGradient(value, kPoint)), 1e-9);
}

TEST(NumericJacobian, HasValuesInRowsAndCoordinatesInColumns) {
  const auto values = [](const Eigen::VectorXd& x) {
    return Eigen::VectorXd(Eigen::Vector2d(x[0] * x[1], x[2]));
  };
  Eigen::MatrixXd exact(2, 3);
  exact << -1.7, 0.3, 0, 0, 0, 1;
  EXPECT_LT(derivativeMismatch(exact, numericJacobian(values, kPoint)), 1e-9);
}

TEST(DerivativeMismatch, NoticesAWrongSignAndRefusesToCompareNothing) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(3);
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(3);
  EXPECT_DOUBLE_EQ(derivativeMismatch(one, -one), 2);
  EXPECT_EQ(derivativeMismatch(zero, zero), HUGE_VAL);
  const Eigen::VectorXd nan = one * std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(derivativeMismatch(one, nan), HUGE_VAL);
}

}  // namespace
}  // namespace fascia
