#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <fascia/math/types.h>
#include <fascia/render/curvature.h>
#include <fascia/render/lookups.h>

#include "pictures.h"

namespace fascia {
namespace {

constexpr int kWidth = 128, kHeight = 32;

float entry(const std::vector<float>& table, int row, int column, int channel) {
  return table[static_cast<std::size_t>((row * kWidth + column) * 3 + channel)];
}

TEST(ScatterLookup, FlatSkinIsLambertian) {
  const auto table = scatterLookup(kWidth, kHeight);
  for (int column = 0; column < kWidth; ++column) {
    const float cosine = 2 * (static_cast<float>(column) + 0.5f) / kWidth - 1;
    for (int channel = 0; channel < 3; ++channel)
      EXPECT_NEAR(entry(table, 0, column, channel), std::max(cosine, 0.f), 8e-3f);
  }
}

// Scattering moves light around the cylinder and loses none: its mean over all angles is that of
// the clamped cosine, 1/π.
TEST(ScatterLookup, KeepsTheEnergyAtEveryCurvature) {
  const auto table = scatterLookup(kWidth, kHeight);
  for (int row = 0; row < kHeight; ++row)
    for (int channel = 0; channel < 3; ++channel) {
      double sum = 0;
      for (int column = 0; column < kWidth; ++column) {
        const double left = std::acos(2.0 * column / kWidth - 1);
        const double right = std::acos(std::min(2.0 * (column + 1) / kWidth - 1, 1.0));
        sum += (left - right) * static_cast<double>(entry(table, row, column, channel));
      }
      EXPECT_NEAR(sum / kPi, 1 / kPi, 4e-3) << row << " " << channel;
    }
}

TEST(ScatterLookup, RedReachesFartherIntoTheDarkThanBlue) {
  const auto table = scatterLookup(kWidth, kHeight);
  const int dark = kWidth * 3 / 8;  // n·l = -1/4
  const float red = entry(table, kHeight - 1, dark, 0), blue = entry(table, kHeight - 1, dark, 2);
  EXPECT_GT(red, 0.02f);
  EXPECT_GT(red, 4 * blue);
}

TEST(TileableNoise, HasNoSeam) {
  constexpr int side = 128;
  const auto noise = tileableNoise(side);
  const auto at = [&](int x, int y) {
    return static_cast<int>(noise[static_cast<std::size_t>(y * side + x)]);
  };
  int inside = 0, seam = 0;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j + 1 < side; ++j) inside = std::max(inside, std::abs(at(j, i) - at(j + 1, i)));
  for (int i = 0; i < side; ++i)
    seam = std::max(
        {seam, std::abs(at(0, i) - at(side - 1, i)), std::abs(at(i, 0) - at(i, side - 1))});
  EXPECT_GT(inside, 10);
  EXPECT_LE(seam, inside + 10);
}

TEST(VertexCurvature, OfASphereIsTheInverseOfItsRadius) {
  const TriangleMesh mesh = test::sphereMesh({1, 2, 3}, 0.25f);
  std::vector<float> curvature_per_m;
  vertexCurvature(mesh.positions, mesh.normals, mesh.triangles, curvature_per_m);
  ASSERT_EQ(curvature_per_m.size(), mesh.positions.size());
  for (const float k : curvature_per_m) EXPECT_NEAR(k, 4, 1e-3f);
}

}  // namespace
}  // namespace fascia
