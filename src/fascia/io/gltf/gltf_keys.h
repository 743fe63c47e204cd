#pragma once

#include <cstddef>
#include <vector>

#include <fascia/io/gltf/gltf_document.h>

namespace fascia {

// The keys of one animation channel, whatever it moves: times, and numbers of any width.
struct GltfKeys {
  enum class Mode { step, linear, cubic };
  Mode mode = Mode::linear;
  std::size_t width = 1;       // numbers of a value
  bool turns = false;          // values are quaternions: x, y, z, w
  std::vector<float> times_s;  // increasing
  std::vector<float> values;   // per key `width`; cubic: in-tangent, value, out-tangent

  std::size_t perKey() const { return mode == Mode::cubic ? 3 * width : width; }
  // The value at a time, clamped to the keys. Needs at least one key.
  std::vector<float> valueAt(double time_s) const;
};

// Reads a sampler's keys. False if they make no sense, or are no numbers that can be blended.
bool readGltfKeys(const GltfDocument& document, const GltfPlace& animation, const Json& channel,
                  GltfKeys& keys);

// What is to be shown of keys: from `start_s` on their clock for `length_s`.
struct GltfSpan {
  double start_s = 0, length_s = 0;
  double period_s = 0;  // after which they begin again; 0: they rest in their last value
};

// Keys at the same times that show just that, exactly: cuts fall between keys. Empty if there would
// be more than kMostCutNumbers numbers.
inline constexpr double kMostCutNumbers = 2e7;
GltfKeys cutGltfKeys(const GltfKeys& keys, const GltfSpan& span);

}  // namespace fascia
