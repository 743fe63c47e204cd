#include <fascia/baking/helper_moments.h>

#include <gtest/gtest.h>

#include <fascia/base/random.h>

#include "baking/tube.h"

namespace fascia {
namespace {

constexpr std::size_t kSharedFrames = 6;

// A rig of two joints and two helpers, all of which share points: the targets are what known
// motions of the helpers make of them.
class SharedPoints : public ::testing::Test {
 protected:
  SharedPoints() : bones_(kSharedFrames), wanted_(kSharedFrames) {
    Random random(3);
    for (const Eigen::Vector3f& p : tube_.rest) {
      problem_.rest_m.push_back(p.cast<double>());
      PointWeights w;
      float sum = 0;
      for (std::uint16_t b = 0; b < 4; ++b) {
        w.joint[b] = b;
        w.weight[b] = static_cast<float>(random.uniform(0.05, 1.0));
        sum += w.weight[b];
      }
      for (std::size_t b = 0; b < 4; ++b) w.weight[b] /= sum;
      weights_.push_back(w);
    }
    for (int b = 0; b < 4; ++b) {
      std::vector<Transform> track;
      for (std::size_t f = 0; f < kSharedFrames; ++f) {
        const auto t = static_cast<double>(f);
        track.push_back(
            turnAbout({0, 0, 0.2 * b}, Vec3(1, b, 0.5).normalized(), 0.1 * t * (b + 1)));
        track.back().translation_m.y() += 0.02 * t * b;
      }
      wanted_.add(track);
      bones_.add(b < 2 ? std::span<const Transform>(track)
                       : std::span<const Transform>(bones_.track(1)));
    }
    problem_.frameCount = kSharedFrames;
    for (std::size_t i = 0; i < weights_.size(); ++i)
      for (std::size_t f = 0; f < kSharedFrames; ++f)
        problem_.target_m.push_back(
            blendPoint(problem_.rest_m[i], weights_[i], wanted_, f).cast<float>());
  }

  double error(const BoneTracks& bones) const {
    double largest = 0;
    for (const PointError& e : pointErrors(problem_, weights_, bones, {0, kSharedFrames}))
      largest = std::max(largest, std::sqrt(e.largest_m2));
    return largest;
  }

  Tube tube_;
  SkinningProblem problem_;
  std::vector<PointWeights> weights_;
  BoneTracks bones_, wanted_;
};

TEST_F(SharedPoints, MotionsOfHelpersAreRecovered) {
  EXPECT_GT(error(bones_), 0.01);
  const HelperMoments moments(problem_.rest_m, weights_, 2, 4);
  moments.fit(&problem_, 500, bones_);
  EXPECT_LT(error(bones_), 2e-4);
}

TEST_F(SharedPoints, NoSweepMakesThemWorse) {
  const HelperMoments moments(problem_.rest_m, weights_, 2, 4);
  const auto sum = [&] {
    double all = 0;
    for (const PointError& e : pointErrors(problem_, weights_, bones_, {0, kSharedFrames}))
      all += e.sum_m2;
    return all;
  };
  double before = sum();
  for (int sweep = 0; sweep < 10; ++sweep) {
    moments.fit(&problem_, 1, bones_);
    const double now = sum();
    EXPECT_LE(now, before + 1e-12);
    before = now;
  }
}

// Where targets are a blend of the rig's joints, sums over the points say as much as the points.
TEST_F(SharedPoints, TargetsMayBeWeights) {
  std::vector<PointWeights> plain;
  for (const PointWeights& w : weights_) {
    PointWeights two;
    two.joint = {0, 1};
    two.weight = {w.weight[0] + w.weight[2], w.weight[1] + w.weight[3]};
    plain.push_back(two);
  }
  SkinningProblem explicitly = problem_;
  explicitly.target_m.clear();
  for (std::size_t i = 0; i < plain.size(); ++i)
    for (std::size_t f = 0; f < kSharedFrames; ++f)
      explicitly.target_m.push_back(
          blendPoint(problem_.rest_m[i], plain[i], bones_, f).cast<float>());
  BoneTracks implicitly = bones_;
  HelperMoments(problem_.rest_m, weights_, 2, 4).fit(&explicitly, 20, bones_);
  HelperMoments(problem_.rest_m, weights_, 2, 4, plain).fit(nullptr, 20, implicitly);
  for (std::size_t b = 2; b < 4; ++b)
    for (std::size_t f = 0; f < kSharedFrames; ++f)
      EXPECT_LT(
          (bones_.at(b, f).point({0, 0, 0.5}) - implicitly.at(b, f).point({0, 0, 0.5})).norm(),
          1e-5);
}

TEST_F(SharedPoints, HelpersThatCarryNothingStayWhereTheyAre) {
  std::vector<PointWeights> onJoint(weights_.size());
  for (PointWeights& w : onJoint) w.weight[0] = 1;
  const HelperMoments moments(problem_.rest_m, onJoint, 2, 4);
  const Transform before = bones_.at(2, 3);
  moments.fit(&problem_, 3, bones_);
  EXPECT_EQ(bones_.at(2, 3).rotation, before.rotation);
  EXPECT_EQ(bones_.at(2, 3).translation_m, before.translation_m);
}

}  // namespace
}  // namespace fascia
