#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fascia/geometry/polygon.h>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

// Enough to halve any edge to nothing; a bound that rounding cannot break.
constexpr int kMaxPasses = 60;
// Flips that gain less than this sine of an angle would go back and forth by rounding.
constexpr double kFlatSine = 1e-9;

using EdgeKey = std::pair<std::uint32_t, std::uint32_t>;  // lower index first

class Refinement {
 public:
  Refinement(std::span<const Vec2> positions_m, PlanarTriangles triangles)
      : mesh_{{positions_m.begin(), positions_m.end()}, std::move(triangles)} {}

  void run(double edge_m) {
    flipAll();
    for (int pass = 0; pass < kMaxPasses && splitLong(edge_m); ++pass) flipAll();
  }
  PlanarMesh take() { return std::move(mesh_); }

 private:
  // The one or two triangles of every edge, and which of their corners are opposite to it.
  struct Side {
    std::size_t triangle;
    int opposite;
  };
  using Edges = std::map<EdgeKey, std::vector<Side>>;

  Edges findEdges() const {
    Edges edges;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
      for (int c = 0; c < 3; ++c) {
        const std::uint32_t a = corner(t, c + 1), b = corner(t, c + 2);
        edges[std::minmax(a, b)].push_back({t, c});
      }
    return edges;
  }
  std::uint32_t corner(std::size_t triangle, int c) const {
    FASCIA_ASSERT(triangle < mesh_.triangles.size() && c >= 0, "the corner exists");
    return mesh_.triangles[triangle][static_cast<std::size_t>(c % 3)];
  }
  double length_m(const EdgeKey& edge) const {
    return (mesh_.positions_m[edge.first] - mesh_.positions_m[edge.second]).norm();
  }

  // Halves edges that are too long, the longest first, at most one of each triangle.
  bool splitLong(double edge_m) {
    const Edges edges = findEdges();
    std::vector<const Edges::value_type*> tooLong;
    for (const auto& edge : edges)
      if (length_m(edge.first) > edge_m) tooLong.push_back(&edge);
    std::ranges::stable_sort(tooLong, [&](const auto* a, const auto* b) {
      return length_m(a->first) > length_m(b->first);
    });
    std::vector<char> touched(mesh_.triangles.size(), 0);
    for (const auto* edge : tooLong) {
      const auto& [key, sides] = *edge;
      if (std::ranges::any_of(sides, [&](const Side& s) { return touched[s.triangle]; })) continue;
      const auto middle = static_cast<std::uint32_t>(mesh_.positions_m.size());
      mesh_.positions_m.emplace_back(
          0.5 * (mesh_.positions_m[key.first] + mesh_.positions_m[key.second]));
      for (const Side& side : sides) {
        const std::uint32_t c = corner(side.triangle, side.opposite),
                            a = corner(side.triangle, side.opposite + 1),
                            b = corner(side.triangle, side.opposite + 2);
        mesh_.triangles[side.triangle] = {a, middle, c};
        mesh_.triangles.push_back({middle, b, c});
        touched[side.triangle] = 1;
      }
    }
    return !tooLong.empty();
  }

  void flipAll() {
    for (int pass = 0; pass < kMaxPasses && flipSome(); ++pass) {
    }
  }
  bool flipSome() {
    bool flipped = false;
    std::vector<char> touched(mesh_.triangles.size(), 0);
    for (const auto& [key, sides] : findEdges()) {
      if (sides.size() != 2 || touched[sides[0].triangle] || touched[sides[1].triangle]) continue;
      const std::size_t s = sides[0].triangle, t = sides[1].triangle;
      const std::uint32_t c = corner(s, sides[0].opposite), a = corner(s, sides[0].opposite + 1),
                          b = corner(s, sides[0].opposite + 2), d = corner(t, sides[1].opposite);
      if (!oppositeAnglesTooLarge(a, b, c, d)) continue;
      mesh_.triangles[s] = {a, d, c};
      mesh_.triangles[t] = {d, b, c};
      touched[s] = touched[t] = 1;
      flipped = true;
    }
    return flipped;
  }
  // Delaunay's condition on the edge a b between the corners c and d: their angles are together at
  // most π. Beyond it the four corners are convex, and the edge c d has smaller ones.
  bool oppositeAnglesTooLarge(std::uint32_t a, std::uint32_t b, std::uint32_t c,
                              std::uint32_t d) const {
    const auto angleAt = [&](std::uint32_t p, std::uint32_t from, std::uint32_t to) {
      const Vec2 u = (mesh_.positions_m[from] - mesh_.positions_m[p]).normalized(),
                 v = (mesh_.positions_m[to] - mesh_.positions_m[p]).normalized();
      return Vec2(u.dot(v), u.x() * v.y() - u.y() * v.x());  // cosine and sine
    };
    const Vec2 atC = angleAt(c, a, b), atD = angleAt(d, b, a);
    return atC.y() * atD.x() + atC.x() * atD.y() < -kFlatSine;
  }

  PlanarMesh mesh_;
};

}  // namespace

PlanarMesh refined(std::span<const Vec2> positions_m, PlanarTriangles triangles, double edge_m) {
  FASCIA_ASSERT(edge_m > 0, "edges have a length");
  Refinement refinement(positions_m, std::move(triangles));
  refinement.run(edge_m);
  return refinement.take();
}

}  // namespace fascia
