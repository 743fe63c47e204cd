#include <gtest/gtest.h>

#include <algorithm>

#include <fascia/base/error.h>
#include <fascia/base/parallel.h>

#include "baking/tube.h"

namespace fascia {
namespace {

// A rig of one joint that swings the tube, and three hidden bones that bend it on top of that.
class HiddenBones : public ::testing::Test {
 protected:
  static constexpr std::size_t kFrames = 24;

  HiddenBones() : rigWeights_(tube_.rest.size(), onTwo(0, 0, 0)) {
    for (std::size_t f = 0; f < kFrames; ++f) {
      const double t = 2 * kPi * static_cast<double>(f) / kFrames;
      std::vector<Transform> pose{turnAbout(Vec3::Zero(), {0, 1, 0}, 0.4 * std::sin(t))};
      rig_.push_back(pose);
      pose.push_back(pose[0] * turnAbout({0, 0, 0.3}, {1, 0, 0}, 0.5 * std::sin(2 * t)));
      pose.push_back(pose[1] * turnAbout({0, 0, 0.6}, {0, 1, 0.3}, 0.6 * std::cos(t)));
      pose.push_back(pose[2] * turnAbout({0, 0, 0.8}, {0, 0, 1}, 0.9 * std::sin(t + 1)));
      hidden_.push_back(pose);
    }
    for (const Eigen::Vector3f& p : tube_.rest) {
      // Bone b holds from 0.25 b on; the change takes 0.1 m.
      const float along = std::clamp((p.z() - 0.2f) / 0.25f, 0.0f, 2.999f);
      const auto bone = static_cast<std::uint16_t>(along);
      const float share = std::clamp((along - static_cast<float>(bone)) * 2.5f, 0.0f, 1.0f);
      hiddenWeights_.push_back(onTwo(bone, static_cast<std::uint16_t>(bone + 1), share));
    }
    frames_ = skinnedFrames(tube_.rest, hiddenWeights_, hidden_);
  }

  SkinningDecomposition decompose(int helpers, int iterations = 12, int influences = 4) const {
    return decomposeSkinning(tube_.rest, tube_.triangles, rigWeights_, rig_, frames_,
                             {helpers, influences, iterations});
  }

  // What the decomposition plays, by its own words.
  std::vector<std::vector<Transform>> allBones(const SkinningDecomposition& found) const {
    std::vector<std::vector<Transform>> bones = rig_;
    for (std::size_t f = 0; f < bones.size(); ++f) {
      for (const SkinningDecomposition::Helper& helper : found.helpers) {
        bones[f].push_back(helper.world[f]);
      }
    }
    return bones;
  }

  Tube tube_;
  std::vector<PointWeights> rigWeights_, hiddenWeights_;
  std::vector<std::vector<Transform>> rig_, hidden_;
  PointFrames frames_;
};

TEST_F(HiddenBones, AreRecovered) {
  const SkinningDecomposition found = decompose(3, 200);
  EXPECT_EQ(found.helpers.size(), 3u);
  EXPECT_LT(found.rms_m, 1e-5);
  EXPECT_LT(found.max_m, 1e-4);
}

TEST_F(HiddenBones, ReportsTheErrorOfWhatItReturns) {
  const SkinningDecomposition found = decompose(2, 3);
  const PointFrames played = skinnedFrames(tube_.rest, found.weights, allBones(found));
  double sum = 0, largest = 0;
  for (std::size_t f = 0; f < kFrames; ++f) {
    for (std::size_t i = 0; i < tube_.rest.size(); ++i) {
      const auto error = static_cast<double>((played[f][i] - frames_[f][i]).norm());
      sum += error * error;
      largest = std::max(largest, error);
    }
  }
  const double rms = std::sqrt(sum / static_cast<double>(kFrames * tube_.rest.size()));
  EXPECT_GT(rms, 1e-3);  // two bones are not enough
  EXPECT_NEAR(found.rms_m, rms, 1e-6);
  EXPECT_NEAR(found.max_m, largest, 1e-6);
}

TEST_F(HiddenBones, MoreHelpersLeaveLessError) {
  double before = 1;
  for (const int helpers : {0, 1, 2, 3, 6}) {
    const SkinningDecomposition found = decompose(helpers);
    EXPECT_LT(found.rms_m, 1.02 * before + 1e-6) << helpers;
    before = found.rms_m;
  }
  EXPECT_LT(before, 1e-3);
}

TEST_F(HiddenBones, WeightsAreConvexAndFew) {
  for (const int influences : {2, 4, 8}) {
    const SkinningDecomposition found = decompose(5, 3, influences);
    const std::size_t bones = 1 + found.helpers.size();
    for (const PointWeights& w : found.weights) {
      float sum = 0;
      int used = 0;
      for (std::size_t k = 0; k < PointWeights::kMost; ++k) {
        EXPECT_GE(w.weight[k], 0.0f);
        EXPECT_LT(w.joint[k], bones);
        sum += w.weight[k];
        used += w.weight[k] > 0 ? 1 : 0;
        EXPECT_LE(w.weight[k], w.weight[k > 0 ? k - 1 : 0]);
      }
      EXPECT_NEAR(sum, 1, 1e-6);
      EXPECT_LE(used, influences);
    }
  }
}

TEST_F(HiddenBones, HelpersMoveRigidly) {
  for (const SkinningDecomposition::Helper& helper : decompose(4).helpers) {
    EXPECT_EQ(helper.parent, 0);
    EXPECT_EQ(helper.world.size(), kFrames);
    for (const Transform& t : helper.world) {
      EXPECT_LT((t.rotation * t.rotation.transpose() - Mat3::Identity()).norm(), 1e-12);
      EXPECT_GT(t.rotation.determinant(), 0);
    }
  }
}

TEST_F(HiddenBones, MoreHelpersComeUntilTheErrorIsLowEnough) {
  DecompositionOptions options;
  options.helperBones = 1;
  options.mostHelpers = 20;
  options.tolerance_m = 2e-3;
  const SkinningDecomposition found =
      decomposeSkinning(tube_.rest, tube_.triangles, rigWeights_, rig_, frames_, options);
  EXPECT_GT(decompose(1).rms_m, options.tolerance_m);
  EXPECT_LE(found.rms_m, options.tolerance_m);
  EXPECT_GT(found.helpers.size(), 1u);
}

TEST_F(HiddenBones, NoMoreHelpersComeThanAllowed) {
  DecompositionOptions options;
  options.helperBones = 1;
  options.mostHelpers = 2;
  options.tolerance_m = 1e-4;
  const SkinningDecomposition found =
      decomposeSkinning(tube_.rest, tube_.triangles, rigWeights_, rig_, frames_, options);
  EXPECT_GT(found.rms_m, options.tolerance_m);
  EXPECT_EQ(found.helpers.size(), 2u);
}

TEST_F(HiddenBones, ProgressNeverGoesBack) {
  std::vector<double> told;
  DecompositionOptions options;
  options.helperBones = 2;
  options.mostHelpers = 12;
  options.tolerance_m = 1e-3;
  options.progress = [&](double share) { told.push_back(share); };
  decomposeSkinning(tube_.rest, tube_.triangles, rigWeights_, rig_, frames_, options);
  ASSERT_GT(told.size(), 4u);
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  EXPECT_GT(told.front(), 0);
  EXPECT_LE(told.back(), 1);
}

// Nothing is looked for where the rig's own weights do it, not even fewer influences.
TEST_F(HiddenBones, PlainSkinningIsLeftAlone) {
  frames_ = skinnedFrames(tube_.rest, rigWeights_, rig_);
  const SkinningDecomposition found = decompose(6);
  EXPECT_TRUE(found.plain);
  EXPECT_TRUE(found.helpers.empty());
  EXPECT_LT(found.max_m, 1e-6);
  for (std::size_t i = 0; i < found.weights.size(); ++i) {
    EXPECT_EQ(found.weights[i].joint, rigWeights_[i].joint);
    EXPECT_EQ(found.weights[i].weight, rigWeights_[i].weight);
  }
  EXPECT_FALSE([&] {
    frames_[3][7].x() += 0.01f;
    return decompose(1).plain;
  }());
}

TEST_F(HiddenBones, RestOfAMotionFollowsTheSameHelpers) {
  const SkinningDecomposition found = decompose(6);
  const std::vector<std::vector<Transform>> tracks = fitHelpers(tube_.rest, found, rig_, frames_);
  std::vector<std::vector<Transform>> bones = rig_;
  for (std::size_t f = 0; f < bones.size(); ++f) {
    for (const std::vector<Transform>& track : tracks) bones[f].push_back(track[f]);
  }
  const PointFrames played = skinnedFrames(tube_.rest, found.weights, bones);
  double sum = 0;
  for (std::size_t f = 0; f < kFrames; ++f) {
    for (std::size_t i = 0; i < tube_.rest.size(); ++i) {
      sum += (played[f][i] - frames_[f][i]).cast<double>().squaredNorm();
    }
  }
  // From parents at rest it takes more sweeps than from a neighbouring frame, and ends as near.
  const double rms = std::sqrt(sum / static_cast<double>(kFrames * tube_.rest.size()));
  EXPECT_LT(rms, 2 * found.rms_m + 1e-4);
  EXPECT_GT(restingError_m(tube_.rest, found, rig_, frames_), 10 * rms);
}

// Two joints that hardly bend while the surface bulges beside the joint: without the kept poses,
// weights near it could be anything.
TEST(KeptPoses, StayAsTheRigHasThem) {
  const Tube tube;
  std::vector<PointWeights> weights;
  for (const Eigen::Vector3f& p : tube.rest) {
    weights.push_back(onTwo(0, 1, std::clamp(5 * p.z() - 2, 0.0f, 1.0f)));
  }
  BoneFrames bones, kept;
  for (int f = 0; f < 20; ++f) {
    const double t = 2 * kPi * f / 20;
    bones.push_back({Transform{}, turnAbout({0, 0, 0.5}, {1, 0, 0}, 0.3 * std::sin(t))});
    kept.push_back({Transform{}, turnAbout({0, 0, 0.5}, {0, 1, 0}, 1.2 * std::sin(t))});
  }
  PointFrames frames = plainSkinning(tube.rest, weights, bones);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const auto s = static_cast<float>(0.02 * std::sin(0.6 * static_cast<double>(f)));
    for (std::size_t i = 0; i < tube.rest.size(); ++i) {
      if (tube.rest[i].z() > 0.3f && tube.rest[i].z() < 0.7f) frames[f][i] *= 1 + s;
    }
  }
  DecompositionOptions options;
  options.helperBones = 6;
  options.kept = kept;
  const SkinningDecomposition found =
      decomposeSkinning(tube.rest, tube.triangles, weights, bones, frames, options);
  ASSERT_FALSE(found.helpers.empty());
  const PointFrames wanted = plainSkinning(tube.rest, weights, kept);
  const std::vector<std::vector<Transform>> tracks = fitHelpers(tube.rest, found, kept, wanted);
  BoneFrames all = kept;
  for (std::size_t f = 0; f < all.size(); ++f) {
    for (const std::vector<Transform>& track : tracks) all[f].push_back(track[f]);
  }
  const PointFrames played = plainSkinning(tube.rest, found.weights, all);
  double largest = 0;
  for (std::size_t f = 0; f < all.size(); ++f) {
    for (std::size_t i = 0; i < tube.rest.size(); ++i) {
      largest = std::max(largest, static_cast<double>((played[f][i] - wanted[f][i]).norm()));
    }
  }
  EXPECT_GT(largest, 0);
  EXPECT_LT(largest, 0.02);  // of 1 m
}

TEST_F(HiddenBones, RestStaysAtRest) {
  frames_.assign(4, tube_.rest);
  rig_.assign(4, {Transform{}});
  const SkinningDecomposition found = decompose(6);
  EXPECT_LT(found.max_m, 1e-7);
  EXPECT_TRUE(found.helpers.empty());  // nothing to help with
}

TEST_F(HiddenBones, SameBitsOnAnyNumberOfThreads) {
  const SkinningDecomposition two = [&] {
    const ThreadLimit limit(2);
    return decompose(4, 3);
  }();
  const ThreadLimit limit(1);
  const SkinningDecomposition one = decompose(4, 3);
  EXPECT_EQ(one.rms_m, two.rms_m);
  for (std::size_t i = 0; i < one.weights.size(); ++i) {
    EXPECT_EQ(one.weights[i].joint, two.weights[i].joint);
    EXPECT_EQ(one.weights[i].weight, two.weights[i].weight);
  }
}

TEST_F(HiddenBones, BadInputIsRefused) {
  PointFrames frames = frames_;
  frames[3].pop_back();
  EXPECT_THROW(decomposeSkinning(tube_.rest, tube_.triangles, rigWeights_, rig_, frames, {}),
               Error);
  frames = frames_;
  frames[5][7].x() = std::nanf("");
  EXPECT_THROW(decomposeSkinning(tube_.rest, tube_.triangles, rigWeights_, rig_, frames, {}),
               Error);
  EXPECT_THROW(decompose(513), Error);
  DecompositionOptions options;
  options.motionFrames = {kFrames - 1};
  EXPECT_THROW(decomposeSkinning(tube_.rest, tube_.triangles, rigWeights_, rig_, frames_, options),
               Error);
  options.motionFrames = {};
  options.kept = {{}};
  EXPECT_THROW(decomposeSkinning(tube_.rest, tube_.triangles, rigWeights_, rig_, frames_, options),
               Error);
  EXPECT_THROW(decompose(4, 3, 9), Error);
}

}  // namespace
}  // namespace fascia
