#include <fascia/deformable/puppet/keyframed_path.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/error.h>
#include <fascia/base/suggest.h>

namespace fascia {
namespace {

// More of these than any number of metres or seconds that means something.
constexpr double kLargest = 1e9;

bool sound(const Vec3& v) {
  return v.allFinite() && v.cwiseAbs().maxCoeff() <= kLargest;
}

[[noreturn]] void refuse(std::size_t key, const std::string& message) {
  Issue issue{{}, "path: key " + std::to_string(key + 1) + ": " + message, {}};
  throw Error(issue);
}

}  // namespace

KeyframedPath::KeyframedPath(std::vector<PathKey> keys) : keys_(std::move(keys)) {
  check();
  fillVelocities();
  for (std::size_t i = 0; i + 1 < keys_.size(); ++i)
    segments_.emplace_back(keys_[i].time_s, keys_[i].position_m, *keys_[i].velocityOut_m_per_s,
                           keys_[i + 1].time_s, keys_[i + 1].position_m,
                           *keys_[i + 1].velocityIn_m_per_s);
}

void KeyframedPath::check() const {
  if (keys_.empty()) throw Error("path: found no keys, expected one or more");
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    const PathKey& key = keys_[i];
    if (!(std::abs(key.time_s) <= kLargest))
      refuse(i, "time: found " + shortNumber(key.time_s) + ", expected seconds");
    if (!sound(key.position_m)) refuse(i, "position: found a number that is no place");
    for (const auto& velocity : {key.velocityIn_m_per_s, key.velocityOut_m_per_s})
      if (velocity && !sound(*velocity)) refuse(i, "velocity: found a number that is no velocity");
    // Nearer keys make accelerations that overflow.
    constexpr double kNearest_s = 1e-6;
    if (i > 0 && key.time_s < keys_[i - 1].time_s + kNearest_s)
      refuse(i, "time: found " + shortNumber(key.time_s) + ", expected more than the key before, " +
                    shortNumber(keys_[i - 1].time_s));
  }
}

void KeyframedPath::fillVelocities() {
  for (PathKey& key : keys_) {
    if (!key.velocityIn_m_per_s) key.velocityIn_m_per_s = key.velocityOut_m_per_s;
    if (!key.velocityOut_m_per_s) key.velocityOut_m_per_s = key.velocityIn_m_per_s;
  }
  for (PathKey* end : {&keys_.front(), &keys_.back()})
    if (!end->velocityIn_m_per_s) end->velocityIn_m_per_s = end->velocityOut_m_per_s = Vec3::Zero();
  for (std::size_t i = 1; i < keys_.size(); ++i) {
    if (keys_[i].velocityIn_m_per_s) continue;
    const std::size_t first = i;
    while (!keys_[i].velocityIn_m_per_s) ++i;
    fillRun(first, i);
  }
}

// Velocities of keys [first, last) from those around them: the second derivatives of neighbouring
// cubics agree at key i if, with h and d the time and way to it (0) and from it (1),
//     v_{i−1}/h₀ + 2 v_i (1/h₀ + 1/h₁) + v_{i+1}/h₁ = 3 (d₀/h₀² + d₁/h₁²),
// a tridiagonal system with a dominant diagonal (de Boor 1978, ch. IV); Thomas' elimination.
void KeyframedPath::fillRun(std::size_t first, std::size_t last) {
  std::vector<double> pivot(last - first);
  std::vector<Vec3> right(last - first);
  for (std::size_t i = first; i < last; ++i) {
    const double h0 = keys_[i].time_s - keys_[i - 1].time_s,
                 h1 = keys_[i + 1].time_s - keys_[i].time_s;
    const Vec3 d0 = keys_[i].position_m - keys_[i - 1].position_m,
               d1 = keys_[i + 1].position_m - keys_[i].position_m;
    const std::size_t row = i - first;
    pivot[row] = 2 / h0 + 2 / h1;
    right[row] = 3 * (d0 / (h0 * h0) + d1 / (h1 * h1));
    if (i + 1 == last) right[row] -= *keys_[last].velocityIn_m_per_s / h1;
    if (row == 0) {
      right[row] -= *keys_[i - 1].velocityOut_m_per_s / h0;
    } else {
      const double factor = 1 / (h0 * pivot[row - 1]);
      pivot[row] -= factor / h0;
      right[row] -= factor * right[row - 1];
    }
  }
  for (std::size_t i = last; i-- > first;) {
    const std::size_t row = i - first;
    Vec3 velocity = right[row] / pivot[row];
    if (i + 1 < last) {
      const double h1 = keys_[i + 1].time_s - keys_[i].time_s;
      velocity -= *keys_[i + 1].velocityIn_m_per_s / (h1 * pivot[row]);
    }
    keys_[i].velocityIn_m_per_s = keys_[i].velocityOut_m_per_s = velocity;
  }
}

PathPoint KeyframedPath::at(double t_s) const {
  const auto next = std::ranges::upper_bound(keys_, t_s, {}, &PathKey::time_s);
  if (next == keys_.begin()) {
    const Vec3 velocity = *next->velocityIn_m_per_s;
    return {next->position_m + (t_s - next->time_s) * velocity, velocity, Vec3::Zero()};
  }
  if (next == keys_.end()) {
    const PathKey& last = keys_.back();
    const Vec3 velocity = *last.velocityOut_m_per_s;
    return {last.position_m + (t_s - last.time_s) * velocity, velocity, Vec3::Zero()};
  }
  return segments_[static_cast<std::size_t>(next - keys_.begin()) - 1].at(t_s);
}

bool KeyframedPath::jumpsWithin(double after_s, double until_s) const {
  return std::ranges::any_of(keys_, [&](const PathKey& key) {
    return key.time_s > after_s && key.time_s <= until_s &&
           *key.velocityIn_m_per_s != *key.velocityOut_m_per_s;
  });
}

}  // namespace fascia
