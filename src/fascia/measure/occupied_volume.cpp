#include <algorithm>
#include <cmath>
#include <numeric>

#include <fascia/measure/deformation.h>

namespace fascia {
namespace {

// A surface without open edges: corners by number, so that triangles that share an edge agree on
// it to the last bit.
struct ClosedSurface {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Vec3> points;
};

struct DirectedEdge {
  std::uint32_t from, to;
  friend auto operator<=>(const DirectedEdge&, const DirectedEdge&) = default;
};

// Edges that are run through more often one way than the other, as often as they are too many.
std::vector<DirectedEdge> openEdges(TriangleList triangles) {
  std::vector<DirectedEdge> edges;
  edges.reserve(3 * triangles.size());
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) edges.push_back({t[k], t[(k + 1) % 3]});
  std::sort(edges.begin(), edges.end());
  const auto count = [&edges](const DirectedEdge& edge) {
    const auto [first, last] = std::equal_range(edges.begin(), edges.end(), edge);
    return last - first;
  };
  std::vector<DirectedEdge> open;
  for (auto it = edges.begin(); it != edges.end();) {
    const auto next = std::upper_bound(it, edges.end(), *it);
    const auto spare = (next - it) - count({it->to, it->from});
    for (std::ptrdiff_t i = 0; i < spare; ++i) open.push_back(*it);
    it = next;
  }
  return open;
}

// Which open edges hang together: a small union–find over their points.
class Runs {
 public:
  explicit Runs(std::size_t points) : parent_(points) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  std::uint32_t find(std::uint32_t p) {
    while (parent_[p] != p) p = parent_[p] = parent_[parent_[p]];
    return p;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

// The boundary of a surface is a cycle, whatever its shape: a cone over every connected run of it
// closes the surface, without tracing loops through points where several meet.
ClosedSurface close(TriangleList triangles, PointList points) {
  ClosedSurface surface;
  surface.triangles.assign(triangles.begin(), triangles.end());
  surface.points.reserve(points.size());
  for (const Eigen::Vector3f& p : points) surface.points.push_back(p.cast<double>());
  const std::vector<DirectedEdge> open = openEdges(triangles);
  if (open.empty()) return surface;
  Runs runs(points.size());
  for (const DirectedEdge& edge : open) runs.join(edge.from, edge.to);

  // The apex of a run: the mean of its edges, weighted by their length.
  struct Apex {
    Vec3 sum = Vec3::Zero();
    double weight = 0;
  };
  std::vector<Apex> apexes(points.size());
  for (const DirectedEdge& edge : open) {
    const Vec3& a = surface.points[edge.from];
    const Vec3& b = surface.points[edge.to];
    const double length = (b - a).norm();
    Apex& apex = apexes[runs.find(edge.from)];
    apex.sum += 0.5 * length * (a + b);
    apex.weight += length;
  }
  std::vector<std::uint32_t> number(points.size(), 0);
  for (std::uint32_t p = 0; p < points.size(); ++p) {
    if (apexes[p].weight <= 0) continue;
    number[p] = static_cast<std::uint32_t>(surface.points.size());
    surface.points.push_back(apexes[p].sum / apexes[p].weight);
  }
  for (const DirectedEdge& edge : open) {
    const std::uint32_t run = runs.find(edge.from);
    if (apexes[run].weight > 0) surface.triangles.push_back({edge.to, edge.from, number[run]});
  }
  return surface;
}

double countedVolume(const ClosedSurface& surface) {
  if (surface.triangles.empty()) return 0;
  const Vec3 origin = surface.points[surface.triangles.front()[0]];
  double sixfold = 0;
  for (const auto& t : surface.triangles) {
    const Vec3 a = surface.points[t[0]] - origin, b = surface.points[t[1]] - origin,
               c = surface.points[t[2]] - origin;
    sixfold += a.dot(b.cross(c));
  }
  return sixfold / 6;
}

// Lines parallel to z on a square grid, and where they pass the surface: between two passages, the
// number of times that space is inside is known.
class Columns {
 public:
  explicit Columns(const ClosedSurface& surface) : surface_(surface) {
    Box box;
    for (const auto& t : surface.triangles)
      for (const std::uint32_t p : t) box.add(surface.points[p]);
    if (box.empty() || !box.size().allFinite()) return;
    spacing_m_ = box.size().head<2>().maxCoeff() / kPerSide;
    if (!(spacing_m_ > 0)) return;
    corner_ = box.low.head<2>();
    for (const auto& t : surface.triangles) add(t);
    std::sort(passages_.begin(), passages_.end(), [](const Passage& a, const Passage& b) {
      return a.column != b.column ? a.column < b.column : a.z < b.z;
    });
  }

  // ∫ w − [w > 0] over space, w = times inside.
  double repeatedVolume() const {
    double length = 0;
    int inside = 0;
    for (std::size_t i = 0; i + 1 < passages_.size(); ++i) {
      inside = i > 0 && passages_[i - 1].column == passages_[i].column ? inside : 0;
      inside += passages_[i].entering;
      if (passages_[i + 1].column != passages_[i].column) continue;
      const int repeated = inside > 0 ? inside - 1 : inside;
      length += repeated * (passages_[i + 1].z - passages_[i].z);
    }
    return length * spacing_m_ * spacing_m_;
  }

 private:
  // Fine enough for 0.1 % of the volume of a ball; the time grows with the square.
  static constexpr int kPerSide = 256;

  struct Passage {
    std::uint32_t column;
    int entering;  // 1 into the surface, -1 out of it, going up
    double z;
  };

  // Twice the signed area of a, b and p. The same bits for (a, b) and (b, a) but for the sign, and
  // never 0: a line through an edge passes exactly one of its two triangles.
  double turn(std::uint32_t a, std::uint32_t b, const Vec2& p) const {
    if (a > b) return -turn(b, a, p);
    const Vec2 u = surface_.points[a].head<2>() - p, v = surface_.points[b].head<2>() - p;
    const double area = u.x() * v.y() - u.y() * v.x();
    return area == 0 ? 1e-300 : area;
  }

  void add(const std::array<std::uint32_t, 3>& t) {
    const std::array<Vec3, 3> corner = {surface_.points[t[0]], surface_.points[t[1]],
                                        surface_.points[t[2]]};
    Box box;
    for (const Vec3& c : corner) box.add(c);
    if (box.empty()) return;  // not a number
    const Vec2 low = (box.low.head<2>() - corner_) / spacing_m_;
    const Vec2 high = (box.high.head<2>() - corner_) / spacing_m_;
    for (int j = std::max(0, static_cast<int>(low.y())); j <= high.y() && j < kPerSide; ++j)
      for (int i = std::max(0, static_cast<int>(low.x())); i <= high.x() && i < kPerSide; ++i)
        addAt(t, corner, i, j);
  }

  void addAt(const std::array<std::uint32_t, 3>& t, const std::array<Vec3, 3>& corner, int i,
             int j) {
    const Vec2 p = corner_ + spacing_m_ * Vec2(i + 0.5, j + 0.5);
    const Vec3 share(turn(t[1], t[2], p), turn(t[2], t[0], p), turn(t[0], t[1], p));
    const bool up = (share.array() > 0).all();
    if (!up && !(share.array() < 0).all()) return;
    const double z =
        (share[0] * corner[0].z() + share[1] * corner[1].z() + share[2] * corner[2].z()) /
        share.sum();
    // A triangle that looks up is where a line going up leaves.
    passages_.push_back({static_cast<std::uint32_t>(j * kPerSide + i), up ? -1 : 1, z});
  }

  const ClosedSurface& surface_;
  double spacing_m_ = 0;
  Vec2 corner_ = Vec2::Zero();
  std::vector<Passage> passages_;
};

}  // namespace

SurfaceVolume surfaceVolume(TriangleList triangles, PointList points) {
  const ClosedSurface surface = close(triangles, points);
  return {countedVolume(surface), Columns(surface).repeatedVolume()};
}

namespace {

// A patch that hardly closes, as the root of a leg on a flank, has next to no volume, and shares of
// that mean nothing. No patch of this area holds more than a ball does: a quarter is the least.
double leastVolume(TriangleList triangles, PointList points) {
  double twiceArea = 0;
  for (const auto& t : triangles)
    twiceArea += static_cast<double>(
        (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).norm());
  const double radius = std::sqrt(0.5 * twiceArea / (4 * kPi));
  return 0.25 * (4.0 / 3) * kPi * radius * radius * radius;
}

}  // namespace

double jointVolumeLoss(TriangleList limb, TriangleList nearJoint, PointList rest,
                       PointList points) {
  const double joint =
      std::max(surfaceVolume(nearJoint, rest).occupied_m3(), leastVolume(nearJoint, rest));
  if (!(joint > 0)) return 0;
  const double before = surfaceVolume(limb, rest).occupied_m3();
  return (before - surfaceVolume(limb, points).occupied_m3()) / joint;
}

}  // namespace fascia
