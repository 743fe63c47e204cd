#include <fascia/io/cache/mdd.h>

#include <bit>
#include <cmath>
#include <limits>

#include <fascia/io/file/byte_stream.h>
#include <fascia/io/file/file.h>

namespace fascia {
namespace {

// int32 frames, int32 points, float times[frames], float positions[frames][points][3].
constexpr std::size_t kMaxMddBytes = std::size_t{8} << 30;

std::uint32_t swapped(std::uint32_t v) {
  return (v >> 24) | ((v >> 8) & 0xff00u) | ((v << 8) & 0xff0000u) | (v << 24);
}

std::uint32_t bigEndian(float v) {
  return swapped(std::bit_cast<std::uint32_t>(v));
}

std::size_t readCount(ByteReader& reader) {
  const std::uint32_t count = swapped(reader.value<std::uint32_t>());
  if (count > static_cast<std::uint32_t>(std::numeric_limits<std::int32_t>::max())) {
    reader.fail("has a negative count");
  }
  return count;
}

std::vector<float> readFloats(ByteReader& reader, std::uint64_t count) {
  std::vector<std::uint32_t> raw;
  reader.array(raw, count);
  std::vector<float> out(raw.size());
  for (std::size_t i = 0; i < raw.size(); ++i) out[i] = std::bit_cast<float>(swapped(raw[i]));
  return out;
}

}  // namespace

void writeMdd(const Recording& recording, const std::string& path) {
  const std::size_t points = recording.skin.positions.size();
  for (const Recording::Frame& frame : recording.frames) {
    if (points == 0 || frame.skin_m.size() != points) {
      throw Error("a point cache needs a skin in every frame");
    }
  }
  WholeFile file(path);
  std::vector<std::uint32_t> words{swapped(static_cast<std::uint32_t>(recording.frames.size())),
                                   swapped(static_cast<std::uint32_t>(points))};
  for (const Recording::Frame& frame : recording.frames) {
    words.push_back(bigEndian(static_cast<float>(frame.time_s)));
  }
  file.write(words.data(), words.size() * sizeof words[0]);
  for (const Recording::Frame& frame : recording.frames) {
    words.clear();
    for (const Eigen::Vector3f& p : frame.skin_m) {
      for (Eigen::Index c = 0; c < 3; ++c) words.push_back(bigEndian(p[c]));
    }
    file.write(words.data(), words.size() * sizeof words[0]);
  }
  file.commit();
}

MddCache parseMdd(std::string_view bytes, const std::string& file) {
  ByteReader reader(bytes, file);
  const std::size_t frames = readCount(reader);
  MddCache cache;
  cache.pointCount = readCount(reader);
  cache.times_s = readFloats(reader, frames);
  for (const float t : cache.times_s) {
    if (!std::isfinite(t)) reader.fail("has a time that is no number");
  }
  const std::uint64_t positions = std::uint64_t{frames} * cache.pointCount;
  if (positions > reader.left() / sizeof(Eigen::Vector3f)) reader.fail("is cut short");
  const std::vector<float> values = readFloats(reader, 3 * positions);
  cache.positions_m.reserve(values.size() / 3);
  for (std::size_t i = 0; i + 3 <= values.size(); i += 3) {
    cache.positions_m.emplace_back(values[i], values[i + 1], values[i + 2]);
  }
  if (reader.left() > 0) reader.fail("has bytes after its last frame");
  return cache;
}

MddCache readMdd(const std::string& path) {
  return parseMdd(readFile(path, kMaxMddBytes), path);
}

}  // namespace fascia
