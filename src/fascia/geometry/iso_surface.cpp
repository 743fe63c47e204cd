#include <fascia/geometry/iso_surface.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>
#include <fascia/geometry/weld.h>
#include <fascia/math/points.h>

namespace fascia {
namespace {

constexpr std::size_t kBlock = 8;  // cubes along a side of a block that is decided at once
constexpr std::size_t kPointsPerTask = 256;
// Vertices keep away from the corners of the grid by so much of an edge: nearer, triangles would
// be too small to tell which way they face.
constexpr double kAway = 0.08;
constexpr int kProjections = 6;
constexpr double kArrived = 1e-5;  // of the way that a point may go

using Corner = std::array<std::size_t, 3>;

// The function at the corners of a grid of cubes.
class SampledGrid {
 public:
  SampledGrid(const ImplicitSurface& surface, double cell_m)
      : surface_(surface), cell_m_(cell_m), origin_(surface.bounds_m.low) {
    for (std::size_t a = 0; a < 3; ++a)
      cells_[a] = static_cast<std::size_t>(
          std::ceil(surface.bounds_m.size()[static_cast<Eigen::Index>(a)] / cell_m + 1e-6));
    values_.resize((cells_[0] + 1) * (cells_[1] + 1) * (cells_[2] + 1));
    sample();
  }

  std::size_t cells(std::size_t axis) const { return cells_[axis]; }
  std::size_t index(const Corner& c) const {
    return (c[2] * (cells_[1] + 1) + c[1]) * (cells_[0] + 1) + c[0];
  }
  float value(std::size_t index) const { return values_[index]; }
  Vec3 place(const Corner& c) const {
    return origin_ + cell_m_ * Vec3(static_cast<double>(c[0]), static_cast<double>(c[1]),
                                    static_cast<double>(c[2]));
  }

 private:
  // Blocks whose middle is farther from the surface than their corners take its value.
  void sample() {
    std::array<std::size_t, 3> blocks{};
    for (std::size_t a = 0; a < 3; ++a) blocks[a] = cells_[a] / kBlock + 1;
    parallelFor(blocks[0] * blocks[1] * blocks[2], [&](std::size_t n) {
      const Corner first{n % blocks[0] * kBlock, n / blocks[0] % blocks[1] * kBlock,
                         n / (blocks[0] * blocks[1]) * kBlock};
      sampleBlock(first);
    });
  }
  void sampleBlock(const Corner& first) {
    std::vector<std::size_t> indices;
    std::vector<Vec3> places;
    Corner c;
    for (c[2] = first[2]; c[2] < first[2] + kBlock && c[2] <= cells_[2]; ++c[2])
      for (c[1] = first[1]; c[1] < first[1] + kBlock && c[1] <= cells_[1]; ++c[1])
        for (c[0] = first[0]; c[0] < first[0] + kBlock && c[0] <= cells_[0]; ++c[0]) {
          indices.push_back(index(c));
          places.push_back(place(c));
        }
    if (places.empty()) return;
    const double half = 0.5 * static_cast<double>(kBlock - 1) * cell_m_;
    const Vec3 middle = place(first) + Vec3::Constant(half);
    std::vector<float> found(1);
    evaluate({&middle, 1}, found);
    const double reach = surface_.lipschitz * std::sqrt(3.0) * half;
    if (std::abs(double{found[0]}) > reach) {
      for (const std::size_t i : indices) values_[i] = found[0];
      return;
    }
    found.resize(places.size());
    evaluate(places, found);
    for (std::size_t i = 0; i < indices.size(); ++i) values_[indices[i]] = found[i];
  }
  void evaluate(std::span<const Vec3> places, std::vector<float>& found) const {
    VectorArray at(places.size()), gradient(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) setPoint(at, i, places[i]);
    surface_.evaluate(view(at, 0, places.size()), found.data(), view(gradient, 0, places.size()));
  }

  const ImplicitSurface& surface_;
  double cell_m_;
  Vec3 origin_;
  std::array<std::size_t, 3> cells_{};
  std::vector<float> values_;
};

// Walks the tetrahedra and makes the triangles that separate their corners.
class Marcher {
 public:
  explicit Marcher(const SampledGrid& grid) : grid_(grid) {}

  TriangleMesh march() {
    Corner c;
    for (c[2] = 0; c[2] < grid_.cells(2); ++c[2])
      for (c[1] = 0; c[1] < grid_.cells(1); ++c[1])
        for (c[0] = 0; c[0] < grid_.cells(0); ++c[0]) cube(c);
    return std::move(mesh_);
  }

 private:
  bool isInside(const Corner& c) const { return grid_.value(grid_.index(c)) < 0; }

  void cube(const Corner& low) {
    const bool inside = isInside(low);
    bool mixed = false;
    for (std::size_t k = 1; k < 8 && !mixed; ++k)
      mixed = isInside({low[0] + (k & 1), low[1] + (k >> 1 & 1), low[2] + (k >> 2)}) != inside;
    if (!mixed) return;
    constexpr std::array<std::array<std::size_t, 3>, 6> kOrders{
        {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
    for (const auto& order : kOrders) {
      std::array<Corner, 4> corners{low, low, low, low};
      for (std::size_t step = 0; step < 3; ++step)
        for (std::size_t k = step + 1; k < 4; ++k) ++corners[k][order[step]];
      tetrahedron(corners);
    }
  }

  void tetrahedron(const std::array<Corner, 4>& corners) {
    std::array<Corner, 4> in, out;
    std::size_t ins = 0, outs = 0;
    for (const Corner& c : corners) (isInside(c) ? in[ins++] : out[outs++]) = c;
    if (ins == 0 || outs == 0) return;
    const Vec3 outwards = grid_.place(out[0]) - grid_.place(in[0]);
    const auto at = [&](std::size_t i, std::size_t o) { return vertex(in[i], out[o]); };
    if (ins == 1) return triangle(at(0, 0), at(0, 1), at(0, 2), outwards);
    if (outs == 1) return triangle(at(0, 0), at(1, 0), at(2, 0), outwards);
    triangle(at(0, 0), at(0, 1), at(1, 1), outwards);
    triangle(at(0, 0), at(1, 1), at(1, 0), outwards);
  }

  // Any way from a corner inside to one outside passes the plane of the triangle the right way.
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, const Vec3& outwards) {
    const auto at = [&](std::uint32_t v) { return Vec3(places_[v]); };
    const Vec3 normal = (at(b) - at(a)).cross(at(c) - at(a));
    if (normal.dot(outwards) < 0) std::swap(b, c);
    mesh_.triangles.push_back({a, b, c});
  }

  std::uint32_t vertex(const Corner& in, const Corner& out) {
    const Corner low{std::min(in[0], out[0]), std::min(in[1], out[1]), std::min(in[2], out[2])};
    const std::size_t kind =
        (in[0] != out[0] ? 1u : 0u) + (in[1] != out[1] ? 2u : 0u) + (in[2] != out[2] ? 4u : 0u);
    const auto next = static_cast<std::uint32_t>(places_.size());
    const auto [found, isNew] = known_.try_emplace(8 * grid_.index(low) + kind, next);
    if (!isNew) return found->second;
    const double a = grid_.value(grid_.index(in)), b = grid_.value(grid_.index(out));
    const double t = std::clamp(a / (a - b), kAway, 1 - kAway);
    places_.push_back(grid_.place(in) + t * (grid_.place(out) - grid_.place(in)));
    mesh_.positions.push_back(places_.back().cast<float>());
    return next;
  }

  const SampledGrid& grid_;
  TriangleMesh mesh_;
  std::vector<Vec3> places_;
  std::unordered_map<std::size_t, std::uint32_t> known_;  // only looked up, never walked
};

// Pieces that enclose a negative volume are walls of hollows.
TriangleMesh withoutHollows(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> component;
  const std::uint32_t count = numberComponents(mesh.positions.size(), mesh.triangles, component);
  std::vector<double> volume(count);
  const Vec3 origin =
      mesh.positions.empty() ? Vec3(Vec3::Zero()) : mesh.positions[0].cast<double>();
  for (const auto& t : mesh.triangles) {
    const auto at = [&](std::size_t c) {
      return Vec3(mesh.positions[t[c]].cast<double>() - origin);
    };
    volume[component[t[0]]] += at(0).dot(at(1).cross(at(2)));
  }
  TriangleMesh out;
  std::vector<std::uint32_t> number(mesh.positions.size());
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (volume[component[v]] <= 0) continue;
    number[v] = static_cast<std::uint32_t>(out.positions.size());
    out.positions.push_back(mesh.positions[v]);
  }
  for (const auto& t : mesh.triangles)
    if (volume[component[t[0]]] > 0)
      out.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  return out;
}

}  // namespace

TriangleMesh isoSurface(const ImplicitSurface& surface, double cell_m) {
  FASCIA_ASSERT(!surface.bounds_m.empty() && cell_m > 0, "there is a space to search");
  const double cells = (surface.bounds_m.size().array() / cell_m + 1).prod();
  if (cells > kMostCells) cell_m *= 1.01 * std::cbrt(cells / kMostCells);
  return withoutHollows(Marcher(SampledGrid(surface, cell_m)).march());
}

void projectOnto(const ImplicitSurface& surface, double most_m, std::span<Vec3> points) {
  const std::size_t tasks = (points.size() + kPointsPerTask - 1) / kPointsPerTask;
  parallelFor(tasks, [&](std::size_t task) {
    const std::span<Vec3> own = points.subspan(
        task * kPointsPerTask, std::min(kPointsPerTask, points.size() - task * kPointsPerTask));
    VectorArray at(own.size()), gradient(own.size());
    std::vector<float> value(own.size());
    const std::vector<Vec3> start(own.begin(), own.end());
    double farthest = 1;  // from the surface, of most_m
    for (int n = 0; n < kProjections && farthest > kArrived; ++n) {
      farthest = 0;
      for (std::size_t i = 0; i < own.size(); ++i) setPoint(at, i, own[i]);
      surface.evaluate(view(at, 0, own.size()), value.data(), view(gradient, 0, own.size()));
      for (std::size_t i = 0; i < own.size(); ++i) {
        const Vec3 g = pointAt(gradient, i);
        // Where solids of the same distance meet the gradient vanishes: no way is better there.
        const Vec3 way = double{value[i]} / std::max(g.squaredNorm(), 0.05) * g;
        own[i] -= way;
        farthest = std::max(farthest, way.norm() / most_m);
        const Vec3 gone = own[i] - start[i];
        if (gone.norm() > most_m) own[i] = start[i] + most_m * gone.normalized();
      }
    }
  });
}

}  // namespace fascia
