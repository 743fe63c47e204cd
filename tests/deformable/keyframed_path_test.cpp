#include <gtest/gtest.h>

#include <fascia/base/error.h>
#include <fascia/base/random.h>
#include <fascia/deformable/puppet/keyframed_path.h>
#include <fascia/math/finite_difference.h>

namespace fascia {
namespace {

// Six keys at uneven times; the third has a velocity, the fourth a jump.
std::vector<PathKey> someKeys() {
  Random random(4);
  std::vector<PathKey> keys;
  double time = -0.3;
  for (int i = 0; i < 6; ++i) {
    time += random.uniform(0.2, 1.1);
    keys.push_back(
        {time, Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)), {}, {}});
  }
  keys[2].velocityIn_m_per_s = Vec3(1, -2, 0.5);
  keys[3].velocityIn_m_per_s = Vec3(0.3, 0, 2), keys[3].velocityOut_m_per_s = Vec3(-1, 1, 0);
  return keys;
}

// The limits of the path at a key from either side.
struct Sides {
  PathPoint before, after;
};
Sides sidesOf(const KeyframedPath& path, double t_s) {
  return {path.at(std::nextafter(t_s, -1e9)), path.at(t_s)};
}

TEST(KeyframedPath, PassesItsKeysWithTheVelocitiesGiven) {
  const std::vector<PathKey> keys = someKeys();
  const KeyframedPath path(keys);
  for (const PathKey& key : keys) {
    const auto [before, after] = sidesOf(path, key.time_s);
    EXPECT_LT((before.position_m - key.position_m).norm(), 1e-14);
    EXPECT_LT((after.position_m - key.position_m).norm(), 1e-14);
  }
  EXPECT_LT((sidesOf(path, keys[2].time_s).before.velocity_m_per_s - Vec3(1, -2, 0.5)).norm(),
            1e-12);
  EXPECT_EQ(sidesOf(path, keys[2].time_s).after.velocity_m_per_s, Vec3(1, -2, 0.5));
  EXPECT_LT((sidesOf(path, keys[3].time_s).before.velocity_m_per_s - Vec3(0.3, 0, 2)).norm(),
            1e-12);
  EXPECT_EQ(sidesOf(path, keys[3].time_s).after.velocity_m_per_s, Vec3(-1, 1, 0));
}

TEST(KeyframedPath, RestsAtItsEnds) {
  const KeyframedPath path(someKeys());
  for (const double t : {path.start_s() - 2, path.start_s(), path.end_s(), path.end_s() + 3})
    EXPECT_EQ(path.at(t).velocity_m_per_s, Vec3::Zero()) << t;
  EXPECT_EQ(path.at(path.end_s() + 3).position_m, path.keys().back().position_m);
}

TEST(KeyframedPath, HasContinuousAccelerationWhereNoVelocityIsGiven) {
  const KeyframedPath path(someKeys());
  for (const std::size_t i : {1u, 4u}) {
    const auto [before, after] = sidesOf(path, path.keys()[i].time_s);
    EXPECT_GT(after.acceleration_m_per_s2.norm(), 0.1);
    EXPECT_LT((before.velocity_m_per_s - after.velocity_m_per_s).norm(), 1e-12);
    EXPECT_LT((before.acceleration_m_per_s2 - after.acceleration_m_per_s2).norm(), 1e-11);
  }
  // Not so at a velocity that somebody wanted.
  const auto [before, after] = sidesOf(path, path.keys()[2].time_s);
  EXPECT_GT((before.acceleration_m_per_s2 - after.acceleration_m_per_s2).norm(), 0.1);
}

TEST(KeyframedPath, GivesTheDerivativesOfItsPlace) {
  const KeyframedPath path(someKeys());
  const double d = 1e-4;
  for (double t = path.start_s() + 0.013; t < path.end_s(); t += 0.171) {
    const PathPoint n = path.at(t), before = path.at(t - d), after = path.at(t + d);
    const Vec3 rate = (after.position_m - before.position_m) / (2 * d);
    const Vec3 change = (after.velocity_m_per_s - before.velocity_m_per_s) / (2 * d);
    EXPECT_LT((n.velocity_m_per_s - rate).norm(), 1e-6 * (1 + rate.norm())) << t;
    EXPECT_LT((n.acceleration_m_per_s2 - change).norm(), 1e-6 * (1 + change.norm())) << t;
  }
}

TEST(KeyframedPath, ReproducesACubicFromItsEnds) {
  // A cubic is its own spline: the tridiagonal system has to find its velocities.
  const auto place = [](double t) { return Vec3(t * t * t, 2 * t * t - t, 1 - 3 * t * t * t); };
  const auto rate = [](double t) { return Vec3(3 * t * t, 4 * t - 1, -9 * t * t); };
  std::vector<PathKey> keys;
  for (const double t : {0.0, 0.3, 0.5, 1.4, 1.6, 2.0}) keys.push_back({t, place(t), {}, {}});
  keys.front().velocityOut_m_per_s = rate(0), keys.back().velocityIn_m_per_s = rate(2);
  const KeyframedPath path(keys);
  for (double t = 0; t <= 2; t += 0.1) {
    EXPECT_LT((path.at(t).position_m - place(t)).norm(), 1e-12) << t;
    EXPECT_LT((path.at(t).velocity_m_per_s - rate(t)).norm(), 1e-11) << t;
  }
}

TEST(KeyframedPath, GoesOnStraightBeyondItsEnds) {
  const KeyframedPath path(
      {{0, Vec3::Zero(), Vec3(1, 0, 0), {}}, {1, Vec3::UnitX(), {}, Vec3(0, 2, 0)}});
  EXPECT_EQ(path.at(-0.5).position_m, Vec3(-0.5, 0, 0));
  EXPECT_EQ(path.at(1.5).position_m, Vec3(1, 1, 0));
  EXPECT_EQ(path.at(1.5).acceleration_m_per_s2, Vec3::Zero());
}

TEST(KeyframedPath, KnowsWhereItsVelocityJumps) {
  const KeyframedPath path(someKeys());
  const double jump = path.keys()[3].time_s;
  EXPECT_TRUE(path.jumpsWithin(jump - 0.1, jump));
  EXPECT_FALSE(path.jumpsWithin(jump, jump + 0.1));
  EXPECT_FALSE(path.jumpsWithin(path.start_s() - 1, jump - 0.01));
}

TEST(KeyframedPath, RefusesKeysOutOfOrderOrWithoutSense) {
  const double nan = std::nan("");
  EXPECT_THROW(KeyframedPath({}), Error);
  EXPECT_THROW(KeyframedPath({{0, Vec3::Zero(), {}, {}}, {0, Vec3::UnitX(), {}, {}}}), Error);
  EXPECT_THROW(KeyframedPath({{1, Vec3::Zero(), {}, {}}, {0, Vec3::UnitX(), {}, {}}}), Error);
  EXPECT_THROW(KeyframedPath({{nan, Vec3::Zero(), {}, {}}}), Error);
  EXPECT_THROW(KeyframedPath({{0, Vec3(nan, 0, 0), {}, {}}}), Error);
  EXPECT_THROW(KeyframedPath({{0, Vec3::Zero(), Vec3(0, nan, 0), {}}}), Error);
  EXPECT_NO_THROW(KeyframedPath({{0, Vec3::Zero(), {}, {}}}));
}

}  // namespace
}  // namespace fascia
