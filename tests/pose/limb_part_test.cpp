#include <gtest/gtest.h>

#include "limb.h"

namespace fascia {
namespace {

using Eigen::Vector3f;

std::vector<Vector3f> cylinder(float radius, float length) {
  std::vector<Vector3f> points;
  for (int i = 0; i <= 20; ++i)
    for (int j = 0; j < 24; ++j) {
      const float a = static_cast<float>(2 * kPi) * static_cast<float>(j) / 24;
      points.push_back(
          {length * static_cast<float>(i) / 20, radius * std::cos(a), radius * std::sin(a)});
    }
  return points;
}

TEST(LimbPart, OfACylinderIsItsDistance) {
  const auto skin = cylinder(0.1f, 1);
  const LimbPart part(skin, Vector3f(0, 0, 0), Vector3f(1, 0, 0));
  ASSERT_TRUE(part.exists());
  EXPECT_NEAR(part.meanRadius_m(), 0.1f, 1e-4f);
  EXPECT_LT(part.residual(skin), 1e-3f);
  Vector3f away;
  EXPECT_NEAR(part.distance({0.5f, 0.3f, 0}, away), 0.2f, 1e-3f);
  EXPECT_LT((away - Vector3f(0, 1, 0)).norm(), 1e-5f);
  EXPECT_NEAR(part.distance({0.5f, 0.02f, 0.02f}), 0.0283f - 0.1f, 1e-3f);
  EXPECT_NEAR(part.distance({1.3f, 0, 0}), 0.2f, 5e-3f);  // half sphere beyond the end
}

TEST(LimbPart, FollowsAnOvalSection) {
  std::vector<Vector3f> skin = cylinder(0.1f, 1);
  for (Vector3f& p : skin) p.z() *= 1.5f;
  const LimbPart part(skin, Vector3f(0, 0, 0), Vector3f(1, 0, 0));
  EXPECT_LT(part.residual(skin), 0.02f);
  EXPECT_NEAR(part.distance({0.5f, 0, 0.2f}), 0.05f, 0.005f);
  EXPECT_NEAR(part.distance({0.5f, 0.2f, 0}), 0.1f, 0.005f);
}

// The linings of clothes and teeth must not make a body thinner.
TEST(LimbPart, DoesNotSeeWhatLiesDeepInside) {
  auto skin = cylinder(0.1f, 1);
  const auto inner = cylinder(0.02f, 1);
  skin.insert(skin.end(), inner.begin(), inner.begin() + 200);
  const LimbPart part(skin, Vector3f(0, 0, 0), Vector3f(1, 0, 0));
  EXPECT_NEAR(part.distance({0.5f, 0.1f, 0}), 0, 2e-3f);
}

TEST(LimbPart, IsSureOfItselfOnlyWhereItHasSkin) {
  const auto all = cylinder(0.1f, 1);
  const std::vector<Vector3f> half(all.begin(), all.begin() + 11 * 24);
  const LimbPart part(half, Vector3f(0, 0, 0), Vector3f(1, 0, 0));
  EXPECT_NEAR(part.confidence({0.2f, 0.1f, 0}), 1, 1e-6f);
  EXPECT_NEAR(part.confidence({0.95f, 0.1f, 0}), 0, 1e-6f);
}

TEST(LimbPart, OfNothingDoesNotExist) {
  EXPECT_FALSE(LimbPart().exists());
  EXPECT_FALSE(LimbPart({}, Vector3f(0, 0, 0), Vector3f(1, 0, 0)).exists());
}

}  // namespace
}  // namespace fascia
