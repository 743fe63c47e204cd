#include <fascia/baking/morph_basis.h>

#include <gtest/gtest.h>

#include <fascia/baking/blended_frames.h>
#include <fascia/base/error.h>

#include "baking/tube.h"

namespace fascia {
namespace {

// A tube on two joints whose surface bulges in three places, each to its own beat.
class Bulges : public ::testing::Test {
 protected:
  static constexpr std::size_t kFrames = 30, kPlaces = 3;

  Bulges() {
    for (const Eigen::Vector3f& p : tube_.rest) {
      weights_.push_back(onTwo(0, 1, std::clamp(4 * p.z() - 1.5f, 0.0f, 1.0f)));
    }
    for (std::size_t f = 0; f < kFrames; ++f) {
      const double t = 2 * kPi * static_cast<double>(f) / kFrames;
      const Transform root = turnAbout(Vec3::Zero(), {0, 1, 0}, 0.8 * std::sin(t));
      bones_.push_back({root, root * turnAbout({0, 0, 0.5}, {1, 0, 0}, 1.2 * std::cos(t))});
      std::vector<Eigen::Vector3f>& frame = frames_.emplace_back();
      for (std::size_t i = 0; i < tube_.rest.size(); ++i) {
        frame.push_back(bulged(i, t, blendBones(weights_[i], bones_[f])));
      }
    }
  }

  Eigen::Vector3f bulged(std::size_t i, double t, const BlendedMatrix& blend) const {
    const Vec3 p = tube_.rest[i].cast<double>();
    Vec3 d = Vec3::Zero();
    for (std::size_t k = 0; k < kPlaces; ++k) {
      const double z = p.z() - 0.2 - 0.3 * static_cast<double>(k);
      const double bump = std::max(0.0, 1 - std::abs(z) / 0.1);
      d += bump * 0.02 * std::sin(t * static_cast<double>(k + 1) + 0.3) *
           Vec3(p.x(), p.y(), 0).normalized();
    }
    return blend.point(p + d).cast<float>();
  }

  MorphBasis find(const MorphOptions& options) const {
    return findMorphBasis(tube_.rest, weights_, bones_, frames_, options);
  }

  // The largest and RMS distance of what the basis plays to the frames.
  std::pair<double, double> playedError(const MorphBasis& basis) const {
    double largest = 0, sum = 0;
    for (std::size_t f = 0; f < kFrames; ++f) {
      std::vector<Vec3> p;
      for (const Eigen::Vector3f& r : tube_.rest) p.push_back(r.cast<double>());
      for (std::size_t k = 0; k < basis.targets.size(); ++k) {
        const MorphBasis::Target& target = basis.targets[k];
        for (std::size_t j = 0; j < target.points.size(); ++j) {
          p[target.points[j]] +=
              static_cast<double>(basis.weights[f][k]) * target.displacement_m[j].cast<double>();
        }
      }
      for (std::size_t i = 0; i < p.size(); ++i) {
        const double e =
            (blendBones(weights_[i], bones_[f]).point(p[i]) - frames_[f][i].cast<double>()).norm();
        largest = std::max(largest, e);
        sum += e * e;
      }
    }
    return {largest, std::sqrt(sum / static_cast<double>(kFrames * tube_.rest.size()))};
  }

  Tube tube_;
  std::vector<PointWeights> weights_;
  std::vector<std::vector<Transform>> bones_;
  PointFrames frames_;
};

TEST_F(Bulges, AsManyTargetsAsTheRankLeaveNoError) {
  MorphOptions options;
  options.targets = kPlaces + 1;  // and the offset
  options.sparsity = 0;
  const MorphBasis basis = find(options);
  EXPECT_EQ(basis.targets.size(), kPlaces + 1);
  EXPECT_LT(basis.max_m, 1e-6);
}

TEST_F(Bulges, RankBoundsTheTargets) {
  MorphOptions options;
  options.targets = 20;
  options.sparsity = 0;
  EXPECT_LE(find(options).targets.size(), kPlaces + 2);
}

TEST_F(Bulges, EachTargetMovesOnePlace) {
  MorphOptions options;
  options.targets = kPlaces + 1;
  MorphBasis basis = find(options);
  ASSERT_EQ(basis.targets.size(), kPlaces + 1);
  for (const std::vector<float>& w : basis.weights) EXPECT_EQ(w[0], 1);  // the offset
  basis.targets.erase(basis.targets.begin());
  EXPECT_LT(basis.max_m, 1e-6);  // truncation finds the true, disjoint supports
  std::vector<bool> moved(tube_.rest.size(), false);
  for (const MorphBasis::Target& target : basis.targets) {
    ASSERT_FALSE(target.points.empty());
    float low = 1, high = 0;
    for (const std::uint32_t i : target.points) {
      low = std::min(low, tube_.rest[i].z());
      high = std::max(high, tube_.rest[i].z());
      EXPECT_FALSE(moved[i]);
      moved[i] = true;
    }
    EXPECT_LT(high - low, 0.2f);
  }
}

TEST_F(Bulges, FewerTargetsLeaveMoreError) {
  double before = 0;
  for (const int targets : {4, 3, 2, 1}) {
    MorphOptions options;
    options.targets = targets;
    const MorphBasis basis = find(options);
    EXPECT_GT(basis.rms_m, before);
    before = basis.rms_m;
  }
  EXPECT_GT(before, 1e-3);
}

TEST_F(Bulges, ReportsTheErrorOfWhatItReturns) {
  MorphOptions options;
  options.targets = 2;
  const MorphBasis basis = find(options);
  const auto [largest, rms] = playedError(basis);
  EXPECT_GT(rms, 1e-4);
  EXPECT_NEAR(basis.rms_m, rms, 1e-6);
  EXPECT_NEAR(basis.max_m, largest, 1e-6);
}

TEST_F(Bulges, ToleranceStopsEarly) {
  MorphOptions options;
  options.targets = 20;
  options.tolerance_m = 4.5e-3;
  const MorphBasis basis = find(options);
  EXPECT_LE(basis.rms_m, options.tolerance_m);
  EXPECT_LE(basis.targets.size(), kPlaces);
}

TEST_F(Bulges, WeightsReachFromZeroToOne) {
  const MorphBasis basis = find({});
  ASSERT_EQ(basis.weights.size(), kFrames);
  for (std::size_t k = 0; k < basis.targets.size(); ++k) {
    float largest = 0;
    for (const std::vector<float>& w : basis.weights) {
      ASSERT_EQ(w.size(), basis.targets.size());
      EXPECT_GE(w[k], 0);
      largest = std::max(largest, w[k]);
    }
    EXPECT_FLOAT_EQ(largest, 1);
  }
}

TEST_F(Bulges, NothingToAddGivesNoTargets) {
  for (std::size_t f = 0; f < kFrames; ++f) {
    bones_[f].assign(2, Transform{});
    frames_[f] = tube_.rest;
  }
  const MorphBasis basis = find({});
  EXPECT_TRUE(basis.targets.empty());
  EXPECT_EQ(basis.weights.size(), kFrames);
  EXPECT_LT(basis.max_m, 1e-7);
}

TEST_F(Bulges, BadInputIsRefused) {
  MorphOptions options;
  options.targets = 0;
  EXPECT_THROW(find(options), Error);
  frames_[2][3].z() = std::nanf("");
  EXPECT_THROW(find({}), Error);
  frames_.pop_back();
  EXPECT_THROW(find({}), Error);
}

// Opposite halves of a full turn cancel: there is no displacement that could mend it, and what is
// tried instead must not explode.
TEST(BindPoseDisplacement, StaysSmallWhereTheBlendCollapses) {
  const std::vector<Transform> bones{Transform{}, turnAbout(Vec3::Zero(), {0, 0, 1}, kPi)};
  const BlendedMatrix blend = blendBones(onTwo(0, 1, 0.5f), bones);
  EXPECT_LT(std::abs(blend.linear.determinant()), 1e-9);
  const Vec3 rest(0.1, 0, 0.4), target(0.1, 0.02, 0.45);
  const Vec3 d = bindPoseDisplacement(blend, rest, target);
  EXPECT_LT(d.head<2>().norm(), 1e-9);
  EXPECT_NEAR(d.z(), 0.05, 0.005);
}

TEST(BindPoseDisplacement, TurnsTheBlendRound) {
  const std::vector<Transform> bones{turnAbout({0, 0, 1}, {1, 0, 0}, 0.9),
                                     turnAbout({0, 1, 0}, {0, 1, 1}, -0.4)};
  const BlendedMatrix blend = blendBones(onTwo(0, 1, 0.3f), bones);
  const Vec3 rest(0.3, -0.2, 0.5), target(0.1, 0.7, -0.2);
  const Vec3 d = bindPoseDisplacement(blend, rest, target);
  EXPECT_GT(d.norm(), 0.1);
  EXPECT_LT((blend.point(rest + d) - target).norm(), 1e-12);
}

}  // namespace
}  // namespace fascia
