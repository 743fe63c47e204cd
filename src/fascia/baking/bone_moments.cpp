#include <fascia/baking/bone_moments.h>

#include <algorithm>
#include <cassert>

#include <fascia/base/parallel.h>

namespace fascia {

BoneMoments::BoneMoments(const SkinningProblem& problem, const BoneTracks& rigBones)
    : problem_(problem),
      frames_(problem.frameCount),
      rows_((3 * frames_ + kRowBlock - 1) / kRowBlock * kRowBlock),
      rigBoneCount_(rigBones.boneCount()),
      middle_m_(rows_, 0.0) {
  for (std::size_t i = 0; i < problem.pointCount(); ++i) {
    const float* const x = problem.target(i, 0).data();
    for (std::size_t r = 0; r < 3 * frames_; ++r) middle_m_[r] += static_cast<double>(x[r]);
  }
  for (double& m : middle_m_) m /= static_cast<double>(problem.pointCount());
  stack(rigBones, 0);
}

void BoneMoments::update(const BoneTracks& bones) {
  assert(bones.boneCount() >= rigBoneCount_ && bones.frameCount() == frames_);
  stack(bones, rigBoneCount_);
}

// Every bone has its products with those before it: the same sums on any number of threads.
void BoneMoments::stack(const BoneTracks& bones, std::size_t first) {
  const std::size_t count = bones.boneCount();
  stacked_.resize(4 * rows_ * count, 0.0);
  pairs_.resize(pairOf(0, count));
  parallelFor(count - first, [&](std::size_t k) {
    double* const columns = bone(first + k);
    for (std::size_t f = 0; f < frames_; ++f) {
      const Transform& t = bones.at(first + k, f);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t row = 3 * f + axis;
        const auto a = static_cast<Eigen::Index>(axis);
        for (std::size_t c = 0; c < 3; ++c)
          columns[c * rows_ + row] = t.rotation(a, static_cast<Eigen::Index>(c));
        columns[3 * rows_ + row] = t.translation_m[a] - middle_m_[row];
      }
    }
  });
  parallelFor(count - first, [&](std::size_t k) {
    const std::size_t b = first + k;
    for (std::size_t a = 0; a <= b; ++a) pairs_[pairOf(a, b)] = productOf(bone(a), bone(b), rows_);
  });
}

void BoneMoments::target(std::size_t point, std::vector<double>& out) const {
  out.resize(rows_);
  const float* const x = problem_.target(point, 0).data();
  for (std::size_t r = 0; r < 3 * frames_; ++r) out[r] = static_cast<double>(x[r]) - middle_m_[r];
  std::fill(out.begin() + static_cast<std::ptrdiff_t>(3 * frames_), out.end(), 0.0);
}

double BoneMoments::withTarget(std::size_t b, const Eigen::Vector4d& p,
                               const std::vector<double>& target) const {
  const std::array<double, 4> sums = columnsTimes(bone(b), target.data(), rows_);
  return Eigen::Map<const Eigen::Vector4d>(sums.data()).dot(p);
}

Quadratic BoneMoments::squareOf(const Eigen::Vector4d& p) {
  return {p[0] * p[0], p[1] * p[1], p[2] * p[2], p[3] * p[3], p[0] * p[1],
          p[0] * p[2], p[0] * p[3], p[1] * p[2], p[1] * p[3], p[2] * p[3]};
}

double BoneMoments::between(std::size_t a, std::size_t b, const Quadratic& p) const {
  const Quadratic& product = pairs_[pairOf(std::min(a, b), std::max(a, b))];
  using Ten = Eigen::Map<const Eigen::Matrix<double, 10, 1>>;
  return Ten(product.data()).dot(Ten(p.data()));
}

}  // namespace fascia
