#include <fascia/deformable/matter/strain_energy.h>

#include <Eigen/Eigenvalues>

#include <fascia/math/log_barrier.h>

namespace fascia {
namespace {

// Matter that is squeezed below this part of its volume hardens. Larger: scenes with much squeezed
// bodies change. Smaller: its way of hardening gets steeper than steps can follow.
constexpr double kLeastVolume = 0.2;
// Goes on so far that what is a thousand times heavier than a body lies on it.
constexpr double kParabola = 1.0 / 1024;

bool hardens(Crushing crushing, double volume) {
  return crushing == Crushing::resisted && volume < kLeastVolume;
}

LogBarrier collapseOf(const BodyMaterial& m) {
  return {kLeastVolume, 4 * m.rigidity_Pa + 2 * m.volume_Pa, kParabola};
}

// The matrix of dF ↦ F (dFᵀF + FᵀdF), of which both derivatives below are made: with F's entries
// F_rα, its entry (rα, sβ) is F_rβ F_sα + (F Fᵀ)_rs δ_αβ.
Mat9 strainRateOperator(const Mat3& F) {
  const Mat3 left = F * F.transpose();
  Mat9 result;
  for (int beta = 0; beta < 3; ++beta) {
    for (int alpha = 0; alpha < 3; ++alpha) {
      Mat3 block = F.col(beta) * F.col(alpha).transpose();
      if (alpha == beta) block += left;
      result.block<3, 3>(3 * alpha, 3 * beta) = block;
    }
  }
  return result;
}

Mat3 withoutNegativePart(const Mat3& symmetric) {
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  solver.computeDirect(symmetric);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).asDiagonal() *
         solver.eigenvectors().transpose();
}

// ∂ cof F / ∂F: entry (rα, sβ) is ε_rsm ε_αβn F_mn.
void addCofactorSlope(const Mat3& F, double factor, Mat9& K) {
  for (int alpha = 0; alpha < 3; ++alpha) {
    for (int step = 1; step <= 2; ++step) {
      const int beta = (alpha + step) % 3, n = 3 - alpha - beta;
      const Vec3 f = (step == 1 ? factor : -factor) * F.col(n);
      Mat3 block;  // ε_rsm f_m
      block << 0, f.z(), -f.y(), -f.z(), 0, f.x(), f.y(), -f.x(), 0;
      K.block<3, 3>(3 * alpha, 3 * beta) += block;
    }
  }
}

}  // namespace

Mat3 cofactors(const Mat3& F) {
  Mat3 c;
  c.col(0) = F.col(1).cross(F.col(2));
  c.col(1) = F.col(2).cross(F.col(0));
  c.col(2) = F.col(0).cross(F.col(1));
  return c;
}

double strainEnergyDensity(const BodyMaterial& m, const Mat3& F, Crushing crushing) {
  const double J = F.determinant(), growth = J - 1;
  const double density = m.rigidity_Pa * (F.transpose() * F - Mat3::Identity()).squaredNorm() +
                         m.volume_Pa * growth * growth;
  return hardens(crushing, J) ? density + collapseOf(m).value(J) : density;
}

// By columns, which steps of many bodies do most of the time: F (FᵀF − I) in six scalar products.
Mat3 strainStress(const BodyMaterial& m, const Mat3& F, Crushing crushing) {
  const Vec3 x = F.col(0), y = F.col(1), z = F.col(2);
  const Vec3 yz = y.cross(z), zx = z.cross(x), xy = x.cross(y);  // the cofactors
  const double elastic = 4 * m.rigidity_Pa, J = x.dot(yz);
  double volume = 2 * m.volume_Pa * (J - 1);
  if (hardens(crushing, J)) volume -= collapseOf(m).force(J);
  const double shearXY = x.dot(y), shearYZ = y.dot(z), shearZX = z.dot(x);
  Mat3 P;
  P.col(0) = elastic * ((x.squaredNorm() - 1) * x + shearXY * y + shearZX * z) + volume * yz;
  P.col(1) = elastic * (shearXY * x + (y.squaredNorm() - 1) * y + shearYZ * z) + volume * zx;
  P.col(2) = elastic * (shearZX * x + shearYZ * y + (z.squaredNorm() - 1) * z) + volume * xy;
  return P;
}

Mat9 strainStiffness(const BodyMaterial& m, const Mat3& F, Curvature curvature, Crushing crushing) {
  Mat9 K = strainRateOperator(F);
  Mat3 strain = F.transpose() * F - Mat3::Identity();
  if (curvature == Curvature::positive) strain = withoutNegativePart(strain);
  for (int alpha = 0; alpha < 3; ++alpha)
    for (int beta = 0; beta < 3; ++beta)
      K.block<3, 3>(3 * alpha, 3 * beta).diagonal().array() += strain(alpha, beta);
  K *= 4 * m.rigidity_Pa;
  const Mat3 cofactor = cofactors(F);
  const Eigen::Map<const Eigen::Matrix<double, 9, 1>> c(cofactor.data());
  K += 2 * m.volume_Pa * c * c.transpose();
  const double J = F.col(0).dot(cofactor.col(0));
  const bool squeezed = hardens(crushing, J);
  if (squeezed) K += collapseOf(m).curvature(J) * c * c.transpose();
  if (curvature == Curvature::exact) {
    const double pressure = squeezed ? collapseOf(m).force(J) : 0;
    addCofactorSlope(F, 2 * m.volume_Pa * (J - 1) - pressure, K);
  }
  return K;
}

Mat3 relaxationStress(const BodyMaterial& m, const Mat3& F, const Mat3& rate) {
  const Mat3 half = rate.transpose() * F;
  return (4 * m.rigidity_Pa * m.relaxation_s) * (F * (half + half.transpose()));
}

Mat9 relaxationViscosity(const BodyMaterial& m, const Mat3& F) {
  return 4 * m.rigidity_Pa * m.relaxation_s * strainRateOperator(F);
}

}  // namespace fascia
