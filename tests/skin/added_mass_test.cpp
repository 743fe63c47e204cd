#include <gtest/gtest.h>

#include "pinned_sheet.h"

namespace fascia {
namespace {

using test::PinnedSheet;

constexpr double kSteps_s[] = {1e-3, 1.0 / 240, 1.0 / 60, 1.0 / 24, 1.0 / 12};

PinnedSheet hanging(double stiffness_N_per_m, double density, double drag) {
  PinnedSheet::Options o;
  o.layout = {9, 9, false};
  o.stretchU_N_per_m = o.stretchV_N_per_m = stiffness_N_per_m;
  o.shear_N_per_m = 0.4 * stiffness_N_per_m;
  o.density_kg_per_m2 = density, o.drag_Ns_per_m3 = drag;
  o.prestretch = 1.1, o.maxStretch = 1.4;
  o.gravity_m_per_s2 = Vec3(0, 0, -9.81);
  return PinnedSheet(o);
}

TEST(AddedMass, IsNoneWhereTheStepResolvesTheStiffness) {
  PinnedSheet sheet = hanging(150, 4, 3);
  sheet.prepare(1e-3);
  test::forEachPoint(sheet.layout, [&](int, int, std::size_t k) {
    EXPECT_EQ(sheet.step.carry[k], 0);
    if (sheet.points.free[k] == 0) return;
    const double z = 0.5 * 1e-3 * sheet.points.drag[k] / sheet.points.mass[k];
    EXPECT_NEAR(sheet.step.gain[k] * sheet.points.mass[k] * (1 + z) / 1e-3, 1, 1e-6);
    EXPECT_NEAR(sheet.step.keep[k], (1 - z) / (1 + z), 1e-6);
  });
}

TEST(AddedMass, KeepsAnyStepWithAnyStiffnessStable) {
  for (const double h : kSteps_s) {
    for (const double stiffness : {1.0, 150.0, 1e4, 1e6}) {
      for (const double density : {0.1, 4.0, 100.0}) {
        PinnedSheet sheet = hanging(stiffness, density, 0);
        sheet.prepare(h);
        Random random(51);
        test::forEachPoint(sheet.layout, [&](int, int, std::size_t k) {
          if (sheet.points.free[k] == 0) return;
          const Vec3 kick(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
          test::put(sheet.velocity, k, kick);
        });
        sheet.run(500);
        // Without damping the free fall of the softest sheet is its largest excursion.
        double largest = 0;
        test::forEachPoint(sheet.layout, [&](int, int, std::size_t k) {
          const Vec3 moved = test::at(sheet.position, k) - test::at(sheet.rest, k);
          largest = moved.allFinite() ? std::max(largest, moved.norm()) : HUGE_VAL;
        });
        const double sag = 9.81 * density / stiffness;
        EXPECT_LT(largest, 1 + 2 * sag) << h << " s, " << stiffness << " N/m, " << density;
      }
    }
  }
}

// Without it a small push throws the sheet about: what the mass is for.
TEST(AddedMass, IsNeeded) {
  double largest[2];
  for (const bool stabilised : {true, false}) {
    PinnedSheet sheet = hanging(1e4, 4, 0);
    sheet.prepare(1.0 / 60);
    test::forEachPoint(sheet.layout, [&](int, int, std::size_t k) {
      if (!stabilised && sheet.points.free[k] > 0)
        sheet.step.gain[k] = sheet.step.step_s / sheet.points.mass[k];
    });
    sheet.position.z[sheet.layout.at(4, 4)] += 1e-3f;
    sheet.run(500);
    largest[stabilised] = test::largestDistance(sheet.layout, sheet.position, sheet.rest);
  }
  EXPECT_LT(largest[1], 0.1);
  EXPECT_GT(largest[0], 1);
}

TEST(AddedMass, DoesNotChangeWhereTheSheetComesToRest) {
  PinnedSheet fine = hanging(2000, 4, 400);
  fine.prepare(1e-3);
  ASSERT_EQ(*std::max_element(fine.step.carry.begin(), fine.step.carry.end()), 0);
  fine.run(20000);
  const double sag = test::largestDistance(fine.layout, fine.position, fine.rest);
  ASSERT_GT(sag, 0.01);
  for (const double h : {1.0 / 60, 1.0 / 12}) {
    PinnedSheet coarse = hanging(2000, 4, 400);
    coarse.prepare(h);
    ASSERT_GT(coarse.step.carry[coarse.layout.at(4, 4)], 0.5);
    coarse.run(20000);
    EXPECT_LT(test::largestDistance(fine.layout, fine.position, coarse.position), 1e-3 * sag) << h;
  }
}

TEST(AddedMass, OfTheLongestStepIsTheShareAskedFor) {
  const PinnedSheet sheet = hanging(150, 4, 0);
  const double step = longestStep(sheet.points, 0.02);
  const auto share = [&](double h) {
    PinnedSheet at = hanging(150, 4, 0);
    at.prepare(h);
    double own = 0, added = 0;
    test::forEachPoint(at.layout, [&](int, int, std::size_t k) {
      if (at.points.free[k] == 0) return;
      own += at.points.mass[k];
      added += at.points.mass[k] * at.step.carry[k] / (1 - at.step.carry[k]);
    });
    return added / own;
  };
  EXPECT_LE(share(0.999 * step), 0.02);
  EXPECT_GT(share(1.01 * step), 0.02);
}

}  // namespace
}  // namespace fascia
