#include <fascia/baking/morph_normals.h>

#include <gtest/gtest.h>

#include <fascia/baking/blended_frames.h>

#include "baking/tube.h"

namespace fascia {
namespace {

// A sheet on one joint that a wave bends and the joint turns.
class WavingSheet : public ::testing::Test {
 protected:
  static constexpr std::uint32_t kSide = 12;
  static constexpr std::size_t kFrames = 9;

  WavingSheet() {
    for (std::uint32_t j = 0; j < kSide; ++j)
      for (std::uint32_t i = 0; i < kSide; ++i)
        rest_.emplace_back(0.1f * static_cast<float>(i), 0.1f * static_cast<float>(j), 0.0f);
    for (std::uint32_t j = 0; j + 1 < kSide; ++j) {
      for (std::uint32_t i = 0; i + 1 < kSide; ++i) {
        const std::uint32_t a = j * kSide + i, b = a + 1, c = a + kSide, d = c + 1;
        triangles_.push_back({a, b, d});
        triangles_.push_back({a, d, c});
      }
    }
    weights_.assign(rest_.size(), PointWeights{{0}, {1}});
    MorphBasis::Target target;
    for (std::uint32_t i = 0; i < rest_.size(); ++i) {
      if (rest_[i].x() < 0.35f) continue;  // a third of the sheet stays still
      target.points.push_back(i);
      target.displacement_m.emplace_back(0, 0, 0.01f * std::sin(6 * rest_[i].x()));
    }
    basis_.targets.push_back(target);
    for (std::size_t f = 0; f < kFrames; ++f) {
      const float w = static_cast<float>(f) / (kFrames - 1);
      basis_.weights.push_back({w});
      const Transform turn = turnAbout({0.1, 0.2, 0}, {1, 0, 0}, 0.5 * static_cast<double>(f));
      bones_.push_back({turn});
      std::vector<Eigen::Vector3f> points = rest_;
      for (std::size_t k = 0; k < target.points.size(); ++k)
        points[target.points[k]] += w * target.displacement_m[k];
      for (Eigen::Vector3f& p : points) p = turn.point(p.cast<double>()).cast<float>();
      frames_.push_back(points);
    }
    computeNormals(rest_, triangles_, normals_);
  }

  std::vector<Eigen::Vector3f> rest_, normals_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<PointWeights> weights_;
  std::vector<std::vector<Transform>> bones_;
  PointFrames frames_;
  MorphBasis basis_;
};

TEST_F(WavingSheet, NormalsFollowTheWaveAndTheJoint) {
  const auto turns = fitMorphNormals(normals_, triangles_, weights_, bones_, frames_, basis_);
  ASSERT_EQ(turns.size(), 1u);
  double asRest = 0, fitted = 0;
  for (std::size_t f = 0; f < kFrames; ++f) {
    std::vector<Eigen::Vector3f> truth;
    computeNormals(frames_[f], triangles_, truth);
    for (std::size_t i = 0; i < rest_.size(); ++i) {
      const auto turned = [&](const Eigen::Vector3f& n) {
        return Vec3(bones_[f][0].rotation * n.cast<double>().normalized());
      };
      const Vec3 ours = turned(normals_[i] + basis_.weights[f][0] * turns[0][i]);
      fitted = std::max(fitted, (ours - truth[i].cast<double>()).norm());
      asRest = std::max(asRest, (turned(normals_[i]) - truth[i].cast<double>()).norm());
    }
  }
  EXPECT_GT(asRest, 0.05);   // radians: there is something to fit
  EXPECT_LT(fitted, 0.012);  // turns below 0.01 are left out
}

TEST_F(WavingSheet, NormalsStayWhereNothingMoves) {
  const auto turns = fitMorphNormals(normals_, triangles_, weights_, bones_, frames_, basis_);
  std::size_t turned = 0;
  for (std::size_t i = 0; i < rest_.size(); ++i) {
    if (rest_[i].x() < 0.25f) {
      EXPECT_TRUE(turns[0][i].isZero(0)) << i;
    }
    turned += turns[0][i].isZero(0) ? 0 : 1;
  }
  EXPECT_GT(turned, rest_.size() / 4);
}

TEST_F(WavingSheet, ABasisWithoutTargetsHasNoTurns) {
  MorphBasis none;
  none.weights.resize(kFrames);
  EXPECT_TRUE(fitMorphNormals(normals_, triangles_, weights_, bones_, frames_, none).empty());
}

}  // namespace
}  // namespace fascia
