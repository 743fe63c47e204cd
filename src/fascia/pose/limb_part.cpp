#include <fascia/pose/limb_part.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace fascia {
namespace {

using Eigen::Vector3f;

constexpr float kHalfTurn = 1.5707964f;

// Abramowitz & Stegun 4.4.45, for 0 <= x <= 1; error below 7e-5.
float arcSine(float x) {
  return kHalfTurn -
         std::sqrt(1 - x) * (1.5707288f + x * (-0.2121144f + x * (0.0742610f - 0.0187293f * x)));
}

// atan2 in turns, 0 … 1; error below 2e-6.
float turnOf(float y, float x) {
  const float ax = std::abs(x), ay = std::abs(y);
  const float t = std::min(ax, ay) / std::max(std::max(ax, ay), 1e-20f), q = t * t;
  float turn =
      t * (0.15912117f + q * (-0.05209607f + q * (0.02814779f + q * (-0.01308f + 0.00290f * q))));
  if (ay > ax) turn = 0.25f - turn;
  if (x < 0) turn = 0.5f - turn;
  return y < 0 ? 1 - turn : turn;
}

}  // namespace

// The four cells around a place and their bilinear weights.
struct LimbPart::Corners {
  std::array<int, 4> cell;
  std::array<float, 4> weight;
};

LimbPart::LimbPart(std::span<const Vector3f> skin, const Vector3f& from, const Vector3f& to)
    : begin_m_(from) {
  if (skin.empty()) return;
  length_m_ = (to - from).norm();
  if (length_m_ > 1e-9f) axis_ = (to - from) / length_m_;
  across_ =
      axis_.cross(std::abs(axis_.x()) < 0.8f ? Vector3f::UnitX() : Vector3f::UnitY()).normalized();
  side_ = axis_.cross(across_);
  fitRadius(skin);
  // Once more without what lies deep inside: teeth, tongues, the linings of clothes.
  std::vector<Vector3f> outer;
  for (const Vector3f& x : skin) {
    const Place place = locate(x);
    if (place.distance >= 0.55f * sample(radius_, place)) outer.push_back(x);
  }
  if (outer.size() < skin.size() && !outer.empty()) fitRadius(outer);
  greatestRadius_m_ = *std::max_element(radius_.begin(), radius_.end());
}

LimbPart::Place LimbPart::locate(const Vector3f& x) const {
  const Vector3f from = x - begin_m_;
  const float along = from.dot(axis_), t = std::clamp(along, 0.f, length_m_);
  const Vector3f off = from - t * axis_;
  Place place;
  place.distance = off.norm();
  place.away = place.distance > 1e-9f ? Vector3f(off / place.distance) : across_;
  const float slope = std::min(1.f, std::abs(place.away.dot(axis_)));
  if (along <= 0)
    place.row = kCapRows * (1 - arcSine(slope) / kHalfTurn);
  else if (along >= length_m_)
    place.row = kCapRows + kBodyRows + kCapRows * arcSine(slope) / kHalfTurn;
  else
    place.row = kCapRows + kBodyRows * t / length_m_;
  place.column =
      kColumns * std::min(0.999999f, turnOf(place.away.dot(side_), place.away.dot(across_)));
  return place;
}

LimbPart::Corners LimbPart::cornersOf(const Place& place) {
  const int row = std::clamp(static_cast<int>(place.row), 0, kRows - 2);
  const int column = static_cast<int>(place.column) % kColumns, next = (column + 1) % kColumns;
  const float v = place.row - static_cast<float>(row),
              u = place.column - static_cast<float>(static_cast<int>(place.column));
  const int low = row * kColumns, high = low + kColumns;
  return {{low + column, low + next, high + column, high + next},
          {(1 - v) * (1 - u), (1 - v) * u, v * (1 - u), v * u}};
}

float LimbPart::sample(const Map& map, const Place& place) {
  const Corners c = cornersOf(place);
  float value = 0;
  for (std::size_t k = 0; k < 4; ++k)
    value += c.weight[k] * map[static_cast<std::size_t>(c.cell[k])];
  return value;
}

float LimbPart::distance(const Vector3f& x) const {
  const Place place = locate(x);
  return place.distance - sample(radius_, place);
}

float LimbPart::distance(const Vector3f& x, Vector3f& away) const {
  const Place place = locate(x);
  away = place.away;
  return place.distance - sample(radius_, place);
}

float LimbPart::confidence(const Vector3f& x) const {
  return sample(seen_, locate(x));
}

float LimbPart::distanceFromSegment(const Vector3f& x) const {
  const Vector3f from = x - begin_m_;
  return (from - std::clamp(from.dot(axis_), 0.f, length_m_) * axis_).norm();
}

float LimbPart::residual(std::span<const Vector3f> skin) const {
  double sum = 0;
  for (const Vector3f& x : skin) sum += double{distance(x)} * distance(x);
  const double count = std::max<double>(1, static_cast<double>(skin.size()));
  return static_cast<float>(std::sqrt(sum / count)) / meanRadius_m_;
}

// Least squares of the points' distances, with the differences of neighbouring cells as a prior.
void LimbPart::fitRadius(std::span<const Vector3f> skin) {
  Map sum{}, count{};
  float mean = 0;
  for (const Vector3f& x : skin) {
    const Place place = locate(x);
    mean += place.distance;
    const Corners c = cornersOf(place);
    for (std::size_t k = 0; k < 4; ++k) {
      sum[static_cast<std::size_t>(c.cell[k])] += c.weight[k] * place.distance;
      count[static_cast<std::size_t>(c.cell[k])] += c.weight[k];
    }
  }
  meanRadius_m_ = mean / static_cast<float>(skin.size());
  radius_.fill(meanRadius_m_);
  continueWhereUnseen(sum, count);
  findSeen(count);
}

// Gauss–Seidel with over-relaxation; rows 0 and the last are the poles, one value each.
void LimbPart::continueWhereUnseen(const Map& sum, const Map& count) {
  constexpr float kPrior = 0.15f;  // larger: muscles are smoothed away; smaller: noise stays
  constexpr float kOver = 1.5f;
  constexpr int kSweeps = 80;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (int i = 0; i < kRows; ++i)
      for (int j = 0; j < kColumns; ++j) {
        const auto at = [&](int row, int column) {
          return static_cast<std::size_t>(row * kColumns + (column + kColumns) % kColumns);
        };
        float neighbours = radius_[at(i, j + 1)] + radius_[at(i, j - 1)], n = 2;
        if (i > 0) neighbours += radius_[at(i - 1, j)], ++n;
        if (i + 1 < kRows) neighbours += radius_[at(i + 1, j)], ++n;
        const std::size_t c = at(i, j);
        const float best = (sum[c] + kPrior * neighbours) / (count[c] + kPrior * n);
        radius_[c] += kOver * (best - radius_[c]);
      }
    for (const int pole : {0, kRows - 1}) {
      const auto first = radius_.begin() + pole * kColumns;
      float mean = 0;
      for (auto r = first; r != first + kColumns; ++r) mean += *r / kColumns;
      std::fill(first, first + kColumns, mean);
    }
  }
}

// Cells with points, grown by one ring and then softened by one.
void LimbPart::findSeen(const Map& count) {
  constexpr float kLeastCount = 0.02f;
  for (std::size_t c = 0; c < seen_.size(); ++c) seen_[c] = count[c] > kLeastCount ? 1.f : 0.f;
  for (const bool soften : {false, true}) {
    const Map before = seen_;
    for (int i = 0; i < kRows; ++i)
      for (int j = 0; j < kColumns; ++j) {
        float most = 0, mean = 0;
        for (int di = -1; di <= 1; ++di)
          for (int dj = -1; dj <= 1; ++dj) {
            const int row = std::clamp(i + di, 0, kRows - 1),
                      column = (j + dj + kColumns) % kColumns;
            const float value = before[static_cast<std::size_t>(row * kColumns + column)];
            most = std::max(most, value);
            mean += value / 9;
          }
        seen_[static_cast<std::size_t>(i * kColumns + j)] = soften ? mean : most;
      }
  }
}

}  // namespace fascia
