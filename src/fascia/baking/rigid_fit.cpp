#include <fascia/baking/rigid_fit.h>

#include <algorithm>

#include <Eigen/SVD>

namespace fascia {
namespace {

// Share of the points' spread that pulls a rotation towards the one before. Far below what any real
// patch says, far above rounding.
constexpr double kLikeness = 1e-9;
// A motion's next frame is near: three or four steps do. More tell of a start on the wrong side.
constexpr int kMostSteps = 8;
constexpr double kSmallestTurn_rad = 1e-4;  // the step after this one would be of its square

Mat3 rotationBySvd(const Mat3& correlation) {
  const Eigen::JacobiSVD<Mat3> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Mat3 turn = svd.matrixV() * svd.matrixU().transpose();
  if (turn.determinant() >= 0) return turn;
  Mat3 v = svd.matrixV();
  v.col(2) *= -1;
  return v * svd.matrixU().transpose();
}

// A rotation by about |turn| around it, orthonormal to the last digit.
Mat3 smallRotation(const Vec3& turn) {
  return Quat(1, 0.5 * turn.x(), 0.5 * turn.y(), 0.5 * turn.z()).normalized().toRotationMatrix();
}

// Takes out what many products of rotations have gathered in rounding.
Mat3 orthonormal(const Mat3& r) {
  return r * (1.5 * Mat3::Identity() - 0.5 * (r.transpose() * r));
}

}  // namespace

// With B = (R · correlation)ᵀ, turning by ω more changes tr(R · correlation) by b·ω − ½ ωᵀ H ω, b
// twice the axial vector of B and H = tr(B) 1 − sym(B). Where b = 0, H is positive definite at the
// largest maximum and nowhere else: its eigenvalues are sums of two singular values, with the sign
// of the smallest one turned for the best rotation of a reflection.
Mat3 bestRotation(const Mat3& correlation, const Mat3& start) {
  Mat3 turn = start;
  for (int step = 0; step < kMostSteps; ++step) {
    const Mat3 B = (turn * correlation).transpose();
    const Vec3 b(B(2, 1) - B(1, 2), B(0, 2) - B(2, 0), B(1, 0) - B(0, 1));
    const Mat3 H = B.trace() * Mat3::Identity() - 0.5 * (B + B.transpose());
    // Cofactors; the leading minors tell whether H is positive definite.
    const Vec3 c0 = H.col(1).cross(H.col(2));
    const double determinant = H.col(0).dot(c0);
    if (!(H(0, 0) > 0) || !(H(0, 0) * H(1, 1) - H(0, 1) * H(0, 1) > 0) || !(determinant > 0)) break;
    const Vec3 omega =
        Vec3(c0.dot(b), H.col(2).cross(H.col(0)).dot(b), H.col(0).cross(H.col(1)).dot(b)) /
        determinant;
    const double size2 = omega.squaredNorm();
    if (!(size2 < 1)) break;
    turn = smallRotation(omega) * turn;
    if (size2 < kSmallestTurn_rad * kSmallestTurn_rad) return orthonormal(turn);
  }
  return rotationBySvd(correlation);
}

Transform fitRigidly(const RigidSums& sums, const Vec3& origin_m, const Transform& like) {
  if (sums.mass <= 1e-12) return like;
  const Vec3 from = sums.point / sums.mass;
  const Vec3 to = sums.target / sums.mass;
  const double spread = sums.spread - sums.mass * from.squaredNorm();
  const Mat3 correlation = sums.correlation - (sums.mass * from) * to.transpose() +
                           std::max(kLikeness * spread, 1e-30) * like.rotation.transpose();
  const Mat3 turn = bestRotation(correlation, like.rotation);
  return {turn, to - turn * (from + origin_m)};
}

}  // namespace fascia
