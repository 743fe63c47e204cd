#include <fascia/io/gltf/gltf_keys.h>

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include <fascia/base/assert.h>
#include <fascia/base/index.h>
#include <fascia/io/gltf/gltf_accessor.h>

namespace fascia {
namespace {

constexpr double kSameMoment_s = 1e-5;
constexpr double kJump_s = 1e-3;  // how long a jump between two rounds of a loop takes

// A value and its slope on both sides, in units per second.
struct Moment {
  double time_s = 0;
  std::vector<float> in, value, out;
};

class KeyReader {
 public:
  explicit KeyReader(const GltfKeys& keys) : keys_(keys) {}

  std::size_t count() const { return keys_.times_s.size(); }
  double time(std::size_t k) const { return keys_.times_s[k]; }

  Moment key(std::size_t k) const {
    const bool cubic = keys_.mode == GltfKeys::Mode::cubic;
    Moment moment{time(k), {}, part(k, cubic ? 1 : 0), {}};
    // Before the first and after the last key nothing changes.
    moment.in = cubic && k > 0 ? part(k, 0) : zeros();
    moment.out = cubic && k + 1 < count() ? part(k, 2) : zeros();
    return moment;
  }

  Moment keyAt(std::size_t k, double time_s) const {
    Moment moment = key(k);
    moment.time_s = time_s;
    return moment;
  }

  Moment at(double time_s) const {
    const auto next = static_cast<std::size_t>(
        std::upper_bound(keys_.times_s.begin(), keys_.times_s.end(), time_s,
                         [](double t, float key) { return t < static_cast<double>(key); }) -
        keys_.times_s.begin());
    const std::size_t k = next > 0 ? next - 1 : 0;
    for (const std::size_t near : {k, std::min(k + 1, count() - 1)})
      if (std::abs(time(near) - time_s) < kSameMoment_s) return keyAt(near, time_s);
    Moment moment = keyAt(k, time_s);
    const bool resting = next == 0 || next == count();
    if (resting) moment.in = moment.out = zeros();
    if (resting || keys_.mode == GltfKeys::Mode::step) return moment;
    const double step = time(k + 1) - time(k);
    const double u = step > 0 ? std::clamp((time_s - time(k)) / step, 0.0, 1.0) : 1.0;
    if (keys_.mode == GltfKeys::Mode::linear) {
      moment.value = mixed(moment.value, part(k + 1, 0), u);
      return moment;
    }
    return onCurve(k, step, u, std::move(moment));
  }

 private:
  std::vector<float> zeros() const { return std::vector<float>(keys_.width, 0.0f); }

  std::vector<float> part(std::size_t k, std::size_t which) const {
    const auto first = keys_.values.begin() +
                       static_cast<std::ptrdiff_t>(k * keys_.perKey() + which * keys_.width);
    return {first, first + static_cast<std::ptrdiff_t>(keys_.width)};
  }

  std::vector<float> mixed(const std::vector<float>& a, const std::vector<float>& b,
                           double u) const {
    if (keys_.turns) {
      using Turn = Eigen::Quaternionf;
      const Turn from = Turn(Eigen::Map<const Eigen::Vector4f>(a.data())).normalized();
      const Turn to = Turn(Eigen::Map<const Eigen::Vector4f>(b.data())).normalized();
      const Turn turn = from.slerp(static_cast<float>(u), to);
      return {turn.x(), turn.y(), turn.z(), turn.w()};
    }
    std::vector<float> out(a.size());
    for (std::size_t c = 0; c < a.size(); ++c)
      out[c] =
          static_cast<float>((1 - u) * static_cast<double>(a[c]) + u * static_cast<double>(b[c]));
    return out;
  }

  // Cubic Hermite (glTF 2.0, appendix C), and its slope.
  Moment onCurve(std::size_t k, double step, double u, Moment moment) const {
    const std::vector<float> a = part(k, 1), b = part(k + 1, 1), leaves = part(k, 2),
                             arrives = part(k + 1, 0);
    const double u2 = u * u, u3 = u2 * u;
    for (std::size_t c = 0; c < keys_.width; ++c) {
      const double rise = static_cast<double>(b[c]) - static_cast<double>(a[c]);
      const double m0 = step * static_cast<double>(leaves[c]),
                   m1 = step * static_cast<double>(arrives[c]);
      const double value = static_cast<double>(a[c]) + (3 * u2 - 2 * u3) * rise +
                           (u3 - 2 * u2 + u) * m0 + (u3 - u2) * m1;
      const double slope =
          (6 * u - 6 * u2) * rise + (3 * u2 - 4 * u + 1) * m0 + (3 * u2 - 2 * u) * m1;
      moment.value[c] = static_cast<float>(value);
      moment.in[c] = moment.out[c] = static_cast<float>(step > 0 ? slope / step : 0);
    }
    return moment;
  }

  const GltfKeys& keys_;
};

// Moments one after the other; where a round of a loop ends and the next begins both fall together.
class Track {
 public:
  void add(Moment moment) {
    if (moments_.empty() || moment.time_s > moments_.back().time_s + kSameMoment_s) {
      moments_.push_back(std::move(moment));
      return;
    }
    if (isNear(moments_.back().value, moment.value)) {
      moments_.back().out = std::move(moment.out);
      return;
    }
    Moment& last = moments_.back();
    last.time_s = moment.time_s - kJump_s;
    last.out.assign(last.out.size(), 0.0f);
    while (!moments_.empty() && isCrowded()) moments_.erase(moments_.end() - 2);
    moment.in.assign(moment.in.size(), 0.0f);
    moments_.push_back(std::move(moment));
  }

  GltfKeys keys(const GltfKeys& like) const {
    GltfKeys out;
    out.mode = like.mode, out.width = like.width, out.turns = like.turns;
    for (const Moment& m : moments_) {
      out.times_s.push_back(static_cast<float>(m.time_s));
      const bool cubic = like.mode == GltfKeys::Mode::cubic;
      if (cubic) out.values.insert(out.values.end(), m.in.begin(), m.in.end());
      out.values.insert(out.values.end(), m.value.begin(), m.value.end());
      if (cubic) out.values.insert(out.values.end(), m.out.begin(), m.out.end());
    }
    return out;
  }

 private:
  bool isCrowded() const {
    const std::size_t n = moments_.size();
    return n > 1 && moments_[n - 2].time_s > moments_[n - 1].time_s - kSameMoment_s;
  }
  static bool isNear(const std::vector<float>& a, const std::vector<float>& b) {
    for (std::size_t c = 0; c < a.size(); ++c) {
      const float size = std::max({1.0f, std::abs(a[c]), std::abs(b[c])});
      if (std::abs(a[c] - b[c]) > 1e-4f * size) return false;
    }
    return true;
  }

  std::vector<Moment> moments_;
};

// One round: from `first_s` on the keys' clock for `length_s`, put at `at_s`.
void addRound(const KeyReader& keys, double first_s, double length_s, double at_s, Track& out) {
  const auto add = [&](Moment moment) {
    moment.time_s += at_s - first_s;
    out.add(std::move(moment));
  };
  add(keys.at(first_s));
  for (std::size_t k = 0; k < keys.count(); ++k) {
    const double time_s = keys.time(k);
    if (time_s > first_s + kSameMoment_s && time_s < first_s + length_s - kSameMoment_s)
      add(keys.key(k));
  }
  if (length_s > kSameMoment_s) add(keys.at(first_s + length_s));
}

bool isBlendable(const GltfPlace& accessor) {
  return accessor["componentType"].countOr(0) == kGltfFloat || accessor["normalized"].flagOr(false);
}

bool isSound(const GltfKeys& keys) {
  const auto isNumber = [](float value) { return std::isfinite(value); };
  return !keys.times_s.empty() && std::ranges::all_of(keys.times_s, isNumber) &&
         std::ranges::is_sorted(keys.times_s) && std::ranges::all_of(keys.values, isNumber);
}

}  // namespace

std::vector<float> GltfKeys::valueAt(double time_s) const {
  FASCIA_ASSERT(!times_s.empty() && values.size() == times_s.size() * perKey(), "keys fit");
  return KeyReader(*this).at(time_s).value;
}

bool readGltfKeys(const GltfDocument& document, const GltfPlace& animation, const Json& channel,
                  GltfKeys& keys) {
  const GltfPlace samplers = animation["samplers"], accessors = document.root()["accessors"];
  const Json* index = channel.find("sampler");
  if (!index || !index->is(Json::Kind::number)) return false;
  if (!(index->number() >= 0 && index->number() < static_cast<double>(samplers.size())))
    return false;
  const GltfPlace sampler = samplers.at(static_cast<std::size_t>(index->number()));
  const std::string mode = sampler["interpolation"].textOr("LINEAR");
  keys.mode = mode == "STEP"          ? GltfKeys::Mode::step
              : mode == "CUBICSPLINE" ? GltfKeys::Mode::cubic
                                      : GltfKeys::Mode::linear;
  const int input = sampler["input"].index(static_cast<int>(accessors.size()));
  const int output = sampler["output"].index(static_cast<int>(accessors.size()));
  const GltfPlace values = accessors.at(at(output));
  const int components = componentCount(values["type"].textOr(""));
  if (components == 0 || !isBlendable(values)) return false;
  keys.times_s = document.floats(input, 1);
  keys.values = document.floats(output, components);
  const std::size_t tangents = keys.mode == GltfKeys::Mode::cubic ? 3 : 1;
  const std::size_t perNumber = tangents * keys.times_s.size();
  if (perNumber == 0 || keys.values.empty() || keys.values.size() % perNumber != 0) return false;
  keys.width = keys.values.size() / perNumber;
  const Json* target = channel.find("target");
  const Json* path = target ? target->find("path") : nullptr;
  keys.turns = keys.width == 4 && path && path->is(Json::Kind::text) && path->text() == "rotation";
  return isSound(keys);
}

GltfKeys cutGltfKeys(const GltfKeys& keys, const GltfSpan& span) {
  FASCIA_ASSERT(!keys.times_s.empty(), "there is something to cut");
  const double period_s = span.period_s > 1e-3 ? span.period_s : 0;
  const double rounds = period_s > 0 ? std::ceil(span.length_s / period_s - 1e-6) : 1;
  if (rounds * static_cast<double>(keys.values.size()) > kMostCutNumbers) return {};
  const KeyReader reader(keys);
  Track track;
  double at_s = 0;
  do {
    const double left_s = span.length_s - at_s;
    const double length_s = period_s > 0 ? std::min(period_s, left_s) : left_s;
    addRound(reader, span.start_s, length_s, span.start_s + at_s, track);
    at_s += length_s;
  } while (period_s > 0 && at_s < span.length_s - kSameMoment_s);
  return track.keys(keys);
}

}  // namespace fascia
