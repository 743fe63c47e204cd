#include <fascia/baking/displacement_basis.h>

#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>

namespace fascia {
namespace {

using Eigen::Index;

constexpr Index kBlockRows = 4096;  // of displacements turned into doubles at once
constexpr int kRefits = 4;          // more change the third digit of the error
// Of the largest eigenvalue: what single precision leaves of smaller ones is noise.
constexpr double kNoEigenvalue = 1e-12;

// aᵀ b in double precision, for tall matrices.
Eigen::MatrixXd tallProduct(const Eigen::MatrixXf& a, const Eigen::MatrixXf& b) {
  FASCIA_ASSERT(a.rows() == b.rows(), "both are of the same points");
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(a.cols(), b.cols());
  for (Index row = 0; row < a.rows(); row += kBlockRows) {
    const Index count = std::min(kBlockRows, a.rows() - row);
    sum.noalias() += a.middleRows(row, count).cast<double>().transpose() *
                     b.middleRows(row, count).cast<double>();
  }
  return sum;
}

// a b in double precision, for a tall matrix in single precision.
Eigen::MatrixXd tallTimes(const Eigen::MatrixXf& a, const Eigen::MatrixXd& b) {
  FASCIA_ASSERT(a.cols() == b.rows(), "a column for each row");
  Eigen::MatrixXd out(a.rows(), b.cols());
  for (Index row = 0; row < a.rows(); row += kBlockRows) {
    const Index count = std::min(kBlockRows, a.rows() - row);
    out.middleRows(row, count).noalias() = a.middleRows(row, count).cast<double>() * b;
  }
  return out;
}

double fieldLength(const DisplacementBasis& basis, Index point, Index field) {
  return basis.fields.col(field).segment<3>(3 * point).norm();
}

// Scales every field so that its weights reach from -1 or to 1.
void scaleWeights(DisplacementBasis& basis) {
  for (Index k = 0; k < basis.fields.cols(); ++k) {
    const double largest = basis.weights.row(k).cwiseAbs().maxCoeff();
    if (largest <= 0) continue;
    basis.fields.col(k) *= largest;
    basis.weights.row(k) /= largest;
  }
}

// The angle between two fields a, b that makes Σ (|a|⁴ + |b|⁴) over points largest, and by how much
// they turn: with u = |a|² - |b|² and v = 2 a·b, turning by θ leaves Σ (u cos 2θ + v sin 2θ)².
double bestAngle(const DisplacementBasis& basis, Index a, Index b) {
  double uv = 0, uuMinusVv = 0;
  for (Index i = 0; i < basis.fields.rows() / 3; ++i) {
    const Eigen::Vector3d x = basis.fields.col(a).segment<3>(3 * i);
    const Eigen::Vector3d y = basis.fields.col(b).segment<3>(3 * i);
    const double u = x.squaredNorm() - y.squaredNorm();
    const double v = 2 * x.dot(y);
    uv += u * v;
    uuMinusVv += u * u - v * v;
  }
  return 0.25 * std::atan2(2 * uv, uuMinusVv);
}

// Which fields move a point.
std::vector<Index> activeFields(const DisplacementBasis& basis, Index point) {
  std::vector<Index> active;
  for (Index k = 0; k < basis.fields.cols(); ++k) {
    if (fieldLength(basis, point, k) > 0) active.push_back(k);
  }
  return active;
}

// Weights that fit the displacements best. The shift keeps fields that are alike, or empty, apart.
void refitWeights(const Eigen::MatrixXf& displacements, DisplacementBasis& basis) {
  Eigen::MatrixXd gram = basis.fields.transpose() * basis.fields;
  gram.diagonal().array() += 1e-12 * gram.trace() + 1e-300;
  basis.weights = gram.ldlt().solve(tallTimes(displacements.transpose(), basis.fields).transpose());
}

// Field by field entry, but only those that are not zero.
void refitFields(const Eigen::MatrixXf& displacements, DisplacementBasis& basis) {
  const Eigen::MatrixXd gram = basis.weights * basis.weights.transpose();
  const double shift = 1e-12 * gram.trace() + 1e-300;
  const Eigen::MatrixXd moment = tallTimes(displacements, basis.weights.transpose());
  parallelFor(static_cast<std::size_t>(basis.fields.rows() / 3), [&](std::size_t point) {
    const auto i = static_cast<Index>(point);
    const std::vector<Index> active = activeFields(basis, i);
    if (active.empty()) return;
    const auto n = static_cast<Index>(active.size());
    Eigen::MatrixXd A(n, n), b(n, 3);
    for (Index r = 0; r < n; ++r) {
      const Index row = active[static_cast<std::size_t>(r)];
      for (Index c = 0; c < n; ++c) A(r, c) = gram(row, active[static_cast<std::size_t>(c)]);
      A(r, r) += shift;
      b.row(r) = moment.col(row).segment<3>(3 * i).transpose();
    }
    const Eigen::MatrixXd found = A.ldlt().solve(b);
    for (Index r = 0; r < n; ++r) {
      basis.fields.col(active[static_cast<std::size_t>(r)]).segment<3>(3 * i) =
          found.row(r).transpose();
    }
  });
}

}  // namespace

DisplacementBasis principalFields(Eigen::MatrixXf& displacements, int most, double tolerance) {
  DisplacementBasis basis;
  basis.offset = displacements.cast<double>().rowwise().mean();
  displacements.colwise() -= basis.offset.cast<float>();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      tallProduct(displacements, displacements));
  const Index frames = displacements.cols();
  const Eigen::VectorXd energy = solver.eigenvalues().reverse().cwiseMax(0);
  const Index points = displacements.rows() / 3;
  const double entries = static_cast<double>(points * frames);
  Index count = 0;
  double left = energy.sum();
  while (count < std::min<Index>(most, frames) && energy[count] > kNoEigenvalue * energy[0] &&
         std::sqrt(std::max(left, 0.0) / entries) > tolerance) {
    left -= energy[count++];
  }
  const Eigen::MatrixXd modes = solver.eigenvectors().rightCols(count).rowwise().reverse();
  basis.weights = modes.transpose();
  basis.fields = tallTimes(displacements, modes);
  return basis;
}

void localizeFields(DisplacementBasis& basis) {
  const Index count = basis.fields.cols();
  for (int sweep = 0; sweep < 20; ++sweep) {
    double largest = 0;
    for (Index a = 0; a < count; ++a) {
      for (Index b = a + 1; b < count; ++b) {
        const double angle = bestAngle(basis, a, b);
        largest = std::max(largest, std::abs(angle));
        const Eigen::JacobiRotation<double> turn(std::cos(angle), -std::sin(angle));
        basis.fields.applyOnTheRight(a, b, turn);
        basis.weights.transpose().applyOnTheRight(a, b, turn);
      }
    }
    if (largest < 1e-3) break;
  }
}

void normalizeWeights(DisplacementBasis& basis) {
  for (Index k = 0; k < basis.fields.cols(); ++k) {
    const double least = basis.weights.row(k).minCoeff();
    basis.offset += least * basis.fields.col(k);
    basis.weights.row(k).array() -= least;
  }
  scaleWeights(basis);
}

void sparsifyFields(const Eigen::MatrixXf& displacements, double share, DisplacementBasis& basis) {
  if (share <= 0) return;
  scaleWeights(basis);
  const Index points = basis.offset.size() / 3;
  double longest = 0;
  for (Index i = 0; i < points; ++i) {
    longest = std::max(longest, basis.offset.segment<3>(3 * i).norm());
    for (Index k = 0; k < basis.fields.cols(); ++k) {
      longest = std::max(longest, fieldLength(basis, i, k));
    }
  }
  const auto truncate = [&](auto&& displacement) {
    if (displacement.norm() < share * longest) displacement.setZero();
  };
  for (Index i = 0; i < points; ++i) {
    truncate(basis.offset.segment<3>(3 * i));
    for (Index k = 0; k < basis.fields.cols(); ++k) {
      truncate(basis.fields.col(k).segment<3>(3 * i));
    }
  }
  for (int round = 0; round < kRefits && basis.fields.cols() > 0; ++round) {
    refitWeights(displacements, basis);
    refitFields(displacements, basis);
  }
}

}  // namespace fascia
