#include <fascia/baking/close_cycle.h>

#include <gtest/gtest.h>

#include "baking/tube.h"

namespace fascia {
namespace {

// A tube that turns round once and walks on, whose points have strayed by the end.
class OpenCycle : public ::testing::Test {
 protected:
  static constexpr std::size_t kLast = 20;
  const Vec3 travel_ = Vec3(0.3, 0, 1.5);

  OpenCycle() : carrier_(tube_.rest.size(), 0) {
    for (std::size_t f = 0; f <= kLast; ++f) {
      const double t = static_cast<double>(f) / kLast;
      bones_.push_back({turnAbout(Vec3::Zero(), {0, 1, 0}, 2 * kPi * t)});
      std::vector<Eigen::Vector3f>& frame = frames_.emplace_back();
      for (const Eigen::Vector3f& p : tube_.rest) {
        const Vec3 strayed = p.cast<double>() + 0.01 * t * Vec3(p.z(), 1, 0);
        frame.push_back((bones_[f][0].point(strayed) + t * travel_).cast<float>());
      }
    }
  }

  Tube tube_;
  BoneFrames bones_;
  PointFrames frames_;
  std::vector<std::uint32_t> carrier_;
};

TEST_F(OpenCycle, EndsMeetAfterTheTravel) {
  const double gap = closeCycle(frames_, bones_, carrier_, travel_);
  EXPECT_NEAR(gap, 0.01 * std::sqrt(2.0), 1e-5);
  for (std::size_t i = 0; i < tube_.rest.size(); ++i) {
    EXPECT_LT((frames_[kLast][i] - frames_[0][i] - travel_.cast<float>()).norm(), 1e-6f);
  }
}

TEST_F(OpenCycle, TheFirstHalfStays) {
  const PointFrames before = frames_;
  closeCycle(frames_, bones_, carrier_, travel_);
  for (std::size_t f = 0; f <= kLast / 2; ++f) EXPECT_EQ(frames_[f], before[f]) << f;
  EXPECT_NE(frames_[kLast - 2], before[kLast - 2]);
}

// What strays with a joint comes back with it: seen from the joint it never moves sideways.
TEST_F(OpenCycle, TheDifferenceTurnsWithTheJoint) {
  closeCycle(frames_, bones_, carrier_, travel_);
  for (std::size_t f = 0; f <= kLast; ++f) {
    const double t = static_cast<double>(f) / kLast;
    for (std::size_t i = 0; i < tube_.rest.size(); ++i) {
      const Vec3 local = bones_[f][0].inverse().point(frames_[f][i].cast<double>() - t * travel_);
      const Vec3 off = local - tube_.rest[i].cast<double>();
      EXPECT_NEAR(off.z(), 0, 1e-6);
      EXPECT_NEAR(off.x(), off.y() * static_cast<double>(tube_.rest[i].z()), 1e-6);
    }
  }
}

// No step is longer than the blending itself makes it.
TEST_F(OpenCycle, NothingJumps) {
  const PointFrames before = frames_;
  closeCycle(frames_, bones_, carrier_, travel_);
  for (std::size_t f = 1; f <= kLast; ++f) {
    for (std::size_t i = 0; i < tube_.rest.size(); ++i) {
      const float was = (before[f][i] - before[f - 1][i]).norm();
      const float is = (frames_[f][i] - frames_[f - 1][i]).norm();
      EXPECT_LT(std::abs(is - was), 0.0142f / 4) << f;
    }
  }
}

}  // namespace
}  // namespace fascia
