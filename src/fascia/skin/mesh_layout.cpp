#include <fascia/skin/mesh_layout.h>

#include <algorithm>
#include <array>
#include <span>

namespace fascia {
namespace {

using Triangle = TriangleMembrane::Triangle;

// Points per chunk. Fewer, and more triangles lie across borders and are computed twice; more, and
// corner forces (about 100 bytes per point) leave the cache.
constexpr std::size_t kChunkPoints = 1024;

// Splits `slices` of points into even chunks.
std::vector<MeshLayout::Chunk> evenChunks(std::size_t points) {
  const std::size_t slices = points / MeshLayout::kBatch;
  const std::size_t count = std::max<std::size_t>(1, (points + kChunkPoints / 2) / kChunkPoints);
  std::vector<MeshLayout::Chunk> chunks(slices == 0 ? 0 : std::min(count, slices));
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    const std::size_t begin = slices * i / chunks.size(), end = slices * (i + 1) / chunks.size();
    chunks[i].firstPoint = static_cast<std::uint32_t>(begin * MeshLayout::kBatch);
    chunks[i].pointCount = static_cast<std::uint32_t>((end - begin) * MeshLayout::kBatch);
  }
  return chunks;
}

// Triangles with a corner among the chunk's points, in an order that follows the points.
std::vector<std::uint32_t> trianglesOf(const MeshLayout::Chunk& chunk,
                                       std::span<const Triangle> triangles) {
  const auto inside = [&](std::uint32_t point) {
    return point >= chunk.firstPoint && point < chunk.firstPoint + chunk.pointCount;
  };
  std::vector<std::uint32_t> out;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (std::any_of(triangles[i].corners.begin(), triangles[i].corners.end(), inside))
      out.push_back(static_cast<std::uint32_t>(i));
  const auto firstPoints = [&](std::uint32_t i) {
    TriangleMembrane::Corners sorted = triangles[i].corners;
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  };
  std::stable_sort(out.begin(), out.end(), [&](std::uint32_t a, std::uint32_t b) {
    return firstPoints(a) < firstPoints(b);
  });
  return out;
}

void appendBatches(std::span<const Triangle> triangles, std::span<const std::uint32_t> chosen,
                   std::uint32_t spare, MeshLayout& out) {
  constexpr std::size_t kBatch = MeshLayout::kBatch;
  for (std::size_t first = 0; first < chosen.size(); first += kBatch) {
    const std::size_t corners = out.corners.size(), floats = out.coefficients.size();
    // Triangles that fill up the last batch lie in one point and have no stiffness.
    out.corners.resize(corners + 3 * kBatch, static_cast<std::uint32_t>(out.quadOffset(spare)));
    out.coefficients.resize(floats + MeshLayout::kTriangleFloats * kBatch, 0.f);
    for (std::size_t l = 0; l < kBatch && first + l < chosen.size(); ++l) {
      const Triangle& t = triangles[chosen[first + l]];
      for (std::size_t c = 0; c < 3; ++c)
        out.corners[corners + c * kBatch + l] =
            static_cast<std::uint32_t>(out.quadOffset(t.corners[c]));
      const std::array<float, MeshLayout::kTriangleFloats> values{
          t.u[0], t.u[1], t.v[0], t.v[1], 0.5f * t.stretch_u, 0.5f * t.stretch_v, t.shear};
      for (std::size_t q = 0; q < values.size(); ++q)
        out.coefficients[floats + q * kBatch + l] = values[q];
    }
  }
}

// The places in scratch that each of the chunk's points sums.
void appendPlaces(const MeshLayout::Chunk& chunk, std::span<const Triangle> triangles,
                  std::span<const std::uint32_t> chosen, MeshLayout& out) {
  constexpr std::size_t kBatch = MeshLayout::kBatch;
  std::vector<std::vector<std::uint32_t>> placesOf(chunk.pointCount);
  for (std::size_t n = 0; n < chosen.size(); ++n) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t point = std::size_t{triangles[chosen[n]].corners[c]} - chunk.firstPoint;
      if (point >= placesOf.size()) continue;
      const std::size_t batchAndCorner = n / kBatch * 3 + c;
      placesOf[point].push_back(static_cast<std::uint32_t>(
          MeshLayout::kScratchHead + out.quadOffset(batchAndCorner * kBatch + n % kBatch)));
    }
  }
  for (std::size_t slice = 0; slice < placesOf.size(); slice += kBatch) {
    std::size_t most = 0;
    for (std::size_t p = slice; p < slice + kBatch; ++p) most = std::max(most, placesOf[p].size());
    for (std::size_t p = slice; p < slice + kBatch; ++p) {
      placesOf[p].resize(most, 0);
      out.places.insert(out.places.end(), placesOf[p].begin(), placesOf[p].end());
    }
    out.sliceFirst.push_back(static_cast<std::uint32_t>(out.places.size()));
  }
}

}  // namespace

MeshLayout::MeshLayout(const TriangleMembrane& membrane, std::size_t vectorLanes)
    : chunks(evenChunks(membrane.storage() / kBatch * kBatch)),
      sliceFirst(1, 0),
      lanes(vectorLanes),
      pointCount(membrane.storage() / kBatch * kBatch),
      cap(membrane.cap()) {
  for (Chunk& chunk : chunks) {
    const std::vector<std::uint32_t> chosen = trianglesOf(chunk, membrane.triangles());
    chunk.firstBatch = static_cast<std::uint32_t>(corners.size() / (3 * kBatch));
    chunk.batchCount = static_cast<std::uint32_t>((chosen.size() + kBatch - 1) / kBatch);
    appendBatches(membrane.triangles(), chosen, chunk.firstPoint, *this);
    appendPlaces(chunk, membrane.triangles(), chosen, *this);
    scratchFloats =
        std::max(scratchFloats, kScratchHead + std::size_t{chunk.batchCount} * 3 * kBatch * kQuad);
  }
}

}  // namespace fascia
