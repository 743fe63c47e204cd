#include <fascia/render/smooth_mesh.h>

#include <algorithm>
#include <unordered_map>

namespace fascia {
namespace {

using Vec3f = Eigen::Vector3f;

class Divider {
 public:
  explicit Divider(const TriangleMesh& mesh) : fine_(mesh) {
    fine_.triangles.clear();
    fine_.triangles.reserve(4 * mesh.triangles.size());
    middles_.reserve(2 * mesh.triangles.size());
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const auto& t : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
        fine_.triangles.push_back(t);
    }
  }
  TriangleMesh take() { return std::move(fine_); }

 private:
  std::uint32_t middle(std::uint32_t a, std::uint32_t b) {
    const std::uint64_t key = (static_cast<std::uint64_t>(std::min(a, b)) << 32) | std::max(a, b);
    const auto [it, isNew] =
        middles_.try_emplace(key, static_cast<std::uint32_t>(fine_.positions.size()));
    if (isNew) addMiddle(std::min(a, b), std::max(a, b));
    return it->second;
  }

  void addMiddle(std::uint32_t a, std::uint32_t b) {
    const Vec3f p0 = fine_.positions[a], p1 = fine_.positions[b];
    const Vec3f n0 = fine_.normals[a], n1 = fine_.normals[b], edge = p1 - p0;
    const Vec3f bulge = edge.dot(n1) * n1 - edge.dot(n0) * n0;
    fine_.positions.push_back(0.5f * (p0 + p1) + 0.125f * bulge);
    const Vec3f n = n0 + n1;
    fine_.normals.push_back(n.squaredNorm() > 0 ? Vec3f(n.normalized()) : n0);
    if (!fine_.uvs.empty()) fine_.uvs.push_back(0.5f * (fine_.uvs[a] + fine_.uvs[b]));
  }

  TriangleMesh fine_;
  std::unordered_map<std::uint64_t, std::uint32_t> middles_;  // by both ends of the edge
};

}  // namespace

TriangleMesh smoothed(const TriangleMesh& mesh, std::size_t triangles) {
  TriangleMesh result = mesh;
  while (!result.triangles.empty() && result.triangles.size() < triangles)
    result = Divider(result).take();
  return result;
}

}  // namespace fascia
