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
constexpr double kFatStep_s = 1.0 / 480;

// A round skin over one solid: points on strands, held together by their fat alone.
struct Ball {
  static constexpr std::size_t kAround = 16, kRings = 11, kCount = 2 + kRings * kAround;
  std::vector<TriangleMembrane::Corners> triangles;
  VectorArray rest{kCount}, anchor{kCount}, carried, carriedToEnd, position, velocity{kCount};
  PointModel points;
  StepCoefficients step;
  FatPressureModel model;
  double drag_per_s, interval_s;
  double load_Pa = 0;  // outward on every point, along its normal at rest

  Ball(double bulk_Pa, double tissue, double drag, double interval = 1.0 / 60)
      : drag_per_s(drag), interval_s(interval) {
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
    points.mass.assign(kCount, 0.f), points.tissueStiffness.assign(kCount, 0.f);
    points.free.assign(kCount, 1.f);
    step.step_s = static_cast<float>(std::min(kFatStep_s, interval_s));
    step.gain.assign(kCount, 0.f);
    for (std::size_t k = 0; k < kCount; ++k) {
      const double area = areaVector(rest, k).norm();
      points.mass[k] = static_cast<float>(kBallDensity_kg_per_m2 * area);
      points.tissueStiffness[k] = static_cast<float>(tissue * area);
      step.gain[k] = step.step_s / points.mass[k];
    }
    position = carried = carriedToEnd = rest;
    const FloatArray fat(kCount, static_cast<float>(kFat_m));
    const std::vector<SolidId> solid(kCount, SolidId(0));
    model = prepareFatPressure({bulk_Pa, triangles, rest, anchor, fat, solid, points, false});
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
  // A third of those of the triangles around.
  Vec3 areaVector(const VectorArray& r, std::size_t k) const {
    Vec3 sum = Vec3::Zero();
    for (const auto& [a, b, c] : triangles)
      if (a == k || b == k || c == k) sum += (at(r, b) - at(r, a)).cross(at(r, c) - at(r, a)) / 6;
    return sum;
  }
  // At the start of an interval.
  const VectorArray& press(FatPressure& fat) const {
    fat.begin(step, {carried, carriedToEnd, anchor, anchor, interval_s}, position);
    return fat.force();
  }
  // `hold` puts points where they are held, after every step.
  template <class Hold>
  void interval(FatPressure* fat, const Hold& hold) {
    const VectorArray none(kCount);
    const VectorArray& force = fat ? press(*fat) : none;
    std::vector<Vec3> load(kCount, Vec3::Zero());
    for (std::size_t k = 0; k < kCount && load_Pa != 0; ++k)
      load[k] = load_Pa * areaVector(rest, k);
    const double h = double{step.step_s}, keep = std::exp(-h * drag_per_s);
    const auto steps = static_cast<int>(std::lround(interval_s / h));
    for (int s = 1; s <= steps; ++s) {
      for (std::size_t k = 0; k < kCount; ++k) {
        const Vec3 strand = at(position, k) - at(rest, k);
        const double stiffness = double{points.tissueStiffness[k]};
        const Vec3 f = at(force, k) + load[k] - stiffness * strand;
        put(velocity, k, keep * at(velocity, k) + double{step.gain[k]} * f);
        put(position, k, at(position, k) + h * at(velocity, k));
      }
      hold();
      if (fat) fat->stepped(static_cast<float>(s * h), position, velocity);
    }
    hold();
  }
  void run(FatPressure& fat, double duration_s) {
    const auto intervals = std::lround(duration_s / interval_s);
    for (long i = 0; i < intervals; ++i) interval(&fat, [] {});
  }
  // Of motion, strands and fat.
  double energy_J(const FatPressure& fat) const {
    const double p = fat.pressures_Pa()[0];
    double sum = p * p * model.layers[0].volume_m3 / (2 * model.bulk_Pa);
    for (std::size_t k = 0; k < kCount; ++k)
      sum +=
          0.5 * double{points.mass[k]} * at(velocity, k).squaredNorm() +
          0.5 * double{points.tissueStiffness[k]} * (at(position, k) - at(rest, k)).squaredNorm();
    return sum;
  }
};

TEST(FatPressure, LeavesRestAloneBitForBit) {
  Ball ball(1e5, 4000, 0);
  ASSERT_EQ(ball.model.layers.size(), 1u);
  FatPressure fat(ball.model, Ball::kCount);
  const VectorArray& force = ball.press(fat);
  for (std::size_t k = 0; k < Ball::kCount; ++k) EXPECT_EQ(at(force, k).norm(), 0) << k;
  put(ball.position, 5, 1.01 * at(ball.rest, 5));
  EXPECT_GT(at(ball.press(fat), 5).norm(), 0);
}

// In steps of an interval in which its body turns by 7°, points on their way with it.
TEST(FatPressure, IsNoneInABodyThatTurnsUnderItsSkin) {
  for (const bool reachesAnchors : {false, true}) {
    Ball ball(4e4, 0, 0);
    ball.model.reachesAnchors = reachesAnchors;
    VectorArray anchorAtEnd(Ball::kCount);
    const Eigen::AngleAxisd turn(0.12, Vec3(0.6, 0, 0.8));
    for (std::size_t k = 0; k < Ball::kCount; ++k) {
      put(ball.anchor, k, 0.9 * at(ball.rest, k));
      put(anchorAtEnd, k, turn * at(ball.anchor, k));
      put(ball.carriedToEnd, k, turn * at(ball.rest, k));
      put(ball.velocity, k, (turn * at(ball.rest, k) - at(ball.rest, k)) / ball.interval_s);
    }
    if (reachesAnchors) ball.model.layers[0].rest_m3 = (1 - std::pow(0.9, 3)) * ball.volume_m3();
    FatPressure fat(ball.model, Ball::kCount);
    fat.begin(ball.step,
              {ball.carried, ball.carriedToEnd, ball.anchor, anchorAtEnd, ball.interval_s},
              ball.position);
    for (int s = 0; s <= 8; ++s) {
      EXPECT_NEAR(fat.pressures_Pa()[0], 0, 1) << s;
      if (s == 8) break;
      for (std::size_t k = 0; k < Ball::kCount; ++k)
        put(ball.position, k,
            at(ball.position, k) + double{ball.step.step_s} * at(ball.velocity, k));
      fat.stepped(static_cast<float>(s + 1) * ball.step.step_s, ball.position, ball.velocity);
    }
  }
}

// What lies between two spheres, as far as the mesh is one.
TEST(FatPressure, HasTheVolumeOfTheShellThatIsFat) {
  const Ball ball(60, 0, 0);
  const double inner = 1 - kFat_m / kBall_m, shell_m3 = ball.volume_m3() * (1 - std::pow(inner, 3));
  EXPECT_NEAR(ball.model.layers[0].volume_m3 / shell_m3, 1, 0.01);
}

// All points from rest to s times rest. The skin turns nowhere but becomes larger, by s² − 1: half
// of that is left out.
TEST(FatPressure, IsTheBulkModulusTimesTheChangeOfVolume) {
  for (const double bulk_Pa : {1.0, 1e5}) {
    for (const double scale : {0.98, 1.001, 1.02}) {
      Ball ball(bulk_Pa, 0, 0);
      for (std::size_t k = 0; k < Ball::kCount; ++k)
        put(ball.position, k, scale * at(ball.rest, k));
      FatPressure fat(ball.model, Ball::kCount);
      ball.press(fat);
      const double change = (std::pow(scale, 3) - 1) * ball.volume_m3() / std::pow(scale, 3);
      const double expected = -bulk_Pa * change / ball.model.layers[0].volume_m3;
      EXPECT_NEAR(fat.pressures_Pa()[0] / expected, 1, 2e-3 + 1.05 * std::abs(scale - 1)) << scale;
    }
  }
}

// A load q on every point, until it has come to rest: q + p = k u on strands that go out by u.
TEST(FatPressure, IsAtRestWhatItsModulusSaysAtEveryRate) {
  constexpr double kTissue = 4000;
  for (const double bulk_Pa : {1e3, 1e4, 4e4}) {
    for (const double share : {-0.03, 0.03}) {
      for (const double rate_per_s : {30.0, 60.0, 120.0, 240.0, 480.0}) {
        SCOPED_TRACE(testing::Message() << bulk_Pa << " Pa, " << rate_per_s << " Hz, " << share);
        Ball ball(bulk_Pa, kTissue, 20, 1 / rate_per_s);
        const double fat_m3 = ball.model.layers[0].volume_m3, inside_m3 = ball.volume_m3();
        const double u = kBall_m * (std::cbrt(1 + share * fat_m3 / inside_m3) - 1);
        ball.load_Pa = bulk_Pa * share + kTissue * u;
        FatPressure fat(ball.model, Ball::kCount);
        ball.run(fat, 1.5);
        EXPECT_NEAR(fat.pressures_Pa()[0] / (-bulk_Pa * share), 1, 0.01);
        EXPECT_NEAR((ball.volume_m3() - inside_m3) / (share * fat_m3), 1, 0.01);
        for (std::size_t k = 2; k < Ball::kCount; ++k)
          ASSERT_NEAR(ball.height_m(k) / u, 1, 0.02) << k;
        const double before = fat.pressures_Pa()[0];
        ball.run(fat, 1 / rate_per_s);
        EXPECT_NEAR(fat.pressures_Pa()[0] / before, 1, 1e-3);  // and stays there
      }
    }
  }
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

Ball kicked(double bulk_Pa, double tissue, double kick_m_per_s, double interval_s) {
  Ball ball(bulk_Pa, tissue, 0, interval_s);
  Random random(11);
  for (std::size_t k = 0; k < Ball::kCount; ++k)
    put(ball.velocity, k, kick_m_per_s * (0.5 + 0.5 * random.uniform(-1, 1)) * Ball::direction(k));
  return ball;
}

// Ten seconds without any damping, on soft and on firm strands.
TEST(FatPressure, IsStableForEveryBulkModulus) {
  for (const double bulk_Pa : {60.0, 1e3, 1e5, 1e7}) {
    for (const double tissue : {400.0, 16000.0, 60000.0}) {
      // What the kick would do to a strand alone.
      const double kick = 0.05, swing_m = kick / std::sqrt(tissue / kBallDensity_kg_per_m2);
      Ball ball = kicked(bulk_Pa, tissue, kick, 1.0 / 60);
      FatPressure fat(ball.model, Ball::kCount);
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

// Neither in intervals of many steps nor in one step per interval.
TEST(FatPressure, AddsNoEnergy) {
  for (const double bulk_Pa : {1e3, 4e4}) {
    for (const double interval_s : {1.0 / 30, kFatStep_s}) {
      Ball ball = kicked(bulk_Pa, 4000, 0.1, interval_s);
      FatPressure fat(ball.model, Ball::kCount);
      ball.press(fat);
      const double first_J = ball.energy_J(fat);
      double most_J = 0, last_J = 0;
      for (int i = 0; i < std::lround(5 / interval_s); ++i) {
        ball.interval(&fat, [] {});
        last_J = ball.energy_J(fat);
        most_J = std::max(most_J, last_J);
      }
      EXPECT_LT(most_J, 1.05 * first_J) << bulk_Pa << " Pa";  // leapfrog's own sways
      EXPECT_LT(last_J, first_J) << bulk_Pa << " Pa";
      EXPECT_GT(last_J, 0.01 * first_J) << bulk_Pa << " Pa";
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
      prepareFatPressure({60, ball.triangles, ball.rest, ball.anchor, fat, solid, points, false});
  ASSERT_EQ(model.layers.size(), 2u);
  EXPECT_EQ(model.points[0], 10u);
  EXPECT_EQ(model.layers[1].count, Ball::kCount - 4);
  fat.assign(Ball::kCount, 0.f);
  const FatPressureModel none =
      prepareFatPressure({60, ball.triangles, ball.rest, ball.anchor, fat, solid, points, false});
  EXPECT_TRUE(none.layers.empty());
}

TEST(FatPressure, KeepsItsMemory) {
  Ball ball(60, 4000, 0);
  FatPressure fat(ball.model, Ball::kCount);
  const float* first = ball.press(fat).x.data();
  for (int i = 0; i < 3; ++i) EXPECT_EQ(ball.press(fat).x.data(), first);
}

}  // namespace
}  // namespace fascia
