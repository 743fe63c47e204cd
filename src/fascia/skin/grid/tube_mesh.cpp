#include <fascia/skin/grid/tube_mesh.h>

#include <fascia/math/points.h>

namespace fascia {

std::vector<std::array<std::uint32_t, 3>> cellTriangles(const GridLayout& g) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(g.at(g.wrapped(i), j)); };
  for (int j = 0; j + 1 < g.rows; ++j)
    for (int i = 0; i < g.columns; ++i) {
      triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return triangles;
}

TriangleMesh closedTube(const GridLayout& g, const VectorArray& r) {
  TriangleMesh mesh;
  for (std::size_t k = 0; k < r.size(); ++k) mesh.positions.push_back(floatPointAt(r, k));
  mesh.triangles = cellTriangles(g);
  for (const int row : {0, g.rows - 1}) {
    Vec3 center = Vec3::Zero();
    for (int i = 0; i < g.columns; ++i) center += pointAt(r, g.at(i, row)) / g.columns;
    const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(center.cast<float>());
    for (int i = 0; i < g.columns; ++i) {
      const auto a = static_cast<std::uint32_t>(g.at(i, row)),
                 b = static_cast<std::uint32_t>(g.at(g.wrapped(i + 1), row));
      mesh.triangles.push_back(row == 0 ? std::array{middle, b, a} : std::array{middle, a, b});
    }
  }
  return mesh;
}

}  // namespace fascia
