#include <fascia/field/shapes/lattice.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>

namespace fascia {

namespace {

struct Row {
  double latitude_rad;
  bool upper;
};

std::vector<Row> latticeRows(int half, bool splitEquator) {
  std::vector<Row> rows;
  for (int i = 0; i <= half; ++i) rows.push_back({0.5 * kPi * (half - i) / half, true});
  for (int i = splitEquator ? 0 : 1; i <= half; ++i) {
    rows.push_back({-0.5 * kPi * i / half, false});
  }
  return rows;
}

// Exact zeros on the axes and at the seam, so that the mesh closes to the last bit.
Vec3 globeDirection(double latitude_rad, int column, int columns) {
  const double longitude_rad = 2 * kPi * (column % columns) / columns;
  const bool pole = std::abs(latitude_rad) >= 0.5 * kPi;
  const double c = pole ? 0 : std::cos(latitude_rad);
  return {c * std::cos(longitude_rad), c * std::sin(longitude_rad), std::sin(latitude_rad)};
}

void addQuad(TriangleMesh& mesh, std::uint32_t a, std::uint32_t below, bool top, bool bottom) {
  if (!top) mesh.triangles.push_back({a, below, a + 1});
  if (!bottom) mesh.triangles.push_back({a + 1, below, below + 1});
}

}  // namespace

TriangleMesh latticeSurface(
    int detail, bool splitEquator,
    const std::function<SurfacePoint(const Vec3& direction, bool upper)>& surface) {
  const int columns = std::clamp(detail, 3, 4096);
  const std::vector<Row> rows = latticeRows(std::max(2, (columns + 3) / 4), splitEquator);
  TriangleMesh mesh;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (int c = 0; c <= columns; ++c) {
      const SurfacePoint point =
          surface(globeDirection(rows[r].latitude_rad, c, columns), rows[r].upper);
      FASCIA_ASSERT(point.position_m.allFinite() && isUnit(point.normal),
                    "a surface has places and unit normals");
      mesh.positions.push_back(point.position_m.cast<float>());
      mesh.normals.push_back(point.normal.cast<float>());
      mesh.uvs.emplace_back(static_cast<float>(c) / static_cast<float>(columns),
                            static_cast<float>(r) / static_cast<float>(rows.size() - 1));
    }
  }
  const auto stride = static_cast<std::uint32_t>(columns + 1);
  for (std::uint32_t r = 0; r + 1 < rows.size(); ++r) {
    for (std::uint32_t c = 0; c + 1 < stride; ++c) {
      addQuad(mesh, r * stride + c, (r + 1) * stride + c, r == 0, r + 2 == rows.size());
    }
  }
  return mesh;
}

}  // namespace fascia
