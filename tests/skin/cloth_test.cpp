#include <gtest/gtest.h>

#include <fascia/base/parallel.h>

#include "cloth.h"

namespace fascia {
namespace {

using test::Cloth;
using test::PinnedSheet;

constexpr double kStep_s = 1.0 / 180;

TEST(Cloth, FallsFreely) {
  for (const bool closed : {false, true}) {
    PinnedSheet sheet = test::hung({33, 40, closed}, 1, 1000);
    std::fill(sheet.points.free.begin(), sheet.points.free.end(), 1.f);
    std::fill(sheet.points.drag.begin(), sheet.points.drag.end(), 0.f);
    Cloth cloth(sheet);
    cloth.prepare(kStep_s);
    for (int n = 0; n < 30; ++n) cloth.run(3);
    const double t = 90 * kStep_s;
    const double lead = 1 / (1 + ClothStepper::kSwing) - 0.5;  // falls so many steps ahead
    test::forEachPoint(cloth.layout(), [&](int, int, std::size_t k) {
      EXPECT_NEAR(cloth.sheet.velocity.y[k], -9.81 * t, 2e-3);
      EXPECT_NEAR(cloth.sheet.position.y[k] - cloth.sheet.rest.y[k],
                  -9.81 * (t * t / 2 + lead * kStep_s * t), 1e-3);
      EXPECT_NEAR(cloth.sheet.position.x[k], cloth.sheet.rest.x[k], 3e-4);
    });
  }
}

TEST(Cloth, KeepsRestWhereNothingActs) {
  PinnedSheet sheet = test::hung({20, 20, true}, 1, 1000);
  sheet.gravity.setZero();
  Cloth cloth(sheet);
  cloth.prepare(kStep_s);
  cloth.run(60);
  EXPECT_LT(test::largestDistance(cloth.layout(), cloth.sheet.position, sheet.rest), 1e-4);
}

// Hanging from its top, a sheet carries ρ g y above the height y: an edge there grows by ρ g y / K.
TEST(Cloth, HangsAsLongAsItsStiffnessSays) {
  for (const double stiffness : {50.0, 100.0}) {
    for (const bool closed : {false, true}) {
      Cloth cloth(test::hung({33, 33, closed}, 2, stiffness));
      cloth.prepare(kStep_s);
      for (int n = 0; n < 600; ++n) cloth.run(3);
      const double strain = 0.25 * 9.81 * 2 / stiffness;  // at the top
      const double length = (cloth.place(7, 32) - cloth.place(7, 0)).norm();
      EXPECT_NEAR(length - 2, strain, 0.35 * strain) << stiffness << ' ' << closed;
    }
  }
}

// What swings and is dropped on its pinned edges.
PinnedSheet dropped(int side, double stiffness_N_per_m) {
  PinnedSheet sheet = test::hung({side, side, false}, 2, stiffness_N_per_m);
  test::fixRow(sheet, 0);
  test::forEachPoint(sheet.layout, [&](int i, int j, std::size_t k) {
    const double x = 2.0 * i / (side - 1), z = -1 + 2.0 * j / (side - 1);
    test::put(sheet.position, k, Vec3(x, -0.05 * std::cos(kPi / 2 * z), 0.85 * z));
  });
  fillPads(sheet.layout, sheet.position);
  return sheet;
}

TEST(Cloth, HardlyStretchesWithFewSteps) {
  for (const int side : {17, 33, 100}) {
    Cloth cloth(dropped(side, 1e5));
    cloth.prepare(kStep_s);
    double largest = 0;
    for (int n = 0; n < 240; ++n) {
      cloth.run(3);
      largest = std::max(largest, cloth.maxStretch());
    }
    EXPECT_LT(largest, 1.1) << side;
    EXPECT_GT(largest, 1.0001) << side;
  }
}

// Tension-only springs in double precision with steps that resolve them.
class ExplicitReference {
 public:
  explicit ExplicitReference(const PinnedSheet& sheet, double stiffness, double shear)
      : sheet_(sheet), stiffness_(stiffness), shear_(shear) {
    test::forEachPoint(sheet.layout,
                       [&](int, int, std::size_t k) { r_.push_back(test::at(sheet.position, k)); });
    v_.assign(r_.size(), Vec3::Zero());
  }
  void run(double h, int steps, double fixedSpeed) {
    for (int s = 0; s < steps; ++s) step(h, fixedSpeed);
  }
  Vec3 place(int i, int j) const { return r_[number(i, j)]; }
  Vec3 velocity(int i, int j) const { return v_[number(i, j)]; }

 private:
  std::size_t number(int i, int j) const {
    return static_cast<std::size_t>(j * sheet_.layout.columns + i);
  }
  void spring(std::size_t a, std::size_t b, double k, double length, bool pushes) {
    const Vec3 way = r_[b] - r_[a];
    const double l = way.norm(), excess = l - length;
    const double damping = 0.05 * std::sqrt(k * 1e-3) * (v_[b] - v_[a]).dot(way) / (l * l);
    const Vec3 force = (k * (excess > 0 || pushes ? excess : 0) / l + damping) * way;
    f_[a] += force, f_[b] -= force;
  }
  void step(double h, double fixedSpeed) {
    const GridLayout& g = sheet_.layout;
    const double dx = 2.0 / (g.columns - 1);
    f_.assign(r_.size(), Vec3::Zero());
    for (int j = 0; j < g.rows; ++j) {
      for (int i = 0; i < g.columns; ++i) {
        const std::size_t a = number(i, j);
        if (i + 1 < g.columns) spring(a, number(i + 1, j), stiffness_, dx, false);
        if (j + 1 == g.rows) continue;
        spring(a, number(i, j + 1), stiffness_, dx, false);
        if (i + 1 == g.columns) continue;
        spring(a, number(i + 1, j + 1), shear_, dx * std::sqrt(2), true);
        spring(number(i + 1, j), number(i, j + 1), shear_, dx * std::sqrt(2), true);
      }
    }
    test::forEachPoint(g, [&](int i, int j, std::size_t k) {
      const std::size_t a = number(i, j);
      if (sheet_.points.free[k] == 0) {
        v_[a] = Vec3(0, 0, fixedSpeed);
        r_[a] += h * v_[a];
        return;
      }
      const double mass = sheet_.points.mass[k];
      v_[a] = (1 - h * sheet_.points.drag[k] / mass) * v_[a] + h * (f_[a] / mass + sheet_.gravity);
      r_[a] += h * v_[a];
    });
  }

  const PinnedSheet& sheet_;
  double stiffness_, shear_;
  std::vector<Vec3> r_, v_, f_;
};

struct Comparison {
  double rms_m, energy;  // of the places; kinetic energy over that of the reference
};

// `drive(t)`: how fast the fixed points go, along z.
template <class Drive>
Comparison compare(const PinnedSheet& start, int frames, const Drive& drive) {
  ExplicitReference reference(start, 2000, 20);
  Cloth cloth(start);
  cloth.prepare(kStep_s);
  double squares = 0, energy = 0, referenceEnergy = 0;
  for (int n = 0; n < frames; ++n) {
    const double speed = drive(n / 60.0);
    test::forEachPoint(start.layout, [&](int, int, std::size_t k) {
      if (start.points.free[k] == 0) cloth.sheet.velocity.z[k] = static_cast<float>(speed);
    });
    reference.run(1.0 / 60 / 100, 100, speed);
    cloth.run(3);
    test::forEachPoint(start.layout, [&](int i, int j, std::size_t k) {
      squares += (cloth.place(i, j) - reference.place(i, j)).squaredNorm();
      energy += start.points.mass[k] * test::at(cloth.sheet.velocity, k).squaredNorm();
      referenceEnergy += start.points.mass[k] * reference.velocity(i, j).squaredNorm();
    });
  }
  return {std::sqrt(squares / static_cast<double>(frames) /
                    static_cast<double>(start.layout.pointCount())),
          energy / referenceEnergy};
}

// A flag that is swung by its upper edge.
TEST(Cloth, MovesAsAnExplicitSchemeWithManySteps) {
  const Comparison flag = compare(test::hung({25, 25, false}, 2, 2000), 240,
                                  [](double t) { return 0.4 * kPi * std::cos(kPi * t); });
  EXPECT_LT(flag.rms_m, 0.04);
  EXPECT_NEAR(flag.energy, 1, 0.1);
}

// Cloth that snaps taut gives up what an elastic one gives back: it comes to rest sooner.
TEST(Cloth, LosesMotionWhereItSnapsTaut) {
  const Comparison fall = compare(dropped(25, 2000), 180, [](double) { return 0.0; });
  EXPECT_LT(fall.rms_m, 0.06);
  EXPECT_GT(fall.energy, 0.4);
  EXPECT_LT(fall.energy, 1);
}

TEST(Cloth, HasTheSameBitsOnAnyNumberOfThreads) {
  for (const test::GridCase& grid :
       {test::GridCase{100, 100, false}, {64, 97, true}, {67, 96, true}}) {
    const PinnedSheet sheet = test::hung(grid.layout(), 1.5, 800);
    VectorArray one;
    for (const int threads : {1, 2, 3}) {
      const ThreadLimit limit(threads);
      Cloth cloth(sheet);
      cloth.prepare(kStep_s);
      for (int n = 0; n < 20; ++n) cloth.run(4);
      if (threads == 1) one = cloth.sheet.position;
      EXPECT_TRUE(test::sameBits(cloth.layout(), one, cloth.sheet.position)) << grid << threads;
      EXPECT_GT(test::largestDistance(cloth.layout(), one, sheet.rest), 0.01);
    }
  }
}

// The last column is as far from the first as any from the next, also where it starts far away.
TEST(Cloth, ClosesTheSeamOfATube) {
  for (const int columns : {24, 25}) {
    PinnedSheet sheet = test::hung({columns, 20, true}, 1, 1e4);
    std::fill(sheet.points.free.begin(), sheet.points.free.end(), 1.f);
    sheet.gravity.setZero();
    const double radius = test::at(sheet.rest, sheet.layout.at(0, 0)).z();
    const double edge = 2 * kPi * radius / columns;
    test::forEachPoint(sheet.layout, [&](int i, int, std::size_t k) {
      const double turn = (2 * kPi - 4 * edge / radius) * i / columns;
      test::put(sheet.position, k,
                Vec3(radius * std::sin(turn), sheet.rest.y[k], radius * std::cos(turn)));
    });
    fillPads(sheet.layout, sheet.position);
    Cloth cloth(sheet);
    cloth.prepare(kStep_s);
    const auto gap = [&] { return (cloth.place(0, 9) - cloth.place(columns - 1, 9)).norm(); };
    ASSERT_GT(gap(), 3 * edge);
    for (int n = 0; n < 60; ++n) cloth.run(3);
    EXPECT_LT(gap(), 1.05 * edge) << columns;
    EXPECT_GT(gap(), 0.5 * edge) << columns;
  }
}

// A tube has no seam: columns beside it stretch as all others do.
TEST(Cloth, StretchesATubeEvenly) {
  for (const int columns : {24, 25}) {
    Cloth cloth(test::hung({columns, 40, true}, 1, 60));
    cloth.prepare(kStep_s);
    for (int n = 0; n < 400; ++n) cloth.run(3);
    double shortest = 1e9, longest = 0;
    for (int i = 0; i < columns; ++i) {
      const double length = (cloth.place(i, 39) - cloth.place(i, 0)).norm();
      shortest = std::min(shortest, length), longest = std::max(longest, length);
    }
    EXPECT_GT(shortest, 1.001);
    EXPECT_LT(longest - shortest, 0.004) << columns;
  }
}

TEST(Cloth, HangsOnStrandsWhereTheyPullAsMuchAsItWeighs) {
  PinnedSheet sheet = test::hung({20, 18, false}, 1, 500);
  const double mass = sheet.points.mass[sheet.layout.at(5, 5)], stiffness = mass * 9.81 / 0.05;
  test::forEachPoint(sheet.layout, [&](int, int, std::size_t k) {
    sheet.points.free[k] = 1;
    sheet.points.mass[k] = static_cast<float>(mass);
    sheet.points.tissueStiffness[k] = static_cast<float>(stiffness);
    sheet.points.tissueDamping[k] = static_cast<float>(0.5 * std::sqrt(stiffness * mass));
    sheet.points.tissueRestLength[k] = 0.1f;
    test::put(sheet.around.anchor, k, test::at(sheet.rest, k) + Vec3(0, 0.1, 0));
  });
  Cloth cloth(sheet);
  cloth.prepare(kStep_s);
  for (int n = 0; n < 200; ++n) cloth.run(3);
  test::forEachPoint(cloth.layout(), [&](int, int, std::size_t k) {
    EXPECT_NEAR(cloth.sheet.position.y[k] - sheet.rest.y[k], -0.05, 2e-3);
  });
}

TEST(Cloth, FollowsFixedPointsThatMove) {
  PinnedSheet sheet = test::hung({18, 20, false}, 1, 1e4);
  for (int i = 0; i < 18; ++i) sheet.velocity.x[sheet.layout.at(i, 19)] = 0.3f;
  Cloth cloth(sheet);
  cloth.prepare(kStep_s);
  for (int n = 0; n < 60; ++n) cloth.run(3);
  EXPECT_NEAR(cloth.place(4, 19).x() - test::at(sheet.rest, sheet.layout.at(4, 19)).x(), 0.3, 1e-4);
  EXPECT_NEAR(cloth.place(4, 0).x() - test::at(sheet.rest, sheet.layout.at(4, 0)).x(), 0.3, 0.15);
}

// A floor that rises: points end on it, and slide to rest there.
TEST(Cloth, StaysOutOfHalfSpacesThatMove) {
  PinnedSheet sheet = test::hung({40, 40, false}, 1, 1000);
  std::fill(sheet.points.free.begin(), sheet.points.free.end(), 1.f);
  const double rise = 0.4, floor = -0.05;
  test::forEachPoint(sheet.layout, [&](int i, int j, std::size_t k) {
    test::put(sheet.position, k, Vec3(i / 39.0, 0.02, j / 39.0));
    sheet.velocity.x[k] = 0.5f;
    sheet.around.normal.y[k] = 1;
    sheet.around.fleshVelocity.y[k] = static_cast<float>(rise);
  });
  Cloth cloth(sheet);
  cloth.prepare(kStep_s, {.friction_per_s = 8, .restitution = 0});
  for (int n = 0; n < 60; ++n) {
    std::fill(cloth.sheet.around.offset.begin(), cloth.sheet.around.offset.end(),
              static_cast<float>(floor + rise * n / 60));
    cloth.run(3);
    test::forEachPoint(cloth.layout(), [&](int, int, std::size_t k) {
      ASSERT_GE(cloth.sheet.position.y[k], floor + rise * (n + 1) / 60 - 1e-5) << n;
    });
  }
  const Vec3 v = test::at(cloth.sheet.velocity, cloth.layout().at(20, 20));
  EXPECT_NEAR(v.y(), rise, 1e-3);
  EXPECT_LT(v.x(), 0.01);
}

// A cantilever of length L sags by ρ g L⁴ / (8 κ) at its end.
TEST(Cloth, BendsLikeABeam) {
  for (const double bending : {0.05, 0.2}) {
    PinnedSheet::Options o;
    o.layout = {8, 25, false};
    o.width_m = 0.1, o.height_m = 0.3 * 24 / 23;
    o.stretchU_N_per_m = o.stretchV_N_per_m = 5000;
    o.density_kg_per_m2 = 0.25;
    o.drag_Ns_per_m3 = 1;
    o.pinned = false;
    o.gravity_m_per_s2 = Vec3(0, 0, -9.81);
    PinnedSheet sheet(o);
    test::fixRow(sheet, 0);
    test::fixRow(sheet, 1);
    Cloth cloth(sheet, bending);
    cloth.prepare(kStep_s);
    for (int n = 0; n < 600; ++n) cloth.run(3);
    // Nodes that bend span 6 of 7 cells of the width, and the clamp ends half a row before the last
    // fixed one.
    const double length = 0.3 * (1 + 0.5 / 23);
    const double sag = 0.25 * 9.81 * std::pow(length, 4) / (8 * bending) * 7 / 6;
    EXPECT_NEAR(-cloth.place(4, 24).z(), sag, 0.06 * sag) << bending;
  }
}

}  // namespace
}  // namespace fascia
