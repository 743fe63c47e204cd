#include <fascia/geometry/atlas.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

using Triangle2 = std::array<Vec2, 3>;

constexpr double kFacing = 0.35;    // of a triangle with its chart's direction
constexpr double kTouching = 1e-6;  // of an edge: triangles that overlap less only touch
constexpr double kBetween = 0.004;  // between charts, of the atlas

// A direction to look from, and what is right and up then.
struct View {
  Vec3 from, right, up;
};

std::array<View, 6> sixViews() {
  std::array<View, 6> views;
  for (std::size_t n = 0; n < 6; ++n) {
    View& v = views[n];
    v.from = (n % 2 == 0 ? 1.0 : -1.0) * Vec3::Unit(static_cast<Eigen::Index>(n / 2));
    v.up = n / 2 == 1 ? Vec3(-v.from.y() * Vec3::UnitZ()) : Vec3(Vec3::UnitY());
    v.right = v.up.cross(v.from);
  }
  return views;
}

// Whether one of a's sides parts it from b.
bool isParted(const Triangle2& a, const Triangle2& b, double touching) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2 side = a[(k + 1) % 3] - a[k];
    const Vec2 outwards(side.y(), -side.x());  // corners run counter-clockwise
    double nearest = 1e300;
    for (const Vec2& p : b) nearest = std::min(nearest, outwards.dot(p - a[k]));
    if (nearest >= -touching * outwards.norm()) return true;
  }
  return false;
}

// Triangles that lie in a plane, found again by place.
class Plane {
 public:
  explicit Plane(double cell) : cell_(cell) {}

  bool overlaps(const Triangle2& t) const {
    bool found = false;
    forCells(t, [&](const Cell& cell) {
      const auto there = cells_.find(cell);
      if (there == cells_.end()) return;
      for (const std::size_t n : there->second)
        found = found || (!isParted(t, laid_[n], kTouching * cell_) &&
                          !isParted(laid_[n], t, kTouching * cell_));
    });
    return found;
  }
  void lay(const Triangle2& t) {
    forCells(t, [&](const Cell& cell) { cells_[cell].push_back(laid_.size()); });
    laid_.push_back(t);
  }

 private:
  using Cell = std::array<long, 2>;
  template <class Visit>
  void forCells(const Triangle2& t, const Visit& visit) const {
    const Vec2 low = t[0].cwiseMin(t[1]).cwiseMin(t[2]) / cell_;
    const Vec2 high = t[0].cwiseMax(t[1]).cwiseMax(t[2]) / cell_;
    for (long x = std::lround(std::floor(low.x())); x <= std::lround(std::floor(high.x())); ++x)
      for (long y = std::lround(std::floor(low.y())); y <= std::lround(std::floor(high.y())); ++y)
        visit(Cell{x, y});
  }

  double cell_;
  std::vector<Triangle2> laid_;
  std::map<Cell, std::vector<std::size_t>> cells_;
};

struct Chart {
  std::vector<std::size_t> triangles;
  std::vector<Triangle2> laid;  // of each, y up
  Vec2 low = Vec2::Constant(1e300), high = Vec2::Constant(-1e300);
  Vec2 place = Vec2::Zero();  // of `low` in the atlas, y down

  Vec2 size() const { return high - low; }
};

class AtlasMaker {
 public:
  explicit AtlasMaker(const TriangleMesh& mesh) : mesh_(mesh), taken_(mesh.triangles.size(), 0) {
    double edges = 0;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const Vec3 normal = (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0));
      normals_.push_back(normal.normalized());
      edges += (corner(t, 1) - corner(t, 0)).norm();
      for (std::size_t k = 0; k < 3; ++k)
        along_[{mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]}] = t;
    }
    cell_ = edges / static_cast<double>(std::max<std::size_t>(1, mesh.triangles.size()));
  }

  Atlas make() {
    // What faces a direction most is where its charts begin.
    std::vector<std::size_t> order(mesh_.triangles.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return normals_[a].cwiseAbs().maxCoeff() > normals_[b].cwiseAbs().maxCoeff();
    });
    for (const std::size_t t : order)
      if (!taken_[t]) grow(t);
    const Vec2 size = pack();
    return written(std::max(size.x(), size.y()));
  }

 private:
  Vec3 corner(std::size_t t, std::size_t k) const {
    return mesh_.positions[mesh_.triangles[t][k]].cast<double>();
  }

  Triangle2 seen(std::size_t t, const View& view) const {
    Triangle2 out;
    for (std::size_t k = 0; k < 3; ++k)
      out[k] = Vec2(view.right.dot(corner(t, k)), view.up.dot(corner(t, k)));
    return out;
  }

  void grow(std::size_t seed) {
    static const std::array<View, 6> kViews = sixViews();
    const View& view =
        *std::max_element(kViews.begin(), kViews.end(), [&](const View& a, const View& b) {
          return a.from.dot(normals_[seed]) < b.from.dot(normals_[seed]);
        });
    Chart chart;
    Plane plane(cell_);
    std::vector<std::size_t> queue{seed};
    for (std::size_t n = 0; n < queue.size(); ++n) {
      const std::size_t t = queue[n];
      if (taken_[t]) continue;
      const Triangle2 laid = seen(t, view);
      if (t != seed && (normals_[t].dot(view.from) < kFacing || plane.overlaps(laid))) continue;
      taken_[t] = 1;
      plane.lay(laid);
      chart.triangles.push_back(t);
      chart.laid.push_back(laid);
      for (const Vec2& p : laid)
        chart.low = chart.low.cwiseMin(p), chart.high = chart.high.cwiseMax(p);
      for (std::size_t k = 0; k < 3; ++k) {
        const auto next = along_.find({mesh_.triangles[t][(k + 1) % 3], mesh_.triangles[t][k]});
        if (next != along_.end() && !taken_[next->second]) queue.push_back(next->second);
      }
    }
    charts_.push_back(std::move(chart));
  }

  // On shelves, the highest first; returns how large the atlas has become.
  Vec2 pack() {
    double area = 0;
    for (const Chart& c : charts_) area += c.size().prod();
    const double margin = kBetween * std::sqrt(area);
    std::vector<std::size_t> order(charts_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return charts_[a].size().y() > charts_[b].size().y();
    });
    double width = 1.05 * std::sqrt(area);
    for (const Chart& c : charts_) width = std::max(width, c.size().x() + 2 * margin);
    Vec2 at(margin, margin);
    double shelf = 0;
    for (const std::size_t n : order) {
      Chart& c = charts_[n];
      if (at.x() + c.size().x() + margin > width && shelf > 0) {
        at = Vec2(margin, at.y() + shelf + margin);
        shelf = 0;
      }
      c.place = at;
      at.x() += c.size().x() + margin;
      shelf = std::max(shelf, c.size().y());
    }
    return {width, at.y() + shelf + margin};
  }

  Atlas written(double size) const {
    Atlas out;
    out.charts = charts_.size();
    out.triangles.resize(mesh_.triangles.size());
    for (const Chart& c : charts_) {
      std::map<std::uint32_t, std::uint32_t> vertexOf;
      for (std::size_t n = 0; n < c.triangles.size(); ++n)
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t point = mesh_.triangles[c.triangles[n]][k];
          const auto next = static_cast<std::uint32_t>(out.points.size());
          const auto [vertex, isNew] = vertexOf.try_emplace(point, next);
          out.triangles[c.triangles[n]][k] = vertex->second;
          if (!isNew) continue;
          const Vec2 inChart(c.laid[n][k].x() - c.low.x(), c.high.y() - c.laid[n][k].y());
          out.points.push_back(point);
          out.uvs.push_back(((c.place + inChart) / size).cast<float>());
        }
    }
    return out;
  }

  const TriangleMesh& mesh_;
  std::vector<Vec3> normals_;
  std::map<std::array<std::uint32_t, 2>, std::size_t> along_;  // triangle by each of its edges
  std::vector<char> taken_;
  double cell_ = 0;
  std::vector<Chart> charts_;
};

}  // namespace

Atlas makeAtlas(const TriangleMesh& mesh) {
  FASCIA_ASSERT(!mesh.triangles.empty(), "there is something to unfold");
  return AtlasMaker(mesh).make();
}

}  // namespace fascia
