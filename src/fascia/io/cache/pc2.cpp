#include <fascia/io/cache/pc2.h>

#include <cmath>

#include <fascia/io/file/byte_stream.h>
#include <fascia/io/file/file.h>

namespace fascia {
namespace {

// The header: "POINTCACHE2\0", int32 version, int32 points, float start, float rate, int32 samples.
constexpr std::string_view kPc2Magic("POINTCACHE2\0", 12);
constexpr std::int32_t kPc2Version = 1;
constexpr std::size_t kMaxPc2Bytes = std::size_t{8} << 30;

}  // namespace

void writePc2(const Recording& recording, const std::string& path) {
  const std::size_t points = recording.skin.positions.size();
  for (const Recording::Frame& frame : recording.frames) {
    if (points == 0 || frame.skin_m.size() != points) {
      throw Error("a point cache needs a skin in every frame");
    }
  }
  ByteWriter header;
  header.bytes = kPc2Magic;
  header.value(kPc2Version);
  header.value(static_cast<std::int32_t>(points));
  header.value(0.0f);
  header.value(1.0f);
  header.value(static_cast<std::int32_t>(recording.frames.size()));
  WholeFile file(path);
  file.write(header.bytes);
  for (const Recording::Frame& frame : recording.frames) {
    file.write(frame.skin_m.data(), points * sizeof frame.skin_m[0]);
  }
  file.commit();
}

PointCache parsePc2(std::string_view bytes, const std::string& file) {
  ByteReader reader(bytes, file);
  if (!bytes.starts_with(kPc2Magic)) reader.fail("is not a PC2 point cache");
  reader.take(kPc2Magic.size());
  if (reader.value<std::int32_t>() != kPc2Version) reader.fail("has an unknown PC2 version");
  const auto points = reader.value<std::int32_t>();
  PointCache cache;
  cache.startFrame = reader.value<float>();
  cache.sampleRate = reader.value<float>();
  const auto samples = reader.value<std::int32_t>();
  if (points < 0 || samples < 0) reader.fail("has a negative count");
  if (!std::isfinite(cache.startFrame) || !std::isfinite(cache.sampleRate)) {
    reader.fail("has a time that is no number");
  }
  cache.pointCount = static_cast<std::size_t>(points);
  reader.array(cache.positions_m,
               static_cast<std::uint64_t>(points) * static_cast<std::uint64_t>(samples));
  if (reader.left() > 0) reader.fail("has bytes after its last sample");
  return cache;
}

PointCache readPc2(const std::string& path) {
  return parsePc2(readFile(path, kMaxPc2Bytes), path);
}

}  // namespace fascia
