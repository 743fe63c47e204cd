#include <fascia/render/lookups.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <fascia/base/random.h>
#include <fascia/math/types.h>

namespace fascia {
namespace {

struct Gaussian {
  double variance_mm2;
  std::array<double, 3> weight;
};
constexpr std::array<Gaussian, 6> kSkinProfile{{{0.0064, {0.233, 0.455, 0.649}},
                                                {0.0484, {0.100, 0.336, 0.344}},
                                                {0.187, {0.118, 0.198, 0.0}},
                                                {0.567, {0.113, 0.007, 0.007}},
                                                {1.99, {0.358, 0.004, 0.0}},
                                                {7.41, {0.078, 0.0, 0.0}}}};
constexpr double kScatterLength_mm = 2.7;  // the profile's farthest standard deviation, √7.41
constexpr int kSteps = 24;                 // per Gaussian; fewer: bands where the light fades out

// Clamped Lambert light at angle theta, blurred along the ring by a Gaussian of `sigma_rad`.
double blurredLambert(double theta, double sigma_rad) {
  double sum = 0, weights = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double t = 6 * (i + 0.5) / kSteps - 3;  // in standard deviations
    const double weight = std::exp(-0.5 * t * t);
    sum += weight * std::max(0.0, std::cos(theta + t * sigma_rad));
    weights += weight;
  }
  return sum / weights;
}

double latticeValue(int octave, int x, int y) {
  const auto seed = static_cast<std::uint64_t>((octave * 4096 + y) * 4096 + x);
  return Random(0x5eed0000ull + seed).uniform();
}

double smoothNoise(int octave, double x, double y, int period) {
  const auto wrap = [period](int i) { return i % period; };
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const auto ease = [](double t) { return t * t * (3 - 2 * t); };
  const double u = ease(x - x0), v = ease(y - y0);
  const double a = latticeValue(octave, wrap(x0), wrap(y0));
  const double b = latticeValue(octave, wrap(x0 + 1), wrap(y0));
  const double c = latticeValue(octave, wrap(x0), wrap(y0 + 1));
  const double d = latticeValue(octave, wrap(x0 + 1), wrap(y0 + 1));
  return (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d);
}

}  // namespace

std::vector<float> scatterLookup(int width, int height) {
  std::vector<float> table;
  table.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
  for (int row = 0; row < height; ++row) {
    const double curvature = (row + 0.5) / height;
    for (int column = 0; column < width; ++column) {
      const double theta = std::acos(2.0 * (column + 0.5) / width - 1);
      std::array<double, 3> light{};
      for (const Gaussian& g : kSkinProfile) {
        const double sigma_rad = curvature * std::sqrt(g.variance_mm2) / kScatterLength_mm;
        const double lambert = blurredLambert(theta, sigma_rad);
        for (std::size_t c = 0; c < 3; ++c) light[c] += g.weight[c] * lambert;
      }
      for (const double value : light) table.push_back(static_cast<float>(value));
    }
  }
  return table;
}

std::vector<std::uint8_t> tileableNoise(int side) {
  std::vector<std::uint8_t> values;
  values.reserve(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const double u = static_cast<double>(x) / side, v = static_cast<double>(y) / side;
      const double value =
          0.65 * smoothNoise(0, 16 * u, 16 * v, 16) + 0.35 * smoothNoise(1, 48 * u, 48 * v, 48);
      values.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0))));
    }
  return values;
}

}  // namespace fascia
