#include <fascia/render/crease_normals.h>

#include <algorithm>
#include <numeric>

namespace fascia {
namespace {

using Vec3f = Eigen::Vector3f;

constexpr float kSameNormal = 0.99f;  // cosine; below it two normals at one point are a crease
constexpr float kOddNormal = 0.2f;    // cosine; the file's normal is a mistake beyond that

// For each vertex the first one of its point whose normal is alike.
std::vector<std::uint32_t> smoothingGroups(const RiggedModel& model) {
  const std::vector<RigVertex>& vertices = model.vertices;
  std::vector<std::uint32_t> order(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return vertices[a].point < vertices[b].point;
  });
  std::vector<std::uint32_t> first(vertices.size());
  std::vector<std::uint32_t> groups;  // of the point at hand
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::uint32_t v = order[i];
    if (i == 0 || vertices[order[i - 1]].point != vertices[v].point) groups.clear();
    const auto alike = std::find_if(groups.begin(), groups.end(), [&](std::uint32_t g) {
      return vertices[g].normal.dot(vertices[v].normal) > kSameNormal;
    });
    first[v] = alike != groups.end() ? *alike : v;
    if (alike == groups.end()) groups.push_back(v);
  }
  return first;
}

}  // namespace

CreaseNormals::CreaseNormals(const RiggedModel& model)
    : triangles_(model.drawnTriangles), first_(smoothingGroups(model)) {
  std::vector<Vec3f> positions;
  positions.reserve(model.vertices.size());
  for (const RigVertex& vertex : model.vertices) positions.push_back(model.points_m[vertex.point]);
  sum(positions, rest_);
  authored_.reserve(model.vertices.size());
  for (std::size_t v = 0; v < model.vertices.size(); ++v) {
    const Vec3f& normal = model.vertices[v].normal;
    authored_.push_back(normal.dot(rest_[v]) > kOddNormal ? normal : rest_[v]);
  }
}

// Area-weighted over the triangles of each smoothing group.
void CreaseNormals::sum(std::span<const Vec3f> positions, std::vector<Vec3f>& normals) const {
  normals.assign(positions.size(), Vec3f::Zero());
  for (const auto& [a, b, c] : triangles_) {
    const Vec3f cross = (positions[b] - positions[a]).cross(positions[c] - positions[a]);
    for (const std::uint32_t v : {a, b, c}) normals[first_[v]] += cross;
  }
  for (std::size_t v = 0; v < normals.size(); ++v) {
    if (first_[v] != v) continue;
    const float largest = normals[v].cwiseAbs().maxCoeff();
    // Scaled first: the square of a small triangle's area underflows.
    normals[v] = largest > 0 ? Vec3f((normals[v] / largest).normalized()) : Vec3f::UnitY();
  }
  for (std::size_t v = 0; v < normals.size(); ++v) normals[v] = normals[first_[v]];
}

// The file's normals turn as the computed ones do: what an artist bent by hand stays bent.
void CreaseNormals::compute(std::span<const Vec3f> positions, std::vector<Vec3f>& normals) const {
  sum(positions, normals);
  for (std::size_t v = 0; v < normals.size(); ++v)
    normals[v] = Eigen::Quaternionf::FromTwoVectors(rest_[v], normals[v]) * authored_[v];
}

}  // namespace fascia
