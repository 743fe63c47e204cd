#include <gtest/gtest.h>

#include "pinned_sheet.h"

namespace fascia {
namespace {

using test::PinnedSheet;

constexpr double kWidth_m = 1.2, kHeight_m = 0.8, kDensity_kg_per_m2 = 3;
constexpr double kU_N_per_m = 200, kV_N_per_m = 90, kPrestretch = 1.3;

// Small transverse waves of a membrane, pinned at its border (Rayleigh, The Theory of Sound, §194):
// ω² = π² (T_u m²/a² + T_v n²/b²) / μ. The tension of the St. Venant–Kirchhoff law with relaxed
// lengths 1/p of the rest shape's, per width of the rest shape: T = K/2 · p² (p² − 1).
double membraneFrequency(int m, int n) {
  const double p2 = kPrestretch * kPrestretch, perStiffness = 0.5 * p2 * (p2 - 1);
  const double u = m / kWidth_m, v = n / kHeight_m;
  return kPi *
         std::sqrt(perStiffness * (kU_N_per_m * u * u + kV_N_per_m * v * v) / kDensity_kg_per_m2);
}

struct Swing {
  double omega_rad_per_s, decay_per_s;
};

// Plucks mode (m, n) of a sheet and measures its frequency from the times of its zero crossings,
// and its decay from the extremes between them.
Swing pluck(int intervals, int m, int n, double drag) {
  PinnedSheet::Options o;
  o.layout = {intervals + 1, intervals + 1, false};
  o.width_m = kWidth_m, o.height_m = kHeight_m;
  o.stretchU_N_per_m = kU_N_per_m, o.stretchV_N_per_m = kV_N_per_m;
  o.prestretch = kPrestretch, o.density_kg_per_m2 = kDensity_kg_per_m2, o.drag_Ns_per_m3 = drag;
  PinnedSheet sheet(o);
  const double h = 0.1 / intervals / membraneFrequency(1, 1);
  sheet.prepare(h);
  const auto shape = [&](int i, int j) {
    return std::sin(kPi * m * i / intervals) * std::sin(kPi * n * j / intervals);
  };
  test::forEachPoint(sheet.layout, [&](int i, int j, std::size_t k) {
    sheet.position.z[k] = static_cast<float>(2e-3 * shape(i, j));
  });
  fillPads(sheet.layout, sheet.position);
  sheet.startFromRest();
  const auto amplitude = [&] {
    double sum = 0;
    test::forEachPoint(sheet.layout, [&](int i, int j, std::size_t k) {
      sum += sheet.position.z[k] * shape(i, j);
    });
    return sum;
  };
  std::vector<double> crossings_s, extremes;
  double before = amplitude(), extreme = 0;
  for (int s = 1; crossings_s.size() < 9 && s < 100000; ++s) {
    sheet.run(1);
    const double now = amplitude();
    extreme = std::max(extreme, std::abs(now));
    if (before * now < 0) {
      crossings_s.push_back(h * (s - 1 + before / (before - now)));
      extremes.push_back(extreme);
      extreme = 0;
    }
    before = now;
  }
  if (crossings_s.size() < 9) return {0, 0};
  const double halfPeriod_s = (crossings_s[8] - crossings_s[0]) / 8;
  return {kPi / halfPeriod_s, std::log(extremes[1] / extremes[8]) / (7 * halfPeriod_s)};
}

TEST(Vibration, OfAStretchedSheetConvergesToTheClosedFormWithSecondOrder) {
  for (const auto& [m, n] : {std::pair{1, 1}, {2, 1}, {1, 3}}) {
    const double exact = membraneFrequency(m, n);
    double error[3];
    for (int level = 0; level < 3; ++level)
      error[level] = std::abs(pluck(8 << level, m, n, 0).omega_rad_per_s / exact - 1);
    EXPECT_LT(error[2], 1.2e-3 * std::max(m, n) * std::max(m, n)) << m << n;
    EXPECT_NEAR(error[0] / error[1], 4, 0.6) << m << n;
    EXPECT_NEAR(error[1] / error[2], 4, 0.6) << m << n;
  }
}

TEST(Vibration, DiesAwayWithHalfTheDragOverTheDensity) {
  const double drag = 5;
  const Swing swing = pluck(16, 1, 1, drag), free = pluck(16, 1, 1, 0);
  const double decay = 0.5 * drag / kDensity_kg_per_m2;
  EXPECT_NEAR(swing.decay_per_s / decay, 1, 5e-3);
  EXPECT_NEAR(free.decay_per_s, 0, 1e-3 * decay);
  const double slower = std::sqrt(free.omega_rad_per_s * free.omega_rad_per_s - decay * decay);
  EXPECT_NEAR(swing.omega_rad_per_s / slower, 1, 1e-4);
}

}  // namespace
}  // namespace fascia
