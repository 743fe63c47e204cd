#include <fascia/skin/cloth/cloth_choice.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace fascia {
namespace {

constexpr double kClothStep_s = 1.0 / 180;
// Sheets of more points than this need more steps: what a step leaves grows with the levels.
constexpr std::size_t kManyPoints = 30000;
constexpr double kClothStepOfMany_s = 1.0 / 240;
// The leapfrog is as fast while it takes fewer steps than this for one.
constexpr double kLeapfrogSteps = 5;
// Softer sheets show how they stretch, and that is the leapfrog's to say.
constexpr double kMostGrowth = 0.05;
// A sheet that is tauter at rest is drawn together by edges that are never slack.
constexpr double kMostPrestretch = 0.02;

double medianSum(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

bool isRelaxed(const ElasticGrid& elastic) {
  const GridLayout& g = elastic.layout();
  const ElasticGrid::Coefficients& c = elastic.coefficients();
  const auto relaxed = [](float rest_m, float squared) {
    return rest_m == 0 || std::abs(std::sqrt(double{squared}) / rest_m - 1) <= kMostPrestretch;
  };
  for (int j = 0; j < g.rows; ++j)
    for (int i = 0; i < g.columns; ++i)
      if (!relaxed(elastic.restLengthU_m(i, j), c.g1[g.at(i, j)]) ||
          !relaxed(elastic.restLengthV_m(i, j), c.g2[g.at(i, j)]))
        return false;
  return true;
}

// The force that would double the edges across a cut, N: the less of both ways. Of the middle cut,
// a tube's narrow ends do not count.
double forceToDouble(const ElasticGrid& elastic) {
  const GridLayout& g = elastic.layout();
  const ElasticGrid::Coefficients& c = elastic.coefficients();
  const auto force = [](float weight, float squared) {
    return 2 * double{weight} * squared * std::sqrt(double{squared});
  };
  std::vector<double> across(static_cast<std::size_t>(g.columns)),
      along(static_cast<std::size_t>(g.rows));
  for (int j = 0; j < g.rows; ++j) {
    for (int i = 0; i < g.columns; ++i) {
      const std::size_t k = g.at(i, j);
      across[static_cast<std::size_t>(i)] += force(c.w1[k], c.g1[k]);
      along[static_cast<std::size_t>(j)] += force(c.w2[k], c.g2[k]);
    }
  }
  return std::min(medianSum(across), medianSum(along));
}

}  // namespace

double clothStep_s(std::size_t points) {
  return points > kManyPoints ? kClothStepOfMany_s : kClothStep_s;
}

bool suitsCloth(const ElasticGrid& elastic, const PointModel& points, double gravity_m_per_s2,
                double longestStep_s) {
  const GridLayout& g = elastic.layout();
  if (longestStep_s * kLeapfrogSteps > clothStep_s(g.pointCount())) return false;
  double mass_kg = 0;
  for (int j = 0; j < g.rows; ++j) {
    for (int i = 0; i < g.columns; ++i) {
      mass_kg += points.mass[g.at(i, j)];
      if (points.tissueStiffness[g.at(i, j)] > 0) return false;
    }
  }
  return isRelaxed(elastic) && mass_kg * gravity_m_per_s2 <= kMostGrowth * forceToDouble(elastic);
}

}  // namespace fascia
