#include <fascia/skin/mesh/mesh_layout.h>

#include <algorithm>
#include <array>
#include <span>

namespace fascia {
namespace {

using Triangle = TriangleMembrane::Triangle;
using Range = MeshLayout::Range;
using Places = std::vector<std::vector<std::uint32_t>>;  // per point of a chunk
constexpr std::size_t kBatch = MeshLayout::kBatch;

// Points per chunk. Fewer, and more triangles lie across borders and are computed twice; more, and
// corner forces (about 100 bytes per point) leave the cache.
constexpr std::size_t kChunkPoints = 1024;

std::uint32_t toIndex(std::size_t i) {
  return static_cast<std::uint32_t>(i);
}

std::array<float, MeshLayout::kTriangleFloats> coefficientsOf(const Triangle& t) {
  return {t.u[0], t.u[1], t.v[0], t.v[1], 0.5f * t.stretch_u, 0.5f * t.stretch_v, t.shear};
}
std::array<float, MeshLayout::kHingeFloats> coefficientsOf(const FoldEdge& h) {
  return {h.stiffness, h.restCosine, h.restSine, h.floor1, h.floor2, h.floorEdge};
}
// Of the elements that fill up a last batch; their corners are all one point.
constexpr std::array<float, MeshLayout::kTriangleFloats> nothing(const Triangle&) {
  return {};
}
constexpr std::array<float, MeshLayout::kHingeFloats> nothing(const FoldEdge&) {
  return {0, 1, 0, 1, 1, 1};
}

// Splits points into even chunks of whole slices.
std::vector<MeshLayout::Chunk> evenChunks(std::size_t points) {
  const std::size_t slices = points / kBatch;
  const std::size_t count = std::max<std::size_t>(1, (points + kChunkPoints / 2) / kChunkPoints);
  std::vector<MeshLayout::Chunk> chunks(std::min(count, slices));
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    const std::size_t begin = slices * i / chunks.size(), end = slices * (i + 1) / chunks.size();
    chunks[i].points = {toIndex(begin * kBatch), toIndex((end - begin) * kBatch)};
  }
  return chunks;
}

// Elements with a corner among the points, in an order that follows the points.
template <class Element>
std::vector<const Element*> touching(Range points, std::span<const Element> elements) {
  const auto inside = [&](std::uint32_t point) { return point - points.first < points.count; };
  std::vector<const Element*> out;
  for (const Element& e : elements)
    if (std::any_of(e.corners.begin(), e.corners.end(), inside)) out.push_back(&e);
  const auto firstPoints = [](const Element* e) {
    auto sorted = e->corners;
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  };
  std::stable_sort(out.begin(), out.end(), [&](const Element* a, const Element* b) {
    return firstPoints(a) < firstPoints(b);
  });
  return out;
}

// Appends the elements that touch the points, whose corner forces begin at `scratch`; notes where
// the points find theirs and returns the batches.
template <class Element>
Range appendElements(const MeshLayout& layout, Range points, std::span<const Element> elements,
                     std::size_t scratch, MeshLayout::Elements& out, Places& places) {
  constexpr std::size_t kCorners = std::tuple_size_v<decltype(Element::corners)>;
  const std::vector<const Element*> chosen = touching(points, elements);
  const std::size_t batches = (chosen.size() + kBatch - 1) / kBatch;
  const std::size_t firstBatch = out.corners.size() / (kCorners * kBatch);
  for (std::size_t n = 0; n < batches * kBatch; ++n) {
    const bool exists = n < chosen.size();
    const std::size_t batch = firstBatch + n / kBatch, l = n % kBatch;
    const auto values = exists ? coefficientsOf(*chosen[n]) : nothing(Element());
    out.coefficients.resize((batch + 1) * values.size() * kBatch);
    out.corners.resize((batch + 1) * kCorners * kBatch);
    for (std::size_t q = 0; q < values.size(); ++q)
      out.coefficients[(batch * values.size() + q) * kBatch + l] = values[q];
    for (std::size_t c = 0; c < kCorners; ++c) {
      const std::uint32_t point = exists ? chosen[n]->corners[c] : points.first;
      out.corners[(batch * kCorners + c) * kBatch + l] = toIndex(layout.quadOffset(point));
      if (!exists || point - points.first >= points.count) continue;
      const std::size_t item = (n / kBatch * kCorners + c) * kBatch + l;
      places[point - points.first].push_back(toIndex(scratch + layout.quadOffset(item)));
    }
  }
  return {toIndex(firstBatch), toIndex(batches)};
}

// Each slice's points get as many places as the one with most of them.
void appendPlaces(Places& places, MeshLayout& out) {
  for (std::size_t slice = 0; slice < places.size(); slice += kBatch) {
    std::size_t most = 0;
    for (std::size_t p = slice; p < slice + kBatch; ++p) most = std::max(most, places[p].size());
    for (std::size_t p = slice; p < slice + kBatch; ++p) {
      places[p].resize(most, 0);
      out.places.insert(out.places.end(), places[p].begin(), places[p].end());
    }
    out.sliceFirst.push_back(toIndex(out.places.size()));
  }
}

}  // namespace

MeshLayout::MeshLayout(const TriangleMembrane& membrane, std::size_t vectorLanes)
    : chunks(evenChunks(membrane.storage())),
      sliceFirst(1, 0),
      lanes(vectorLanes),
      pointCount(membrane.storage() / kBatch * kBatch),
      cap(membrane.cap()) {
  for (Chunk& chunk : chunks) {
    Places found(chunk.points.count);
    std::size_t scratch = kScratchHead;
    chunk.triangles = appendElements(*this, chunk.points, std::span(membrane.triangles()), scratch,
                                     triangles, found);
    scratch += std::size_t{chunk.triangles.count} * kTriangleCorners * kBatch * kQuad;
    chunk.hinges =
        appendElements(*this, chunk.points, std::span(membrane.hinges()), scratch, hinges, found);
    scratch += std::size_t{chunk.hinges.count} * kHingeCorners * kBatch * kQuad;
    appendPlaces(found, *this);
    scratchFloats = std::max(scratchFloats, scratch);
  }
}

}  // namespace fascia
