#include <fascia/baking/bone_moments.h>

#include <algorithm>

#include <fascia/base/parallel.h>

namespace fascia {
namespace {

using Eigen::Index;

constexpr std::size_t kBonesPerTask = 16;  // large enough for a product of matrices to be worth it

}  // namespace

BoneMoments::BoneMoments(const SkinningProblem& problem, const BoneTracks& bones)
    : problem_(problem), frames_(problem.frameCount), middle_m_(frames_, Vec3::Zero()) {
  parallelFor(frames_, [&](std::size_t f) {
    for (std::size_t i = 0; i < problem.pointCount(); ++i) {
      middle_m_[f] += problem.target(i, f).cast<double>();
    }
    middle_m_[f] /= static_cast<double>(problem.pointCount());
  });
  stacked_.resize(3 * static_cast<Index>(frames_), col(bones.boneCount()));
  parallelFor(bones.boneCount(), [&](std::size_t b) {
    for (std::size_t f = 0; f < frames_; ++f) {
      auto block = stacked_.block<3, 4>(3 * static_cast<Index>(f), col(b));
      block.leftCols<3>() = bones.at(b, f).rotation;
      block.col(3) = bones.at(b, f).translation_m - middle_m_[f];
    }
  });
  // Every task has all rows of its own columns: the same sums on any number of threads.
  gram_.resize(stacked_.cols(), stacked_.cols());
  const std::size_t tasks = (bones.boneCount() + kBonesPerTask - 1) / kBonesPerTask;
  parallelFor(tasks, [&](std::size_t t) {
    const Index first = col(t * kBonesPerTask);
    const Index count = std::min(col(kBonesPerTask), stacked_.cols() - first);
    gram_.middleCols(first, count).noalias() =
        stacked_.transpose() * stacked_.middleCols(first, count);
  });
}

void BoneMoments::target(std::size_t point, Eigen::VectorXd& out) const {
  out.resize(3 * static_cast<Index>(frames_));
  for (std::size_t f = 0; f < frames_; ++f) {
    out.segment<3>(3 * static_cast<Index>(f)) =
        problem_.target(point, f).cast<double>() - middle_m_[f];
  }
}

}  // namespace fascia
