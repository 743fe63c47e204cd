#include <fascia/io/rig_import/gltf/gltf_clip.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fascia {
namespace {

// Of keys of all animations: many channels may share one accessor, each would decode it again.
constexpr std::size_t kMostKeyNumbers = 50'000'000;
constexpr double kSameTime_s = 1e-5;  // keys are floats: 30 Hz for an hour has steps of 1e-4

struct Skipped {
  std::size_t nowhere = 0, unsound = 0;
};

class ClipReader {
 public:
  ClipReader(const GltfDocument& document, const GltfScene& scene, Skipped& skipped)
      : document_(document), scene_(scene), skipped_(skipped) {}

  void read(const GltfPlace& animation, GltfClip& clip) {
    const GltfPlace channels = animation["channels"], samplers = animation["samplers"];
    for (std::size_t i = 0; i < channels.size(); ++i) {
      const GltfPlace target = channels.at(i)["target"];
      const std::string path = target["path"].textOr("");
      if (path == "pointer") continue;  // of looks
      if (path == "weights") {
        readWeights(animation, channels.at(i), clip);
        continue;
      }
      GltfChannel channel;
      if (!readTarget(target, path, channel)) {
        ++skipped_.nowhere;
      } else if (!readSampler(channels.at(i)["sampler"], samplers, channel)) {
        ++skipped_.unsound;
      } else {
        clip.channels.push_back(std::move(channel));
      }
    }
  }

 private:
  void readWeights(const GltfPlace& animation, const GltfPlace& channel, GltfClip& clip) {
    GltfWeightChannel weights;
    const double node = channel["target"]["node"].numberOr(-1);
    if (!(node >= 0 && node < static_cast<double>(scene_.nodes.size()))) {
      ++skipped_.nowhere;
      return;
    }
    weights.node = static_cast<int>(node);
    const bool sound =
        readGltfKeys(document_, animation, *channel.json(), weights.keys) &&
        std::ranges::all_of(weights.keys.values, [](float v) { return isSane(v); }) &&
        std::ranges::all_of(weights.keys.times_s, [](float t) { return isSane(t); });
    numbers_ += weights.keys.times_s.size() + weights.keys.values.size();
    if (numbers_ > kMostKeyNumbers) channel.fail("too many keys in one file");
    if (sound && !weights.keys.times_s.empty())
      clip.weights.push_back(std::move(weights));
    else
      ++skipped_.unsound;
  }

  bool readTarget(const GltfPlace& target, const std::string& path, GltfChannel& channel) const {
    const double node = target["node"].numberOr(-1);
    if (!(node >= 0 && node < static_cast<double>(scene_.nodes.size()))) return false;
    channel.node = static_cast<int>(node);
    if (scene_.nodes[static_cast<std::size_t>(channel.node)].hasMatrix) return false;
    if (path == "rotation") {
      channel.path = GltfChannel::Path::rotation;
    } else if (path == "scale") {
      channel.path = GltfChannel::Path::scale;
    } else if (path != "translation") {
      return false;
    }
    return true;
  }

  bool readSampler(const GltfPlace& index, const GltfPlace& samplers, GltfChannel& channel) {
    const double s = index.numberOr(-1);
    if (!(s >= 0 && s < static_cast<double>(samplers.size()))) return false;
    const GltfPlace sampler = samplers.at(static_cast<std::size_t>(s));
    const std::string mode = sampler["interpolation"].textOr("LINEAR");
    if (mode == "STEP") channel.mode = GltfChannel::Mode::step;
    if (mode == "CUBICSPLINE") channel.mode = GltfChannel::Mode::cubic;
    const auto accessors = static_cast<int>(document_.root()["accessors"].size());
    const int input = sampler["input"].index(accessors);
    const int output = sampler["output"].index(accessors);
    const std::size_t keys = document_.elementCount(input), values = document_.elementCount(output);
    numbers_ += keys + 4 * values;
    if (numbers_ > kMostKeyNumbers) sampler.fail("too many keys in one file");
    channel.times_s = document_.floats(input, 1);
    channel.values = document_.floats(output, static_cast<int>(channel.components()));
    return isSound(channel);
  }

  static bool isSound(const GltfChannel& channel) {
    const std::vector<float>& t = channel.times_s;
    const std::size_t perKey = channel.mode == GltfChannel::Mode::cubic ? 3 : 1;
    return !t.empty() && channel.values.size() == t.size() * perKey * channel.components() &&
           std::all_of(t.begin(), t.end(), [](float v) { return isSane(v); }) &&
           std::is_sorted(t.begin(), t.end()) &&
           std::all_of(channel.values.begin(), channel.values.end(),
                       [](float v) { return isSane(v); });
  }

  const GltfDocument& document_;
  const GltfScene& scene_;
  Skipped& skipped_;
  std::size_t numbers_ = 0;
};

Eigen::Vector4d slerp(const Eigen::Vector4d& a, const Eigen::Vector4d& b, double share) {
  const Quat qa(a.normalized()), qb(b.normalized());
  return qa.slerp(share, qb).coeffs();  // the shorter way round
}

std::vector<const std::vector<float>*> clocksOf(const GltfClip& clip) {
  std::vector<const std::vector<float>*> out;
  for (const GltfChannel& c : clip.channels) out.push_back(&c.times_s);
  for (const GltfWeightChannel& c : clip.weights) out.push_back(&c.keys.times_s);
  return out;
}

}  // namespace

Eigen::Vector4d GltfChannel::valueAt(double time_s, std::size_t& key) const {
  const std::size_t n = components(), stride = mode == Mode::cubic ? 3 * n : n;
  const auto part = [&](std::size_t k, std::size_t which) {
    Eigen::Vector4d out = Eigen::Vector4d::Zero();
    const float* from = &values[k * stride + which * n];
    for (std::size_t c = 0; c < n; ++c) out[static_cast<Eigen::Index>(c)] = from[c];
    return out;
  };
  const std::size_t middle = mode == Mode::cubic ? 1 : 0;
  if (key >= times_s.size() || times_s[key] > time_s + kSameTime_s) key = 0;
  while (key + 1 < times_s.size() && times_s[key + 1] <= time_s + kSameTime_s) ++key;
  const Eigen::Vector4d a = part(key, middle);
  if (key + 1 == times_s.size() || mode == Mode::step || time_s <= times_s[key]) return a;
  const Eigen::Vector4d b = part(key + 1, middle);
  const double step = static_cast<double>(times_s[key + 1]) - times_s[key];
  const double u = step > 0 ? std::clamp((time_s - times_s[key]) / step, 0.0, 1.0) : 1.0;
  if (mode == Mode::linear) return path == Path::rotation ? slerp(a, b, u) : a + u * (b - a);
  // Cubic Hermite (glTF 2.0, appendix C).
  const double u2 = u * u, u3 = u2 * u;
  return (2 * u3 - 3 * u2 + 1) * a + step * (u3 - 2 * u2 + u) * part(key, 2) +
         (3 * u2 - 2 * u3) * b + step * (u3 - u2) * part(key + 1, 0);
}

double GltfClip::start_s() const {
  double start = std::numeric_limits<double>::infinity();
  for (const GltfChannel& c : channels) start = std::min<double>(start, c.times_s.front());
  for (const GltfWeightChannel& c : weights)
    start = std::min<double>(start, c.keys.times_s.front());
  return isEmpty() ? 0 : start;
}

double GltfClip::end_s() const {
  double end = -std::numeric_limits<double>::infinity();
  for (const GltfChannel& c : channels) end = std::max<double>(end, c.times_s.back());
  for (const GltfWeightChannel& c : weights) end = std::max<double>(end, c.keys.times_s.back());
  return isEmpty() ? 0 : end;
}

double GltfClip::naturalRate_hz() const {
  constexpr double kRate = 60, kSlowest = 20, kFastest = 240;
  const double start = start_s(), duration = end_s() - start;
  double step = duration;
  bool cubic = false;
  for (const GltfChannel& c : channels) cubic = cubic || c.mode == GltfChannel::Mode::cubic;
  for (const GltfWeightChannel& c : weights) cubic = cubic || c.keys.mode == GltfKeys::Mode::cubic;
  const std::vector<const std::vector<float>*> clocks = clocksOf(*this);
  for (const std::vector<float>* times_s : clocks)
    for (std::size_t k = 1; k < times_s->size(); ++k) {
      const double gap = static_cast<double>((*times_s)[k]) - (*times_s)[k - 1];
      if (gap > 1e-4) step = std::min(step, gap);
    }
  if (!(duration > 0)) return kRate;
  step = duration / std::round(duration / step);
  for (const std::vector<float>* times_s : clocks)
    for (const float t : *times_s) {
      const double frames = (t - start) / step;
      if (std::abs(frames - std::round(frames)) > 0.02) return kRate;
    }
  // Few keys, or curves between them, are not to be judged by straight lines between few frames.
  const double keys = 1 / step, least = cubic ? kRate : kSlowest;
  const double rate = keys < least ? keys * std::ceil(kRate / keys) : keys;
  return std::min(rate, kFastest);
}

namespace {

GltfClip clipAt(const GltfPlace& animations, std::size_t i, ClipReader& reader) {
  GltfClip clip;
  clip.name = animations.at(i)["name"].textOr("");
  if (clip.name.empty()) clip.name = "animation " + std::to_string(i + 1);
  reader.read(animations.at(i), clip);
  return clip;
}

void noteSkipped(const Skipped& skipped, std::vector<std::string>& notes) {
  if (skipped.nowhere > 0) {
    notes.push_back(std::to_string(skipped.nowhere) +
                    " animation channels move nothing that is there: left out");
  }
  if (skipped.unsound > 0) {
    notes.push_back(std::to_string(skipped.unsound) +
                    " animation channels have keys that make no sense: left out");
  }
}

}  // namespace

std::vector<GltfClip> readGltfClips(const GltfDocument& document, const GltfScene& scene,
                                    std::vector<std::string>& notes) {
  const GltfPlace animations = document.root()["animations"];
  std::vector<GltfClip> clips;
  Skipped skipped;
  ClipReader reader(document, scene, skipped);
  for (std::size_t i = 0; i < animations.size(); ++i) {
    clips.push_back(clipAt(animations, i, reader));
  }
  noteSkipped(skipped, notes);
  return clips;
}

GltfClip readGltfClip(const GltfDocument& document, const GltfScene& scene, std::size_t animation,
                      std::vector<std::string>& notes) {
  Skipped skipped;
  ClipReader reader(document, scene, skipped);
  GltfClip clip = clipAt(document.root()["animations"], animation, reader);
  noteSkipped(skipped, notes);
  return clip;
}

}  // namespace fascia
