#include <gtest/gtest.h>

#include "pinned_sheet.h"

namespace fascia {
namespace {

using test::PinnedSheet;

// A cloud of points without a membrane: each hangs on its strand alone.
struct Strand {
  double stiffness_N_per_m = 30, damping_Ns_per_m = 0.4, restLength_m = 0.1, mass_kg = 0.25;
};

PinnedSheet hangingPoints(const Strand& s, double length_m) {
  PinnedSheet::Options o;
  o.layout = {9, 8, false};
  o.stretchU_N_per_m = o.stretchV_N_per_m = o.shear_N_per_m = 0;
  o.pinned = false;
  o.gravity_m_per_s2 = Vec3(0, -9.81, 0);
  PinnedSheet points(o);
  test::forEachPoint(points.layout, [&](int, int, std::size_t k) {
    points.points.mass[k] = static_cast<float>(s.mass_kg);
    points.points.tissueStiffness[k] = static_cast<float>(s.stiffness_N_per_m);
    points.points.tissueDamping[k] = static_cast<float>(s.damping_Ns_per_m);
    points.points.tissueRestLength[k] = static_cast<float>(s.restLength_m);
    points.points.stiffnessBound[k] = static_cast<float>(s.stiffness_N_per_m);
    test::put(points.around.anchor, k, test::at(points.rest, k));
    points.position.y[k] -= static_cast<float>(length_m);
  });
  return points;
}

double hangingLength(const PinnedSheet& points) {
  const std::size_t k = points.layout.at(3, 4);
  return (test::at(points.position, k) - test::at(points.around.anchor, k)).norm();
}

// m l̈ = m g − k (l − l0) − c l̇: a damped swing around l0 + m g / k.
TEST(Strand, SwingsLikeADampedSpringWhileTaut) {
  const Strand s;
  const double hang = s.restLength_m + s.mass_kg * 9.81 / s.stiffness_N_per_m;
  const double start = hang + 0.03;  // short of slack
  const double decay = s.damping_Ns_per_m / (2 * s.mass_kg);
  const double omega = std::sqrt(s.stiffness_N_per_m / s.mass_kg - decay * decay);
  const auto exact = [&](double t) {
    return hang + 0.03 * std::exp(-decay * t) *
                      (std::cos(omega * t) + decay / omega * std::sin(omega * t));
  };
  double error[2];
  for (int level = 0; level < 2; ++level) {
    PinnedSheet points = hangingPoints(s, start);
    const int perPeriod = 200 << level;
    const double h = 2 * kPi / omega / perPeriod;
    points.prepare(h);
    error[level] = 0;
    for (int i = 1; i <= 2 * perPeriod; ++i) {
      points.run(1);
      error[level] = std::max(error[level], std::abs(hangingLength(points) - exact(i * h)));
    }
  }
  EXPECT_LT(error[1], 0.03 * 0.02);
  // The damping and the start's half step are of first order.
  EXPECT_NEAR(error[0] / error[1], 2, 0.3);
}

TEST(Strand, NeverPushes) {
  const Strand s{.restLength_m = 0.5};
  PinnedSheet points = hangingPoints(s, 0.2);
  const double h = 1e-3;
  points.prepare(h);
  const std::size_t k = points.layout.at(3, 4);
  const double start = points.position.y[k];
  // Slack: falls freely; the leapfrog's sum of a constant g is g h² n (n + 1) / 2.
  points.run(200);
  EXPECT_NEAR(points.position.y[k], start - 9.81 * h * h * 200 * 201 / 2, 1e-5);
  EXPECT_LT(hangingLength(points), s.restLength_m);
  // Beyond its rest length it pulls back.
  points.run(100);
  EXPECT_GT(hangingLength(points), s.restLength_m);
  EXPECT_GT(points.position.y[k], start - 9.81 * h * h * 300 * 301 / 2 + 1e-3);
}

TEST(Strand, PullsAlongItself) {
  const Strand s{.damping_Ns_per_m = 2};
  PinnedSheet points = hangingPoints(s, 0.4);
  points.gravity.setZero();
  const Vec3 direction = Vec3(1, -2, 0.5).normalized();
  test::forEachPoint(points.layout, [&](int, int, std::size_t k) {
    test::put(points.position, k, test::at(points.around.anchor, k) + 0.4 * direction);
    test::put(points.velocity, k, Vec3(0.3, 0.1, -0.7));
  });
  const double h = 1e-4;
  points.prepare(h);
  points.run(1);
  const double closing = Vec3(0.3, 0.1, -0.7).dot(direction);
  const double pull = s.stiffness_N_per_m * 0.3 + s.damping_Ns_per_m * closing;
  const Vec3 expected = -pull / s.mass_kg * direction;
  const std::size_t k = points.layout.at(8, 7);
  const Vec3 acceleration = (test::at(points.velocity, k) - Vec3(0.3, 0.1, -0.7)) / h;
  EXPECT_LT((acceleration - expected).norm(), 2e-3 * expected.norm());
}

TEST(Strand, WithoutARestLengthDampsAlsoAcrossItself) {
  const Vec3 across(0.6, 0, -0.8);  // perpendicular to the hanging strand
  for (const double restLength_m : {0.0, 0.1}) {
    const Strand s{.damping_Ns_per_m = 2, .restLength_m = restLength_m};
    PinnedSheet points = hangingPoints(s, 0.4);
    points.gravity.setZero();
    test::forEachPoint(points.layout,
                       [&](int, int, std::size_t k) { test::put(points.velocity, k, across); });
    const double h = 1e-4;
    points.prepare(h);
    points.run(1);
    const std::size_t k = points.layout.at(8, 7);
    const double braking = (1 - test::at(points.velocity, k).dot(across)) / h;
    EXPECT_NEAR(braking, restLength_m > 0 ? 0 : s.damping_Ns_per_m / s.mass_kg, 0.05);
  }
}

TEST(Strand, DampsRelativeToItsMovingAnchor) {
  const Strand s{.stiffness_N_per_m = 0.01, .damping_Ns_per_m = 5, .restLength_m = 0.01};
  PinnedSheet points = hangingPoints(s, 0.4);
  points.gravity.setZero();
  test::forEachPoint(points.layout, [&](int, int, std::size_t k) {
    test::put(points.around.anchorVelocity, k, Vec3(0, -0.6, 0));
  });
  points.prepare(1e-3);
  points.run(1000);
  EXPECT_NEAR(points.velocity.y[points.layout.at(3, 4)], -0.6, 2e-3);
}

TEST(Strand, StaysStableHoweverStrongItsDamping) {
  const Strand s{.damping_Ns_per_m = 1e6};
  PinnedSheet points = hangingPoints(s, 0.4);
  points.prepare(1.0 / 12);
  points.run(500);
  const double length = hangingLength(points);
  EXPECT_GT(length, s.restLength_m);
  EXPECT_LE(length, 0.41);
}

TEST(HalfSpace, StopsPointsAtTheMovingFleshAndLetsThemSlide) {
  PinnedSheet points = hangingPoints({.stiffness_N_per_m = 0, .damping_Ns_per_m = 0}, 0);
  const Vec3 flesh(0.5, 0.2, 0);
  test::forEachPoint(points.layout, [&](int, int, std::size_t k) {
    test::put(points.around.normal, k, Vec3(0, 1, 0));
    test::put(points.around.fleshVelocity, k, flesh);
    points.around.offset[k] = points.rest.y[k] - 0.1f;
  });
  for (const double friction : {0.0, 1e4}) {
    PinnedSheet run = points;
    run.prepare(1e-3, {friction, 0});
    run.run(500);  // falls 0.1 m in 143 ms, less because the flesh comes towards it
    const std::size_t k = run.layout.at(2, 3);
    EXPECT_NEAR(run.position.y[k], run.rest.y[k] - 0.1 + 0.5 * flesh.y(), 1e-5);
    EXPECT_NEAR(run.velocity.y[k], flesh.y(), 1e-5);
    EXPECT_NEAR(run.velocity.x[k], friction > 0 ? flesh.x() : 0, 1e-5);
  }
}

TEST(HalfSpace, GivesBackTheShareOfRestitution) {
  PinnedSheet points = hangingPoints({.stiffness_N_per_m = 0, .damping_Ns_per_m = 0}, 0);
  points.gravity.setZero();
  test::forEachPoint(points.layout, [&](int, int, std::size_t k) {
    test::put(points.around.normal, k, Vec3(0, 1, 0));
    points.around.offset[k] = points.rest.y[k] - 0.01f;
    test::put(points.velocity, k, Vec3(0.4, -2, 0));
  });
  points.prepare(1e-3, {0, 0.6});
  points.run(20);
  EXPECT_NEAR(points.velocity.y[points.layout.at(2, 3)], 1.2, 1e-5);
  EXPECT_NEAR(points.velocity.x[points.layout.at(2, 3)], 0.4, 1e-6);
}

}  // namespace
}  // namespace fascia
