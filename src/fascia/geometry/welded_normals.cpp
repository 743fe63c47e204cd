#include <fascia/geometry/welded_normals.h>

#include <algorithm>
#include <numeric>
#include <tuple>

#include <fascia/base/assert.h>

namespace fascia {

WeldedNormals::WeldedNormals(const TriangleMesh& mesh) : triangles_(mesh.triangles) {
  const auto place = [&](std::uint32_t v) {
    const Eigen::Vector3f& p = mesh.positions[v];
    return std::tuple(p.x(), p.y(), p.z(), v);
  };
  std::vector<std::uint32_t> order(mesh.positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return place(a) < place(b); });
  weld_.resize(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::uint32_t v = order[i];
    const bool same = i > 0 && mesh.positions[order[i - 1]] == mesh.positions[v];
    weld_[v] = same ? weld_[order[i - 1]] : v;
  }
}

void WeldedNormals::compute(const std::vector<Eigen::Vector3f>& positions,
                            std::vector<Eigen::Vector3f>& normals) const {
  FASCIA_ASSERT(positions.size() == weld_.size(), "the mesh keeps its points");
  normals.assign(positions.size(), Eigen::Vector3f::Zero());
  for (const auto& [a, b, c] : triangles_) {
    const Eigen::Vector3f n = (positions[b] - positions[a]).cross(positions[c] - positions[a]);
    for (const std::uint32_t v : {a, b, c}) normals[weld_[v]] += n;
  }
  for (std::size_t v = 0; v < normals.size(); ++v) {
    if (weld_[v] != v) continue;
    const float length = normals[v].norm();
    normals[v] = length > 0 ? Eigen::Vector3f(normals[v] / length) : Eigen::Vector3f::UnitY();
  }
  for (std::size_t v = 0; v < normals.size(); ++v) normals[v] = normals[weld_[v]];
}

}  // namespace fascia
