#include <fascia/geometry/weld.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <utility>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Disjoint sets; a set's name is its smallest member.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

using Cell = std::array<std::int64_t, 3>;
struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    std::uint64_t h = 0;
    for (const std::int64_t c : cell) {
      h = (h ^ static_cast<std::uint64_t>(c)) * 0x9E3779B97F4A7C15u;
      h ^= h >> 29;
    }
    return static_cast<std::size_t>(h);
  }
};

// The first vertex at the same position, per vertex: a hash grid whose cells are four tolerances
// wide, so that a search looks into one cell mostly and into eight at worst.
class Places {
 public:
  Places(std::span<const Eigen::Vector3f> positions, double tolerance)
      : positions_(positions),
        tolerance_(std::max(tolerance, 1e-12)),
        next_(positions.size(), kNone) {
    place_.reserve(positions.size());
    for (std::uint32_t v = 0; v < positions.size(); ++v) place_.push_back(placeOf(v));
  }
  std::vector<std::uint32_t> take() { return std::move(place_); }

 private:
  std::uint32_t placeOf(std::uint32_t v) {
    const Eigen::Vector3d p = positions_[v].cast<double>();
    const Cell low = cell(p.array() - tolerance_), high = cell(p.array() + tolerance_);
    Cell c;
    for (c[0] = low[0]; c[0] <= high[0]; ++c[0]) {
      for (c[1] = low[1]; c[1] <= high[1]; ++c[1]) {
        for (c[2] = low[2]; c[2] <= high[2]; ++c[2]) {
          const std::uint32_t found = search(c, p);
          if (found != kNone) return found;
        }
      }
    }
    const auto [entry, isNew] = first_.try_emplace(cell(p.array()), v);
    if (!isNew) next_[v] = std::exchange(entry->second, v);
    return v;
  }

  std::uint32_t search(const Cell& c, const Eigen::Vector3d& p) const {
    const auto entry = first_.find(c);
    if (entry == first_.end()) return kNone;
    std::uint32_t v = entry->second;
    while (v != kNone && (positions_[v].cast<double>() - p).norm() > tolerance_) v = next_[v];
    return v;
  }

  Cell cell(const Eigen::Array3d& p) const {
    const Eigen::Array3d scaled = (p / (4 * tolerance_)).floor().max(-9e18).min(9e18);
    return {static_cast<std::int64_t>(scaled.x()), static_cast<std::int64_t>(scaled.y()),
            static_cast<std::int64_t>(scaled.z())};
  }

  std::span<const Eigen::Vector3f> positions_;
  double tolerance_;
  std::unordered_map<Cell, std::uint32_t, CellHash> first_;
  std::vector<std::uint32_t> next_;  // of the vertices that opened places in one cell
  std::vector<std::uint32_t> place_;
};

// A triangle's edge from a vertex to the next; sorted by the places of its ends.
struct HalfEdge {
  std::uint32_t lowPlace, highPlace;
  std::uint32_t lowVertex, highVertex;
  std::uint32_t triangle;
  bool forward;  // from the low to the high place
};

std::vector<HalfEdge> sortedHalfEdges(std::span<const Triangle> triangles,
                                      std::span<const std::uint32_t> place) {
  std::vector<HalfEdge> edges;
  edges.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      if (place[a] == place[b]) continue;
      const bool forward = place[a] < place[b];
      if (!forward) std::swap(a, b);
      edges.push_back({place[a], place[b], a, b, t, forward});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::tie(a.lowPlace, a.highPlace, a.lowVertex, a.highVertex, a.triangle, a.forward) <
           std::tie(b.lowPlace, b.highPlace, b.lowVertex, b.highVertex, b.triangle, b.forward);
  });
  return edges;
}

class EdgeWelder {
 public:
  EdgeWelder(std::span<const Eigen::Vector3f> positions, std::span<const Triangle> triangles,
             const std::function<bool(std::uint32_t, std::uint32_t)>& alike, Sets& sets)
      : positions_(positions), triangles_(triangles), alike_(alike), sets_(sets) {}

  // All half edges between two places.
  void weld(std::span<const HalfEdge> edges) {
    collectBorder(edges);
    // So many borders along one edge mean nothing; all pairs of them would take for ever.
    constexpr std::size_t kMostBorders = 64;
    if (border_.size() < 2 || border_.size() > kMostBorders) return;
    collectPairs();
    std::vector<bool> joined(border_.size(), false);
    for (const Pair& pair : pairs_) {
      if (joined[pair.a] || joined[pair.b]) continue;
      joined[pair.a] = joined[pair.b] = true;
      sets_.join(border_[pair.a].lowVertex, border_[pair.b].lowVertex);
      sets_.join(border_[pair.a].highVertex, border_[pair.b].highVertex);
    }
  }

 private:
  struct Pair {
    bool turned;  // one triangle's winding is the wrong way round
    float evenness;
    std::size_t a, b;
  };

  // Half edges of one pair of vertices follow each other; if they run both ways, triangles meet.
  void collectBorder(std::span<const HalfEdge> edges) {
    border_.clear();
    for (std::size_t i = 0; i < edges.size();) {
      std::size_t end = i, forward = 0;
      while (end < edges.size() && edges[end].lowVertex == edges[i].lowVertex &&
             edges[end].highVertex == edges[i].highVertex) {
        forward += edges[end++].forward ? 1 : 0;
      }
      if (forward == 0 || forward == end - i)
        border_.insert(border_.end(), &edges[i], &edges[i] + (end - i));
      i = end;
    }
  }

  void collectPairs() {
    constexpr float kFoldedBack = -0.9995f;  // a wedge of two degrees is an edge still
    constexpr float kTurned = 0.5f;  // only what clearly continues may have the wrong winding
    pairs_.clear();
    for (std::size_t i = 0; i < border_.size(); ++i) {
      for (std::size_t j = i + 1; j < border_.size(); ++j) {
        const HalfEdge &a = border_[i], &b = border_[j];
        if (!alike_(a.lowVertex, b.lowVertex) || !alike_(a.highVertex, b.highVertex)) continue;
        const bool turned = a.forward == b.forward;
        const float cosine = normal(a.triangle).dot(normal(b.triangle));
        const float evenness = turned ? -cosine : cosine;
        if (evenness > (turned ? kTurned : kFoldedBack)) pairs_.push_back({turned, evenness, i, j});
      }
    }
    std::stable_sort(pairs_.begin(), pairs_.end(), [](const Pair& a, const Pair& b) {
      return a.turned != b.turned ? b.turned : a.evenness > b.evenness;
    });
  }

  // Zero for a triangle without area: it continues anything a little.
  Eigen::Vector3f normal(std::uint32_t triangle) const {
    const auto& [a, b, c] = triangles_[triangle];
    return (positions_[b] - positions_[a])
        .cast<double>()
        .cross((positions_[c] - positions_[a]).cast<double>())
        .normalized()
        .cast<float>();
  }

  std::span<const Eigen::Vector3f> positions_;
  std::span<const Triangle> triangles_;
  const std::function<bool(std::uint32_t, std::uint32_t)>& alike_;
  Sets& sets_;
  std::vector<HalfEdge> border_;
  std::vector<Pair> pairs_;
};

void joinLooseVertices(std::span<const Triangle> triangles, std::span<const std::uint32_t> place,
                       Sets& sets) {
  std::vector<bool> used(place.size(), false);
  std::vector<std::uint32_t> usedAt(place.size(), kNone);  // per place: its first vertex in use
  for (const Triangle& triangle : triangles) {
    for (const std::uint32_t v : triangle) {
      used[v] = true;
      usedAt[place[v]] = std::min(usedAt[place[v]], v);
    }
  }
  for (std::uint32_t v = 0; v < place.size(); ++v) {
    if (!used[v]) sets.join(v, usedAt[place[v]] == kNone ? place[v] : usedAt[place[v]]);
  }
}

}  // namespace

Weld weldVertices(std::span<const Eigen::Vector3f> positions, std::span<const Triangle> triangles,
                  float tolerance, const std::function<bool(std::uint32_t, std::uint32_t)>& alike) {
  const std::vector<std::uint32_t> place = Places(positions, tolerance).take();
  FASCIA_ASSERT(place.size() == positions.size() && areBelow(place, positions.size()),
                "every vertex has a place");
  const std::vector<HalfEdge> edges = sortedHalfEdges(triangles, place);
  Sets sets(positions.size());
  EdgeWelder welder(positions, triangles, alike, sets);
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end].lowPlace == edges[i].lowPlace &&
           edges[end].highPlace == edges[i].highPlace) {
      ++end;
    }
    welder.weld(std::span(edges).subspan(i, end - i));
    i = end;
  }
  joinLooseVertices(triangles, place, sets);

  Weld weld;
  weld.point.resize(positions.size());
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    const std::uint32_t first = sets.find(v);
    weld.point[v] = first == v ? weld.pointCount++ : weld.point[first];
  }
  return weld;
}

std::uint32_t numberComponents(std::size_t pointCount, std::span<const Triangle> triangles,
                               std::vector<std::uint32_t>& component) {
  Sets sets(pointCount);
  FASCIA_ASSERT(
      std::ranges::all_of(triangles, [&](const Triangle& t) { return areBelow(t, pointCount); }),
      "corners are points");
  for (const Triangle& t : triangles) {
    sets.join(t[0], t[1]);
    sets.join(t[0], t[2]);
  }
  std::uint32_t count = 0;
  component.resize(pointCount);
  for (std::uint32_t i = 0; i < pointCount; ++i) {
    const std::uint32_t first = sets.find(i);
    component[i] = first == i ? count++ : component[first];
  }
  return count;
}

bool isDegenerate(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
  const Eigen::Vector3d ab = (b - a).cast<double>(), ac = (c - a).cast<double>();
  const Eigen::Vector3d bc = (c - b).cast<double>();
  const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), bc.squaredNorm()});
  return ab.cross(ac).norm() <= 1e-6 * longest;
}

}  // namespace fascia
