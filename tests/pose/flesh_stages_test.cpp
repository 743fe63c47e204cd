// Volume, muscles, jiggle, dents: the stages that displace what the pose alone gives.
#include <gtest/gtest.h>

#include <cstring>

#include <fascia/pose/skin_spread.h>
#include <fascia/pose/softness.h>

#include "limb.h"

namespace fascia {
namespace {

using test::Evaluation;
using test::farthest;
using test::Limb;
using test::posed;
using Points = std::vector<Eigen::Vector3f>;

struct Prepared {
  Limb limb;
  PoseMesh mesh = makePoseMesh(limb.source());
  LimbParts parts = makeLimbParts(limb.source(), mesh);
};

TEST(SkinSpread, KeepsTheVolumeAndLeavesNoPeak) {
  const Prepared p;
  std::vector<float> values(p.mesh.size(), 0.f);
  values[p.mesh.size() / 2] = 1;
  SupernodalCholesky::Scratch scratch;
  SkinSpread(p.mesh, p.parts).spread(values, scratch);
  double volume = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    volume += double{values[i]} * double{p.mesh.area_m2[i]};
  EXPECT_NEAR(volume, 1, 1e-3);
  // A single point's share of its own amount: spread over about the limb's radius squared.
  EXPECT_LT(values[p.mesh.size() / 2] * p.mesh.area_m2[p.mesh.size() / 2], 0.2f);
}

// Mean distance from the axis of the upper arm's belly on the side of +y or -y.
double belly(const Limb& limb, const Points& points, double side) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f& rest = limb.points[i];
    if (rest.x() < 0.12f || rest.x() > 0.18f || side * rest.y() < 0.04) continue;
    sum += side * points[i].y();
    ++count;
  }
  return sum / count;
}

TEST(MuscleSwell, FlexorsSwellAndExtensorsThin) {
  const Limb limb;
  const auto bent = limb.turned(kPi / 2);  // towards +y
  const Points without = posed(limb.skin(limb.dials(0, 0, 0)), bent);
  const Points natural = posed(limb.skin(limb.dials(0, 0.3f, 0)), bent);
  const Points builder = posed(limb.skin(limb.dials(0, 1, 0)), bent);
  const auto gain = [&](const Points& points, double side) {
    return belly(limb, points, side) - belly(limb, without, side);
  };
  EXPECT_GT(gain(natural, 1), 0.01 * Limb::kRadius_m);
  EXPECT_LT(gain(natural, -1), 0);
  EXPECT_GT(gain(builder, 1), 2 * gain(natural, 1));
  EXPECT_LT(gain(builder, 1), 0.35 * Limb::kRadius_m);
}

TEST(MuscleSwell, IsNothingInTheRestPose) {
  const Limb limb;
  EXPECT_LT(farthest(posed(limb.skin(limb.dials(0, 1, 1)), limb.turned(0)), limb.points), 1e-6f);
}

// What a bend takes from the inside comes out there, where flesh is, not over the bone outside.
TEST(JointVolume, ComesOutOnTheInnerSideOfTheBend) {
  const Limb limb;
  const auto bent = limb.turned(kPi / 2);  // towards +y
  const Points without = posed(limb.skin(limb.dials(0, 0, 0)), bent);
  const Points with = posed(limb.skin(limb.dials(0, 0, 1)), bent);
  double moved[2] = {0, 0}, count[2] = {0, 0};
  for (std::size_t i = 0; i < with.size(); ++i) {
    const Eigen::Vector3f& rest = limb.points[i];
    if (rest.x() < 0.2f || rest.x() > 0.26f || std::abs(rest.y()) < 0.04f) continue;
    const int side = rest.y() > 0 ? 0 : 1;
    moved[side] += double{(with[i] - without[i]).norm()};
    ++count[side];
  }
  EXPECT_GT(moved[0] / count[0], 1e-4);
  EXPECT_GT(moved[0] / count[0], 1.5 * moved[1] / count[1]);
}

std::vector<float> dialOf(const Prepared& p, float value) {
  return std::vector<float>(p.mesh.size(), value);
}

FrameArray restFrame(const Prepared& p, const Vec3& shift = Vec3::Zero()) {
  FrameArray frame;
  for (const Eigen::Vector3f& x : p.mesh.rest) frame.push_back(wide(x + shift.cast<float>()));
  return frame;
}

// A body in free fall: d̈ + 2ζω ḋ + ω² d = -a settles at -a / ω², at any frame rate.
TEST(Jiggle, LagsByAccelerationOverFrequencySquared) {
  const Prepared p;
  const Jiggle jiggle(p.limb.source(), p.mesh, p.parts, dialOf(p, 0.5f));
  ASSERT_GT(jiggle.nodeCount(), 0u);
  const double a = 2;
  std::vector<float> settled;
  for (const double rate_hz : {60.0, 240.0}) {
    JiggleState state;
    for (int f = 0; f <= 2 * rate_hz; ++f) {
      const double t = f / rate_hz;
      jiggle.step(1 / rate_hz, restFrame(p), Vec3(0, 0.5 * a * t * t, 0), state);
    }
    settled.push_back(state.offset[0].y());
  }
  EXPECT_LT(settled[0], -1e-4f);
  EXPECT_NEAR(settled[0], settled[1], 0.02f * std::abs(settled[0]));
}

TEST(Jiggle, DiesAwayAndStaysWithinItsLimit) {
  const Prepared p;
  const Jiggle jiggle(p.limb.source(), p.mesh, p.parts, dialOf(p, 1));
  JiggleState state;
  FrameArray shown, moved = restFrame(p);
  const FrameArray rest = restFrame(p);
  float most = 0;
  for (int f = 0; f < 300; ++f) {
    // A second of violent shaking, then rest.
    const double shake = f < 60 ? 0.3 * std::sin(f * 1.3) : 0;
    jiggle.step(1.0 / 60, rest, Vec3(0, shake, 0), state);
    moved = rest;
    jiggle.add(state, shown, moved);
    for (std::size_t i = 0; i < moved.size(); ++i) {
      ASSERT_TRUE(moved[i].allFinite());
      most = std::max(most, (moved[i] - rest[i]).norm());
    }
  }
  EXPECT_GT(most, 0.05f * static_cast<float>(Limb::kRadius_m));
  EXPECT_LT(most, 0.5f * static_cast<float>(Limb::kRadius_m));
  for (std::size_t i = 0; i < moved.size(); ++i) EXPECT_LT((moved[i] - rest[i]).norm(), 1e-4f);
}

TEST(Jiggle, ACopiedStateGoesOnBitForBit) {
  const Limb limb;
  const PoseSkin skin = limb.skin();
  Evaluation original;
  JiggleState state;
  const auto at = [&](int f) { return limb.turned(1 + std::sin(0.4 * f)); };
  for (int f = 0; f < 7; ++f) original(skin, at(f), {1.0 / 60, &state, nullptr});
  JiggleState copy = state;
  Evaluation fresh;
  for (int f = 7; f < 20; ++f) {
    const Points a = original(skin, at(f), {1.0 / 60, &state, nullptr});
    const Points b = fresh(skin, at(f), {1.0 / 60, &copy, nullptr});
    ASSERT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]), 0) << f;
  }
}

TEST(Softness, HandsAndPiecesOfOneJointAreHard) {
  Prepared p;
  p.limb.joints[1].name = "hand";
  const auto soft = softnessOf(p.limb.source(), p.mesh, p.parts);
  double upper = 0, hand = 0;
  for (std::size_t i = 0; i < soft.size(); ++i) {
    if (p.limb.points[i].x() < 0.2f) upper = std::max<double>(upper, soft[i]);
    if (p.limb.points[i].x() > 0.5f) hand = std::max<double>(hand, soft[i]);
  }
  EXPECT_GT(upper, 0.5);
  EXPECT_EQ(hand, 0);
  for (PointWeights& w : p.limb.weights) w = {{0}, {1}};
  for (const float s : softnessOf(p.limb.source(), p.mesh, p.parts)) EXPECT_EQ(s, 0);
}

// One ball.
class Ball final : public Field {
 public:
  Ball(const Vec3& center, double radius) : center_(center), radius_(radius) {}
  std::size_t solidCount() const override { return 1; }
  Box bounds(SolidId) const override {
    return {center_ - Vec3::Constant(radius_), center_ + Vec3::Constant(radius_)};
  }
  void evaluate(SolidId, ConstVectors p, float* distance_m, Vectors normal) const override {
    for (std::size_t k = 0; k < p.count; ++k) {
      const Vec3 off = Vec3(p.x[k], p.y[k], p.z[k]) - center_;
      distance_m[k] = static_cast<float>(off.norm() - radius_);
      normal.x[k] = static_cast<float>(off.normalized().x());
      normal.y[k] = static_cast<float>(off.normalized().y());
      normal.z[k] = static_cast<float>(off.normalized().z());
    }
  }
  Transform frame(SolidId) const override { return {Mat3::Identity(), center_}; }
  const Outline& outline(SolidId) const override { return outline_; }
  void velocity(SolidId, ConstVectors, Vectors) const override {}
  Vec3 materialFromWorld(SolidId, const Vec3& world) const override { return world - center_; }
  Vec3 worldFromMaterial(SolidId, const Vec3& material) const override {
    return material + center_;
  }

 private:
  Vec3 center_;
  double radius_;
  Outline outline_{};
};

TEST(Dents, PropsPressTheSkinInAndItsSurroundingsFollow) {
  const Limb limb;
  const PoseSkin skin = limb.skin();
  const Ball ball(Vec3(0.15, 0.08, 0), 0.05);
  const PoseObstacles obstacles{&ball, 0};
  Evaluation evaluate;
  const auto motion = limb.turned(0);
  const Points plain = evaluate(skin, motion);
  const Points pressed = evaluate(skin, motion, {0, nullptr, &obstacles});
  double deepest = 0, around = 0;
  for (std::size_t i = 0; i < pressed.size(); ++i) {
    const Vec3 p = pressed[i].cast<double>();
    deepest = std::max(deepest, 0.05 - (p - Vec3(0.15, 0.08, 0)).norm());
    const double before = (plain[i].cast<double>() - Vec3(0.15, 0.08, 0)).norm();
    if (before > 0.052) around = std::max(around, double{(pressed[i] - plain[i]).norm()});
    if (before > 0.15) {
      EXPECT_EQ(pressed[i], plain[i]) << i;
    }
  }
  EXPECT_GT(farthest(plain, pressed), 0.015f);
  EXPECT_LT(deepest, 1e-6);
  EXPECT_GT(around, 0.001);
}

}  // namespace
}  // namespace fascia
