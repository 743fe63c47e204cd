#include <fascia/skin/contact/fat_pressure.h>

#include <cmath>

#include <gtest/gtest.h>

#include <fascia/base/random.h>
#include <fascia/math/types.h>

#include "grids.h"

namespace fascia {
namespace {

using test::at;
using test::put;

constexpr double kBall_m = 0.1, kFat_m = 0.01, kBallDensity_kg_per_m2 = 4;
constexpr double kFrame_s = 1.0 / 60;
constexpr int kStepsOfFrame = 8;

// A round skin over one solid: points on strands, held together by their fat alone.
struct Ball {
  static constexpr std::size_t kAround = 16, kRings = 11, kCount = 2 + kRings * kAround;
  std::vector<TriangleMembrane::Corners> triangles;
  VectorArray rest{kCount}, anchor{kCount}, position, velocity{kCount};
  PointModel points;
  StepCoefficients step;
  PointSurroundings around;
  FatPressureModel model;
  double tissue_N_per_m3, drag_per_s;

  Ball(double bulk_Pa, double tissue, double drag) : tissue_N_per_m3(tissue), drag_per_s(drag) {
    for (std::size_t k = 0; k < kCount; ++k) put(rest, k, kBall_m * direction(k));
    for (std::uint32_t j = 0; j < kAround; ++j) {
      triangles.push_back({0, ring(0, j), ring(0, j + 1)});
      triangles.push_back({1, ring(kRings - 1, j + 1), ring(kRings - 1, j)});
      for (std::uint32_t i = 0; i + 1 < kRings; ++i) {
        triangles.push_back({ring(i, j), ring(i + 1, j), ring(i, j + 1)});
        triangles.push_back({ring(i, j + 1), ring(i + 1, j), ring(i + 1, j + 1)});
      }
    }
    for (std::size_t k = 0; k < kCount; ++k)
      put(anchor, k, at(rest, k) + Vec3(0, 0.002, 0));  // as a strand that carries weight has it
    // Every point has the same share of the surface: what it weighs does not matter here.
    const double area = 4 * kPi * kBall_m * kBall_m / kCount;
    points.mass.assign(kCount, static_cast<float>(kBallDensity_kg_per_m2 * area));
    points.tissueStiffness.assign(kCount, static_cast<float>(tissue * area));
    points.free.assign(kCount, 1.f);
    step.step_s = static_cast<float>(kFrame_s / kStepsOfFrame);
    step.gain.assign(kCount, step.step_s / points.mass[0]);
    around.resize(kCount);
    around.anchor = anchor;
    position = rest;
    const FloatArray fat(kCount, static_cast<float>(kFat_m));
    const std::vector<SolidId> solid(kCount, SolidId(0));
    model = prepareFatPressure({bulk_Pa, triangles, rest, anchor, fat, solid, points});
  }
  static std::uint32_t ring(std::size_t i, std::size_t j) {
    return static_cast<std::uint32_t>(2 + i * kAround + j % kAround);
  }
  static Vec3 direction(std::size_t k) {
    if (k < 2) return Vec3(0, 0, k == 0 ? 1 : -1);
    const double b = kPi * static_cast<double>((k - 2) / kAround + 1) / (kRings + 1);
    const double a = 2 * kPi * static_cast<double>((k - 2) % kAround) / kAround;
    return {std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b)};
  }
  // Outward from rest.
  double height_m(std::size_t k) const { return (at(position, k) - at(rest, k)).dot(direction(k)); }
  double volume_m3() const {
    double six = 0;
    for (const auto& [a, b, c] : triangles)
      six += at(position, a).dot(at(position, b).cross(at(position, c)));
    return six / 6;
  }
  const VectorArray& press(FatPressure& fat) {
    return fat.press(step, around, kFrame_s, position, velocity);
  }
  // `hold` puts points where they are held, after every step.
  template <class Hold>
  void interval(FatPressure* fat, const Hold& hold) {
    const VectorArray none(kCount);
    const VectorArray& force = fat ? press(*fat) : none;
    const double h = double{step.step_s}, keep = std::exp(-h * drag_per_s);
    for (int s = 0; s < kStepsOfFrame; ++s) {
      for (std::size_t k = 0; k < kCount; ++k) {
        const Vec3 strand = at(position, k) - at(rest, k);
        const double stiffness = double{points.tissueStiffness[k]};
        const Vec3 f = at(force, k) - stiffness * strand;
        put(velocity, k, keep * at(velocity, k) + double{step.gain[k]} * f);
        put(position, k, at(position, k) + h * at(velocity, k));
      }
      hold();
    }
  }
};

TEST(FatPressure, LeavesRestAloneBitForBit) {
  Ball ball(1e5, 4000, 0);
  ASSERT_EQ(ball.model.layers.size(), 1u);
  const double surface = 4 * kPi * kBall_m * kBall_m;
  EXPECT_NEAR(ball.model.layers[0].volume_m3, surface * kFat_m, 0.05 * surface * kFat_m);
  FatPressure fat(ball.model, Ball::kCount);
  const VectorArray& force = ball.press(fat);
  for (std::size_t k = 0; k < Ball::kCount; ++k) EXPECT_EQ(at(force, k).norm(), 0) << k;
  // And a body that moves as a whole.
  ball.velocity.fill(3.f), ball.around.anchorVelocity.fill(3.f);
  EXPECT_EQ(at(ball.press(fat), 5).norm(), 0);
  ball.velocity.fill(0.f);
  put(ball.position, 5, 1.01 * at(ball.rest, 5));
  EXPECT_GT(at(ball.press(fat), 5).norm(), 0);
}

// All points from rest to s times rest: Σ N·(r − rest) = s² (s − 1) 3 V, V the ball's volume.
TEST(FatPressure, IsTheBulkModulusTimesTheChangeOfVolume) {
  constexpr double kBulk_Pa = 1e-3, kScale = 1.02;  // so soft that one interval moves nothing
  Ball ball(kBulk_Pa, 0, 0);
  ball.around.anchor = ball.rest;
  const double solid_m3 = ball.volume_m3();
  for (std::size_t k = 0; k < Ball::kCount; ++k) put(ball.position, k, kScale * at(ball.rest, k));
  FatPressure fat(ball.model, Ball::kCount);
  ball.press(fat);
  const double change = kScale * kScale * (kScale - 1) * 3 * solid_m3;
  const double expected = -kBulk_Pa * change / ball.model.layers[0].volume_m3;
  EXPECT_NEAR(fat.pressures_Pa()[0] / expected, 1, 1e-3);
}

TEST(FatPressure, NeverExceedsItsBulkModulus) {
  Ball ball(100, 0, 0);
  FatPressure fat(ball.model, Ball::kCount);
  ball.velocity.fill(0.f);
  for (std::size_t k = 0; k < Ball::kCount; ++k) put(ball.position, k, 10 * at(ball.rest, k));
  ball.press(fat);
  EXPECT_LT(fat.pressures_Pa()[0], 0);
  EXPECT_GE(fat.pressures_Pa()[0], -100);
}

TEST(FatPressure, PushesAClosedBodyNowhere) {
  Ball ball(400, 4000, 0);
  FatPressure fat(ball.model, Ball::kCount);
  Random random(7);
  for (std::size_t k = 0; k < Ball::kCount; ++k)
    put(ball.position, k, (1 + random.uniform(-0.05, 0.02)) * at(ball.rest, k));
  const VectorArray& force = ball.press(fat);
  Vec3 sum = Vec3::Zero();
  double all = 0;
  for (std::size_t k = 0; k < Ball::kCount; ++k) sum += at(force, k), all += at(force, k).norm();
  EXPECT_GT(all, 0.1);
  EXPECT_LT(sum.norm(), 1e-5 * all);
}

// A dent of 5 mm on one side, held until everything has come to rest.
TEST(FatPressure, SwellsWhereNothingPressesAndKeepsMostOfTheVolume) {
  double lost_m3[2], swollen_m[2];
  for (const bool pressed : {false, true}) {
    Ball ball(400, 4000, 20);
    const double before = ball.volume_m3();
    FatPressure fat(ball.model, Ball::kCount);
    const auto dent = [&] {
      for (std::size_t k = 0; k < Ball::kCount; ++k) {
        if (Ball::direction(k).z() < 0.6) continue;
        put(ball.position, k, at(ball.rest, k) - Vec3(0, 0, 0.005));
        put(ball.velocity, k, Vec3::Zero());
      }
    };
    dent();
    for (int i = 0; i < 120; ++i) ball.interval(pressed ? &fat : nullptr, dent);
    lost_m3[pressed] = before - ball.volume_m3();
    swollen_m[pressed] = ball.height_m(1);
  }
  EXPECT_GT(lost_m3[0], 0);
  EXPECT_LT(std::abs(lost_m3[1]), 0.5 * lost_m3[0]);
  EXPECT_NEAR(swollen_m[0], 0, 1e-6);
  EXPECT_GT(swollen_m[1], 3e-4);
}

// Ten seconds without any damping, on soft and on firm strands.
TEST(FatPressure, IsStableForEveryBulkModulus) {
  for (const double bulk_Pa : {60.0, 1e3, 1e5}) {
    for (const double tissue : {400.0, 16000.0, 60000.0}) {
      Ball ball(bulk_Pa, tissue, 0);
      FatPressure fat(ball.model, Ball::kCount);
      // What the kick would do to a strand alone.
      const double kick = 0.05, swing_m = kick / std::sqrt(tissue / kBallDensity_kg_per_m2);
      Random random(11);
      for (std::size_t k = 0; k < Ball::kCount; ++k)
        put(ball.velocity, k, kick * (0.5 + 0.5 * random.uniform(-1, 1)) * Ball::direction(k));
      double largest_m = 0;
      for (int i = 0; i < 600; ++i) {
        ball.interval(&fat, [] {});
        for (std::size_t k = 0; k < Ball::kCount; ++k) {
          const double away_m = (at(ball.position, k) - at(ball.rest, k)).norm();
          ASSERT_TRUE(std::isfinite(away_m));
          largest_m = std::max(largest_m, away_m);
        }
      }
      EXPECT_LT(largest_m, 2 * swing_m) << bulk_Pa << " Pa, " << tissue << " N/m3";
    }
  }
}

TEST(FatPressure, IsMadeOfFreePointsWithFatOnly) {
  const Ball ball(60, 4000, 0);
  FloatArray fat(Ball::kCount, 0.01f);
  std::vector<SolidId> solid(Ball::kCount, SolidId(3));
  PointModel points = ball.points;
  fat[7] = 0, solid[8] = SolidId(), points.free[9] = 0, solid[10] = SolidId(1);
  const FatPressureModel model =
      prepareFatPressure({60, ball.triangles, ball.rest, ball.anchor, fat, solid, points});
  ASSERT_EQ(model.layers.size(), 2u);
  EXPECT_EQ(model.points[0], 10u);
  EXPECT_EQ(model.layers[1].count, Ball::kCount - 4);
  fat.assign(Ball::kCount, 0.f);
  EXPECT_TRUE(prepareFatPressure({60, ball.triangles, ball.rest, ball.anchor, fat, solid, points})
                  .layers.empty());
}

TEST(FatPressure, KeepsItsMemory) {
  Ball ball(60, 4000, 0);
  FatPressure fat(ball.model, Ball::kCount);
  const float* first = ball.press(fat).x.data();
  for (int i = 0; i < 3; ++i) EXPECT_EQ(ball.press(fat).x.data(), first);
}

}  // namespace
}  // namespace fascia
