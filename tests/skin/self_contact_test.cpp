#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include <fascia/base/parallel.h>
#include <fascia/base/random.h>
#include <fascia/math/types.h>

#include "support/count_allocations.h"
#include "touching_sheets.h"

namespace fascia {
namespace {

using test::at;
using test::put;

using test::flat;
using test::kGap_m;
using test::kInterval_s;
using test::kStepsOfInterval;
using test::sameBits;
using test::Surface;
using test::TwoSheets;

TEST(SelfContact, StopsTwoSheetsAtTheGapAndKeepsTheirMomentum) {
  for (const double upperMass_kg : {0.1, 0.5}) {
    TwoSheets sheets(0.03, 0.1, upperMass_kg);
    sheets.setVelocity(sheets.lower, sheets.upper, Vec3(0, 0.4, 0));
    sheets.setVelocity(sheets.upper, sheets.end, Vec3(0, -0.2, 0));
    const double before = sheets.momentum().y();
    for (int n = 0; n < 20; ++n) {
      sheets.interval();
      EXPECT_GT(sheets.leastHeight(), 0.99 * kGap_m);
    }
    EXPECT_LT(sheets.leastHeight(), 1.2 * kGap_m);
    EXPECT_NEAR(sheets.momentum().y(), before, 0.01 * (0.1 * 0.4 + upperMass_kg * 0.2));
    const double common = before / (0.1 + upperMass_kg);
    EXPECT_NEAR(at(sheets.velocity, sheets.lower + 66).y(), common, 0.01);
    EXPECT_NEAR(at(sheets.velocity, sheets.upper + 66).y(), common, 0.01);
  }
}

TEST(SelfContact, PartsSheetsThatWentThroughEachOther) {
  TwoSheets sheets(0.03);
  sheets.move(sheets.upper, sheets.end, Vec3(0, -0.033, 0));
  for (int n = 0; n < 10; ++n) sheets.interval();
  EXPECT_GT(sheets.leastHeight(), 0.9 * kGap_m);
}

// A strip along x, folded about its middle line by an angle; the upper half comes down on the
// lower one.
Vec3 folded(const Vec3& rest, double angle) {
  const double x = rest.x() - 0.1;
  if (x <= 0) return rest;
  return {0.1 + x * std::cos(angle), x * std::sin(angle), rest.z()};
}

// Follows a fold until 185°, further than there is room, and back to 170°.
std::size_t crossingsOfFoldedStrip(bool resolved) {
  Surface strip;
  strip.addSheet(8, 33, 0.1, flat(Vec3::Zero(), Vec3(0, 0, 0.05), Vec3(0.2, 0, 0)));
  strip.build();
  std::size_t most = 0;
  for (int n = 1; n <= 76; ++n) {
    const double angle = radians(n <= 70 ? n * 185 / 70.0 : 185 - (n - 70) * 2.5);
    for (std::size_t k = 0; k < strip.size(); ++k) {
      const Vec3 target = folded(at(strip.rest, k), angle);
      put(strip.velocity, k, (target - at(strip.position, k)) / kInterval_s);
    }
    if (resolved) {
      strip.interval();
    } else {
      strip.around.normal.fill(0.f);
      for (int s = 1; s <= kStepsOfInterval; ++s) strip.step(s, kInterval_s / kStepsOfInterval);
    }
    most = std::max(most, strip.crossingPairs());
  }
  return most;
}

TEST(SelfContact, KeepsAFoldedSheetFromCrossingItself) {
  EXPECT_GT(crossingsOfFoldedStrip(false), 50u);
  EXPECT_EQ(crossingsOfFoldedStrip(true), 0u);
}

TEST(SelfContact, LeavesSheetsThatCrossAtRestAsTheyAre) {
  for (const double angle : {5.0, 20.0, 90.0, 160.0, 175.0}) {
    const double c = std::cos(radians(angle)), s = std::sin(radians(angle));
    Surface sheets;
    sheets.addSheet(16, 16, 0.1, flat(Vec3(-0.1, 0, -0.1), Vec3(0, 0, 0.2), Vec3(0.2, 0, 0)));
    sheets.addSheet(16, 16, 0.1, [&](double u, double v) {
      const double x = 0.19 * (u - 0.5);
      return Vec3(c * x + 0.003, s * x, 0.19 * (v - 0.5) + 0.001);
    });
    sheets.build();
    ASSERT_GT(sheets.crossingPairs(), 10u);
    for (int n = 0; n < 5; ++n) {
      EXPECT_EQ(sheets.resolve().contacts, 0u) << angle;
      EXPECT_TRUE(sameBits(sheets.position, sheets.rest)) << angle;
      EXPECT_EQ(sheets.kineticEnergy(), 0) << angle;
    }
  }
}

TEST(SelfContact, KeepsTheDistanceThatClosedLipsHaveAtRest) {
  constexpr double kLips_m = 0.0005;
  TwoSheets lips(kLips_m);
  EXPECT_EQ(lips.resolve().contacts, 0u);
  EXPECT_TRUE(sameBits(lips.position, lips.rest));
  // Pressed together for a second.
  const auto press = [&](double h_s) {
    for (std::size_t k = 0; k < lips.end; ++k)
      put(lips.velocity, k, at(lips.velocity, k) + h_s * Vec3(0, k < lips.upper ? 5 : -5, 0));
  };
  for (int n = 0; n < 60; ++n) lips.interval(press);
  EXPECT_GT(lips.leastHeight(), 0.9 * kLips_m);
  EXPECT_LT(lips.leastHeight(), 1.05 * kLips_m);
}

// A closed limb along z: a tube of the given radius, open at its ends, and a small level patch that
// looks down on it.
struct LimbAndPatch : Surface {
  static constexpr double kRadius_m = 0.01;
  std::size_t patch;

  LimbAndPatch() {
    addSheet(25, 24, 0.1, [](double u, double v) {
      const double a = -2 * kPi * u;
      return Vec3(kRadius_m * std::sin(a), kRadius_m * std::cos(a), 0.1 * v - 0.05);
    });
    // Welds the seam: the last column is the first.
    for (auto& t : triangles)
      for (std::uint32_t& k : t)
        if (k % 25 == 24) k -= 24;
    patch = addSheet(4, 4, 0.001,
                     flat(Vec3(-0.004, 0.05, -0.004), Vec3(0.008, 0, 0), Vec3(0, 0, 0.008)));
    build();
  }
  // The patch's height over the limb's axis.
  void place(double height_m) {
    position = rest;
    move(patch, size(), Vec3(0, height_m - 0.05, 0));
    velocity.fill(0.f);
  }
  double height() const { return at(position, patch + 5).y(); }
};

TEST(SelfContact, LetsAPointGoThatCameOutAtTheOtherSideOfAThinLimb) {
  LimbAndPatch scene;
  scene.place(0.7 * LimbAndPatch::kRadius_m);  // below the near side: moves back up
  EXPECT_GT(scene.resolve().contacts, 0u);
  for (int n = 0; n < 10; ++n) scene.resolve();
  EXPECT_GT(scene.height(), 0.8 * LimbAndPatch::kRadius_m);
  for (const double height : {-0.5, -0.9, -1.1, -1.5}) {
    scene.place(height * LimbAndPatch::kRadius_m);
    const VectorArray before = scene.position;
    scene.resolve();
    EXPECT_TRUE(sameBits(scene.position, before)) << height;
  }
}

TEST(SelfContact, NeverFindsASmoothSurfaceTouchingItself) {
  LimbAndPatch scene;
  EXPECT_EQ(scene.resolve(0.02f).contacts, 0u);
  for (std::size_t k = 0; k < scene.size(); ++k)
    EXPECT_EQ(at(scene.around.normal, k).norm(), 0) << k;
  EXPECT_TRUE(sameBits(scene.position, scene.rest));
}

TEST(SelfContact, ChangesNoBitWhereNothingTouches) {
  TwoSheets sheets(0.05);
  Random random(3);
  for (std::size_t k = 0; k < sheets.end; ++k) {
    const auto any = [&] { return random.uniform(-0.01, 0.01); };
    put(sheets.velocity, k, Vec3(any(), any(), any()));
    put(sheets.around.normal, k, Vec3(0, 1, 0));
    put(sheets.around.fleshVelocity, k, Vec3(any(), any(), any()));
    sheets.around.offset[k] = static_cast<float>(any());
  }
  const Surface before = sheets;
  const float duration_s = static_cast<float>(kInterval_s);
  const auto result =
      sheets.contact.separate(sheets.points, 0.01f, sheets.position, sheets.velocity, duration_s);
  sheets.contact.writeHalfSpaces(sheets.position, sheets.velocity, duration_s, sheets.around);
  EXPECT_EQ(result.contacts, 0u);
  EXPECT_EQ(result.deepest_m, 0);
  EXPECT_TRUE(sameBits(sheets.position, before.position));
  EXPECT_TRUE(sameBits(sheets.velocity, before.velocity));
  EXPECT_TRUE(sameBits(sheets.around.normal, before.around.normal));
  EXPECT_TRUE(sameBits(sheets.around.fleshVelocity, before.around.fleshVelocity));
  EXPECT_EQ(sheets.around.offset, before.around.offset);
}

TEST(SelfContact, LetsTouchingSheetsPartAtOnce) {
  TwoSheets sheets(0.03);
  sheets.move(sheets.upper, sheets.end, Vec3(0, kGap_m - 0.03, 0));
  sheets.setVelocity(sheets.upper, sheets.end, Vec3(0.1, 0.3, 0));
  const VectorArray before = sheets.velocity;
  sheets.interval();
  EXPECT_TRUE(sameBits(sheets.velocity, before));
  EXPECT_NEAR(sheets.leastHeight(), kGap_m + 0.3 * kInterval_s, 1e-5);
}

TEST(SelfContact, StopsSheetsThatWouldPassEachOtherWithinOneInterval) {
  for (const double speed_m_per_s : {2.0, 10.0, 50.0}) {
    TwoSheets sheets(0.03);
    sheets.setVelocity(sheets.upper, sheets.end, Vec3(0, -speed_m_per_s, 0));
    ASSERT_GT(speed_m_per_s * kInterval_s, 0.03);
    for (int n = 0; n < 10; ++n) {
      sheets.interval();
      EXPECT_GT(sheets.leastHeight(), 0.9 * kGap_m) << speed_m_per_s;
    }
  }
}

// Dense skin would be torn by its contacts: triangles that turn over find contacts of their own.
TEST(SelfContact, TearsNoSinglePointOutOfItsSurroundings) {
  TwoSheets sheets(0.03);
  sheets.move(sheets.upper, sheets.end, Vec3(0, 2 * kGap_m - 0.03, 0));
  const std::size_t middle = sheets.upper + 6 * 13 + 6;
  const double edge_m = sheets.model.edge_m[middle];
  // As deep below the other sheet as contacts reach, where that one cannot give way.
  for (std::size_t k = 0; k < sheets.upper; ++k) sheets.points.free[k] = 0;
  put(sheets.position, middle, at(sheets.position, middle) - Vec3(0, 0.5 * edge_m, 0));
  const VectorArray before = sheets.position;
  ASSERT_GT(sheets.resolve().contacts, 0u);
  double moved = 0;
  for (std::size_t k = sheets.upper; k < sheets.end; ++k)
    moved = std::max(moved, (at(sheets.position, k) - at(before, k)).norm());
  EXPECT_GT(moved, 0.1 * edge_m);
  EXPECT_LT(moved, 0.26 * edge_m);
}

TEST(SelfContact, MovesOnlyTheFreeSide) {
  TwoSheets sheets(0.03);
  for (std::size_t k = 0; k < sheets.upper; ++k) sheets.points.free[k] = 0;
  sheets.move(sheets.upper, sheets.end, Vec3(0, 0.5 * kGap_m - 0.03, 0));
  sheets.setVelocity(sheets.upper, sheets.end, Vec3(0, -0.5, 0));
  sheets.resolve();
  EXPECT_NEAR(sheets.leastHeight(), kGap_m, 1e-6);
  for (std::size_t k = 0; k < sheets.upper; ++k) {
    EXPECT_EQ(at(sheets.position, k), at(sheets.rest, k));
    EXPECT_EQ(at(sheets.velocity, k), Vec3::Zero());
  }
  for (std::size_t k = sheets.upper; k < sheets.end; ++k)
    EXPECT_NEAR(at(sheets.velocity, k).y(), 0, 1e-6);
}

TEST(SelfContact, PushesSkinAgainstFleshButNotIntoIt) {
  TwoSheets sheets(0.03);
  sheets.move(sheets.upper, sheets.end, Vec3(0, -0.031, 0));
  // Flesh directly below the lower sheet: only the upper one can go.
  for (std::size_t k = 0; k < sheets.upper; ++k) put(sheets.around.normal, k, Vec3(0, 1, 0));
  // What the flesh gives back of the way, the next intervals see to.
  for (int n = 0; n < 10; ++n) sheets.resolveAboveFlesh();
  for (std::size_t k = 0; k < sheets.upper; ++k) {
    EXPECT_GE(sheets.position.y[k], 0) << k;
    EXPECT_EQ(at(sheets.around.normal, k), Vec3(0, 1, 0));
  }
  EXPECT_GT(sheets.leastHeight(), 0.9 * kGap_m);
}

// A sheet of springs at rest on another one that is fixed, under gravity.
struct RestingSheet : TwoSheets {
  static constexpr double kStiffness_N_per_m = 20, kGravity = 9.81;

  RestingSheet() : TwoSheets(0.03) {
    for (std::size_t k = 0; k < upper; ++k) points.free[k] = 0;
    move(upper, end, Vec3(0, kGap_m + 0.002 - 0.03, 0));
  }
  template <class Visit>
  void forEachSpring(const Visit& visit) const {
    for (const auto& t : triangles)
      for (std::size_t c = 0; c < 3; ++c)
        if (t[c] >= upper) visit(t[c], t[(c + 1) % 3]);
  }
  double length(const VectorArray& r, std::size_t a, std::size_t b) const {
    return (at(r, a) - at(r, b)).norm();
  }
  void accelerate(double h_s) {
    VectorArray force(size());
    forEachSpring([&](std::size_t a, std::size_t b) {
      const Vec3 along = (at(position, b) - at(position, a)).normalized();
      const Vec3 f = kStiffness_N_per_m * (length(position, a, b) - length(rest, a, b)) * along;
      put(force, a, at(force, a) + f);
      put(force, b, at(force, b) - f);
    });
    for (std::size_t k = upper; k < end; ++k)
      put(velocity, k,
          at(velocity, k) + h_s * (at(force, k) / points.mass[k] - Vec3(0, kGravity, 0)));
  }
  double energy() const {
    double sum = kineticEnergy();
    forEachSpring([&](std::size_t a, std::size_t b) {
      const double x = length(position, a, b) - length(rest, a, b);
      sum += 0.5 * kStiffness_N_per_m * x * x;
    });
    for (std::size_t k = upper; k < end; ++k)
      sum += double(points.mass[k]) * kGravity * at(position, k).y();
    return sum;
  }
};

TEST(SelfContact, NeitherGainsEnergyNorJittersAtRest) {
  RestingSheet sheets;
  const auto accelerate = [&](double h_s) { sheets.accelerate(h_s); };
  const double dropped = sheets.energy();
  double last = 0;
  VectorArray before;
  for (int n = 0; n < 600; ++n) {
    if (n == 599) before = sheets.position;
    sheets.interval(accelerate);
    EXPECT_LT(sheets.energy(), dropped + 1e-6) << n;
    if (n == 60) last = sheets.energy();
  }
  EXPECT_LT(sheets.energy(), last + 1e-6);
  EXPECT_NEAR(sheets.leastHeight(), kGap_m, 0.02 * kGap_m);
  for (std::size_t k = sheets.upper; k < sheets.end; ++k)
    EXPECT_LT((at(sheets.position, k) - at(before, k)).norm(), 1e-5);
}

// A sheet in wild folds.
struct Crumpled : Surface {
  explicit Crumpled(int columns) {
    addSheet(columns, columns, 0.5, flat(Vec3::Zero(), Vec3(0, 0, 0.5), Vec3(0.5, 0, 0)));
    build();
    Random random(11);
    for (std::size_t k = 0; k < size(); ++k) {
      const Vec3 r = at(rest, k);
      const Vec3 noise(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      put(position, k,
          Vec3(0.1 * std::sin(20 * r.x()), 0.05 * std::cos(23 * r.x() + 5 * r.z()),
               0.06 * std::sin(17 * r.z())) +
              0.002 * noise);
      put(velocity, k, noise);
    }
  }
};

TEST(SelfContact, GivesTheSameBitsOnAnyNumberOfThreads) {
  Crumpled one(48), two(48);
  std::uint64_t contacts = 0;
  for (int n = 0; n < 5; ++n) {
    {
      const ThreadLimit limit(1);
      contacts += one.resolve().contacts;
    }
    const ThreadLimit limit(2);
    two.resolve();
    EXPECT_TRUE(sameBits(one.position, two.position));
    EXPECT_TRUE(sameBits(one.velocity, two.velocity));
    EXPECT_TRUE(sameBits(one.around.normal, two.around.normal));
    EXPECT_EQ(one.around.offset, two.around.offset);
  }
  EXPECT_GT(contacts, 1000u);
}

TEST(SelfContact, AllocatesNothingFromTheFirstIntervalOn) {
  Crumpled sheet(32);
  const ThreadLimit limit(1);
  const long before = allocations;
  const std::uint64_t contacts = sheet.resolve().contacts;
  EXPECT_EQ(allocations - before, 0);
  EXPECT_GT(contacts, 100u);
}

TEST(SelfContact, ForgetsEverythingBetweenIntervals) {
  Crumpled used(32), fresh(32);
  used.resolve();
  used.position = fresh.position, used.velocity = fresh.velocity;
  used.resolve();
  fresh.resolve();
  EXPECT_TRUE(sameBits(used.position, fresh.position));
  EXPECT_TRUE(sameBits(used.velocity, fresh.velocity));
}

TEST(SelfContact, SurvivesPointsThatAreNotNumbers) {
  Crumpled sheet(32);
  sheet.position.x[7] = std::nanf("");
  sheet.position.y[300] = HUGE_VALF;
  put(sheet.velocity, 400, Vec3::Constant(1e30));
  sheet.resolve();
  for (std::size_t k = 600; k < sheet.size(); ++k)
    EXPECT_TRUE(at(sheet.position, k).allFinite()) << k;
}

}  // namespace
}  // namespace fascia
