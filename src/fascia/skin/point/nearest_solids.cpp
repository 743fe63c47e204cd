#include <fascia/skin/point/nearest_solids.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace fascia {
namespace {

// A solid is at least so far away, over its own estimate: those of deformed solids are right to the
// first order only.
constexpr float kTrust = 0.7f;
// Far from everything points may go farther, over the distance of the nearest solid.
constexpr float kSlackOfGap = 0.15f;

}  // namespace

NearestSolids::NearestSolids(const DistanceField& field, double reach_m)
    : field_(field), least_m_(static_cast<float>(reach_m)), closest_m_(field.solidCount()) {
  candidates_.reserve(field.solidCount());
  for (std::size_t s = 0; s < field.solidCount(); ++s)
    steepest_ = std::max(
        steepest_, static_cast<float>(field.lipschitz(SolidId(static_cast<std::int64_t>(s)))));
}

void NearestSolids::measure(ConstVectors points) {
  assert(points.count <= kBlock);
  if (slack_m_ < 0 || points.count != count_ || strayed(points)) {
    findCandidates(points);
    return;
  }
  distance_.fill(3e38f);
  for (const SolidId solid : candidates_) offer(solid, points);
}

bool NearestSolids::anyNearer(double distance_m) const {
  // Compared as floats, to the same effect as in double: the limit is rounded up.
  auto limit = static_cast<float>(distance_m);
  if (limit < distance_m) limit = std::nextafter(limit, 3e38f);
  int nearer = 0;
  for (std::size_t i = 0; i < count_; ++i) nearer |= distance_[i] < limit;
  return nearer != 0;
}

bool NearestSolids::strayed(ConstVectors points) const {
  const float farthest2 = slack_m_ * slack_m_;
  int strayed = 0;
  for (std::size_t i = 0; i < points.count; ++i) {
    const float x = points.x[i] - known_[0][i], y = points.y[i] - known_[1][i],
                z = points.z[i] - known_[2][i];
    strayed |= !(x * x + y * y + z * z <= farthest2);
  }
  return strayed != 0;
}

void NearestSolids::findCandidates(ConstVectors points) {
  distance_.fill(3e38f);
  for (std::size_t s = 0; s < closest_m_.size(); ++s) {
    offer(SolidId(static_cast<std::int64_t>(s)), points);
    closest_m_[s] = *std::min_element(asked_.begin(), asked_.end());
  }
  float farthest = 0;
  for (std::size_t i = 0; i < points.count; ++i) farthest = std::max(farthest, distance_[i]);
  slack_m_ = std::max(least_m_, kSlackOfGap * farthest);
  // Until then no point goes farther from its nearest solid, nor nearer to others, than the slack,
  // and their distances change by no more than so many times that.
  candidates_.clear();
  for (std::size_t s = 0; s < closest_m_.size(); ++s)
    if (!(kTrust * closest_m_[s] > farthest + 2 * steepest_ * slack_m_))
      candidates_.emplace_back(static_cast<std::int64_t>(s));
  count_ = points.count;
  std::copy_n(points.x, points.count, known_[0].data());
  std::copy_n(points.y, points.count, known_[1].data());
  std::copy_n(points.z, points.count, known_[2].data());
}

// Takes the solid where it is nearer than what was found so far.
void NearestSolids::offer(SolidId solid, ConstVectors points) {
  field_.evaluate(
      solid, points, asked_.data(),
      {askedNormal_[0].data(), askedNormal_[1].data(), askedNormal_[2].data(), points.count});
  std::fill(asked_.begin() + static_cast<std::ptrdiff_t>(points.count), asked_.end(), 3e38f);
  // Loops of known length without branches: the compiler makes them wide.
  const auto number = static_cast<std::int32_t>(solid.index());
  for (std::size_t i = 0; i < kBlock; ++i)
    solid_[i] = asked_[i] < distance_[i] ? number : solid_[i];
  for (std::size_t c = 0; c < 3; ++c) {
    const Row& asked = askedNormal_[c];
    Row& normal = normal_[c];
    for (std::size_t i = 0; i < kBlock; ++i) {
      const float here = asked[i], before = normal[i];
      normal[i] = asked_[i] < distance_[i] ? here : before;
    }
  }
  for (std::size_t i = 0; i < kBlock; ++i) distance_[i] = std::min(distance_[i], asked_[i]);
}

}  // namespace fascia
