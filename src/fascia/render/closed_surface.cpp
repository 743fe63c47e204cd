#include <fascia/render/closed_surface.h>

#include <algorithm>
#include <numeric>
#include <tuple>

namespace fascia {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

// For each point the first one at its place.
std::vector<std::uint32_t> firstAtPlace(const std::vector<Eigen::Vector3f>& points) {
  std::vector<std::uint32_t> order(points.size()), first(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, {}, [&](std::uint32_t v) {
    return std::tuple(points[v].x(), points[v].y(), points[v].z(), v);
  });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && points[order[i - 1]] == points[order[i]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

// Those that are more than a line.
Triangles weldedTriangles(const TriangleMesh& mesh) {
  const std::vector<std::uint32_t> first = firstAtPlace(mesh.positions);
  Triangles out;
  out.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const std::array<std::uint32_t, 3> w{first[t[0]], first[t[1]], first[t[2]]};
    if (w[0] != w[1] && w[1] != w[2] && w[2] != w[0]) out.push_back(w);
  }
  return out;
}

// Every edge is run along as often in one direction as in the other.
bool isClosed(const Triangles& triangles) {
  std::vector<std::uint64_t> forth, back;
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t a = t[k], b = t[(k + 1) % 3];
      forth.push_back(a << 32 | b), back.push_back(b << 32 | a);
    }
  std::ranges::sort(forth);
  std::ranges::sort(back);
  return forth == back;
}

// Surfaces that share no point, as a forest: each point leads to the first of its surface.
class Surfaces {
 public:
  Surfaces(const Triangles& triangles, std::size_t points) : parent_(points) {
    std::iota(parent_.begin(), parent_.end(), 0u);
    for (const auto& t : triangles)
      for (const std::uint32_t v : {t[1], t[2]}) {
        const std::uint32_t a = find(t[0]), b = find(v);
        parent_[std::max(a, b)] = std::min(a, b);
      }
  }
  std::uint32_t find(std::uint32_t v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace

bool facesOutwards(const TriangleMesh& mesh) {
  if (!std::ranges::all_of(mesh.positions, [](const auto& p) { return p.allFinite(); }))
    return false;
  const Triangles triangles = weldedTriangles(mesh);
  if (triangles.empty() || !isClosed(triangles)) return false;
  Surfaces surfaces(triangles, mesh.positions.size());
  std::vector<double> volume_m3(mesh.positions.size(), 0.0);
  for (const auto& [a, b, c] : triangles) {
    const std::uint32_t surface = surfaces.find(a);
    const Vec3 origin = mesh.positions[surface].cast<double>();  // near: little cancels
    const auto from = [&](std::uint32_t v) {
      return Vec3(mesh.positions[v].cast<double>() - origin);
    };
    volume_m3[surface] += from(a).dot(from(b).cross(from(c))) / 6;
  }
  return std::ranges::all_of(triangles,
                             [&](const auto& t) { return volume_m3[surfaces.find(t[0])] > 0; });
}

}  // namespace fascia
