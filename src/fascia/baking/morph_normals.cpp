#include <fascia/baking/morph_normals.h>

#include <algorithm>

#include <Eigen/Cholesky>

#include <fascia/baking/blended_frames.h>
#include <fascia/base/parallel.h>

namespace fascia {
namespace {

using Eigen::Index;

// Of the mean square of the weights: keeps targets apart that are always at work together.
constexpr double kRidge = 1e-5;
// Turns by less, in radians, cannot be seen and are left out.
constexpr float kUnseen = 1e-2f;

// Per point the targets that move it or a point of its triangles, increasing.
std::vector<std::vector<Index>> targetsAt(std::size_t points,
                                          std::span<const std::array<std::uint32_t, 3>> triangles,
                                          const MorphBasis& basis) {
  std::vector<std::vector<Index>> out(points);
  std::vector<bool> moves(points), turns(points);
  for (std::size_t k = 0; k < basis.targets.size(); ++k) {
    moves.assign(points, false);
    for (const std::uint32_t i : basis.targets[k].points) moves[i] = true;
    turns = moves;
    for (const auto& t : triangles) {
      if (moves[t[0]] || moves[t[1]] || moves[t[2]])
        for (const std::uint32_t i : t) turns[i] = true;
    }
    for (std::size_t i = 0; i < points; ++i)
      if (turns[i]) out[i].push_back(static_cast<Index>(k));
  }
  return out;
}

// What the frames' normals, taken back to the bind pose, have more than those at rest: a normal
// goes with the inverse transpose of what moves its surface, so Mᵀ takes it back.
Eigen::MatrixXf missingNormals(std::span<const Eigen::Vector3f> restNormals,
                               std::span<const std::array<std::uint32_t, 3>> triangles,
                               std::span<const PointWeights> weights,
                               const std::vector<std::vector<Transform>>& bones,
                               const PointFrames& frames) {
  const std::size_t points = restNormals.size();
  Eigen::MatrixXf out(static_cast<Index>(3 * points), static_cast<Index>(frames.size()));
  const std::vector<std::array<std::uint32_t, 3>> faces(triangles.begin(), triangles.end());
  parallelFor(frames.size(), [&](std::size_t f) {
    std::vector<Eigen::Vector3f> normals;
    computeNormals(frames[f], faces, normals);
    for (std::size_t i = 0; i < points; ++i) {
      const Mat3 back = blendBones(weights[i], bones[f]).linear.transpose();
      const Vec3 atRest = (back * normals[i].cast<double>()).normalized();
      out.col(static_cast<Index>(f)).segment<3>(3 * static_cast<Index>(i)) =
          atRest.cast<float>() - restNormals[i];
    }
  });
  return out;
}

Eigen::MatrixXd weightsOf(const MorphBasis& basis) {
  Eigen::MatrixXd out(static_cast<Index>(basis.targets.size()),
                      static_cast<Index>(basis.weights.size()));
  for (Index f = 0; f < out.cols(); ++f)
    for (Index k = 0; k < out.rows(); ++k)
      out(k, f) = static_cast<double>(
          basis.weights[static_cast<std::size_t>(f)][static_cast<std::size_t>(k)]);
  return out;
}

}  // namespace

std::vector<std::vector<Eigen::Vector3f>> fitMorphNormals(
    std::span<const Eigen::Vector3f> restNormals,
    std::span<const std::array<std::uint32_t, 3>> triangles, std::span<const PointWeights> weights,
    const std::vector<std::vector<Transform>>& bones, const PointFrames& frames,
    const MorphBasis& basis) {
  const std::size_t points = restNormals.size(), targets = basis.targets.size();
  std::vector<std::vector<Eigen::Vector3f>> out(
      targets, std::vector<Eigen::Vector3f>(points, Eigen::Vector3f::Zero()));
  if (targets == 0) return out;
  const std::vector<std::vector<Index>> at = targetsAt(points, triangles, basis);
  const Eigen::MatrixXd w = weightsOf(basis);
  const Eigen::MatrixXd gram = w * w.transpose();
  const double ridge = kRidge * gram.trace() / static_cast<double>(targets) + 1e-300;
  const Eigen::MatrixXf moment =
      missingNormals(restNormals, triangles, weights, bones, frames) * w.transpose().cast<float>();
  parallelFor(points, [&](std::size_t i) {
    const auto n = static_cast<Index>(at[i].size());
    if (n == 0) return;
    Eigen::MatrixXd A = gram(at[i], at[i]), b(n, 3);
    A.diagonal().array() += ridge;
    for (Index r = 0; r < n; ++r)
      b.row(r) = moment.col(at[i][static_cast<std::size_t>(r)])
                     .segment<3>(3 * static_cast<Index>(i))
                     .cast<double>()
                     .transpose();
    const Eigen::MatrixXd found = A.ldlt().solve(b);
    for (Index r = 0; r < n; ++r) {
      const Eigen::Vector3f turn = found.row(r).transpose().cast<float>();
      if (turn.norm() > kUnseen)
        out[static_cast<std::size_t>(at[i][static_cast<std::size_t>(r)])][i] = turn;
    }
  });
  return out;
}

}  // namespace fascia
