#include <gtest/gtest.h>

#include <fascia/skin/grid/prolongation.h>
#include <fascia/skin/grid/resample.h>

#include "grids.h"

namespace fascia {
namespace {

// A function of material coordinates: u around in [0, 1), v along in [0, 1].
template <class Function>
FloatArray sampled(const GridLayout& g, const Function& f) {
  FloatArray out(g.storage(), 0.f);
  test::forEachPoint(g, [&](int i, int j, std::size_t k) {
    const double u = static_cast<double>(i) / (g.closed ? g.columns : g.columns - 1);
    out[k] = static_cast<float>(f(u, static_cast<double>(j) / (g.rows - 1)));
  });
  fillPads(g, out);
  return out;
}

double largestError(const GridLayout& g, const FloatArray& a, const FloatArray& b) {
  double largest = 0;
  test::forEachPoint(g, [&](int, int, std::size_t k) {
    largest = std::max(largest, std::abs(double{a[k]} - b[k]));
  });
  return largest;
}

TEST(Resample, ReproducesBilinearFunctionsOfAnOpenGrid) {
  const auto f = [](double u, double v) { return 1 + 2 * u - 3 * v + 0.5 * u * v; };
  const GridLayout from{17, 9, false};
  for (const GridLayout to : {GridLayout{33, 20, false}, {8, 8, false}, {17, 9, false}})
    EXPECT_LT(largestError(to, resample(from, sampled(from, f), to), sampled(to, f)), 1e-6);
}

TEST(Resample, ReproducesConstantsAroundAndLinesAlongATube) {
  const auto f = [](double, double v) { return 2 - 0.7 * v; };
  const GridLayout from{15, 12, true};
  for (const GridLayout to : {GridLayout{33, 20, true}, {8, 9, true}})
    EXPECT_LT(largestError(to, resample(from, sampled(from, f), to), sampled(to, f)), 1e-6);
}

TEST(Resample, WrapsAroundTheTube) {
  const GridLayout from{8, 8, true}, to{16, 8, true};
  const auto f = [](double u, double) { return u < 0.9 && u > 0.8 ? 1.0 : 0.0; };  // column 7 alone
  const FloatArray fine = resample(from, sampled(from, f), to);
  EXPECT_EQ(fine[to.at(14, 3)], 1);
  EXPECT_EQ(fine[to.at(15, 3)], 0.5f);
  EXPECT_EQ(fine[to.at(13, 3)], 0.5f);
  EXPECT_EQ(fine[to.at(0, 3)], 0);
  EXPECT_EQ(fine[to.row(3) + 16], fine[to.at(0, 3)]);  // pads
  EXPECT_EQ(fine[to.row(3) - 1], fine[to.at(15, 3)]);
}

TEST(Resample, UpAndDownAgainIsTheIdentity) {
  Random random(71);
  for (const bool closed : {true, false}) {
    const GridLayout coarse{15, 12, closed};
    const GridLayout fine = closed ? GridLayout{45, 34, true} : GridLayout{43, 34, false};
    const FloatArray values =
        sampled(coarse, [&](double, double) { return random.uniform(-1, 1); });
    const FloatArray back = resample(fine, resample(coarse, values, fine), coarse);
    EXPECT_EQ(largestError(coarse, values, back), 0);
  }
}

TEST(Resample, KeepsBounds) {
  Random random(72);
  const GridLayout from{15, 12, true}, to{37, 29, true};
  const FloatArray values = sampled(from, [&](double, double) { return random.uniform(0, 1); });
  const FloatArray fine = resample(from, values, to);
  test::forEachPoint(to, [&](int, int, std::size_t k) {
    EXPECT_GE(fine[k], 0);
    EXPECT_LE(fine[k], 1);
  });
}

VectorArray prolonged(const GridLayout& coarse, const FloatArray& values, const GridLayout& fine) {
  VectorArray from(coarse.storage()), to;
  from.x = from.y = from.z = values;
  Prolongation(coarse, fine).apply(from, to);
  return to;
}

TEST(Prolongation, ReproducesConstantsExactly) {
  const GridLayout coarse{15, 12, true}, fine{47, 40, true};
  const VectorArray out =
      prolonged(coarse, sampled(coarse, [](double, double) { return 3; }), fine);
  test::forEachPoint(fine, [&](int, int, std::size_t k) {
    EXPECT_NEAR(out.x[k], 3, 1e-6);
    EXPECT_EQ(out.x[k], out.z[k]);
  });
}

TEST(Prolongation, ReproducesLinesAlongTheTubeAwayFromItsEnds) {
  const auto line = [](double, double v) { return 2 - 0.7 * v; };
  const GridLayout coarse{15, 12, true}, fine{47, 45, true};  // rows: four to one
  const VectorArray out = prolonged(coarse, sampled(coarse, line), fine);
  const FloatArray exact = sampled(fine, line);
  test::forEachPoint(fine, [&](int, int j, std::size_t k) {
    const bool oneSided = j < 4 || j > 40;  // in the first and last intervals
    EXPECT_NEAR(out.y[k], exact[k], oneSided ? 0.7 / 11 * 0.08 : 1e-6) << j;
  });
}

TEST(Prolongation, ConvergesWithThirdOrderAroundTheTube) {
  const auto wave = [](double u, double) { return std::sin(2 * kPi * u + 0.3); };
  double error[2];
  for (int n = 0; n < 2; ++n) {
    const GridLayout coarse{16 << n, 8, true}, fine{(16 << n) * 3, 8, true};
    const VectorArray out = prolonged(coarse, sampled(coarse, wave), fine);
    error[n] = largestError(fine, out.x, sampled(fine, wave));
  }
  EXPECT_LT(error[0], 0.01);
  EXPECT_GT(error[0] / error[1], 7.5);
}

}  // namespace
}  // namespace fascia
