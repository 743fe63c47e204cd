#include <fascia/geometry/signed_mesh.h>

#include <cmath>
#include <map>
#include <tuple>

namespace fascia {
namespace {

// Weights of the nearest point below this are 0: it lies on an edge or in a corner.
constexpr double kOnEdge = 1e-9;
// Nearer than this part of the mesh's size the direction to the nearest point would be noise.
constexpr double kOnSurface = 1e-6;

using EdgeKey = std::pair<std::uint32_t, std::uint32_t>;  // lower index first

}  // namespace

SignedMesh::SignedMesh(const TriangleMesh& mesh) {
  std::map<std::tuple<float, float, float>, std::uint32_t> known;
  for (const Eigen::Vector3f& p : mesh.positions) {
    const auto [at, isNew] = known.try_emplace(
        {p.x(), p.y(), p.z()}, static_cast<std::uint32_t>(points_.positions.size()));
    if (isNew) points_.positions.push_back(p);
    point_.push_back(at->second);
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::array<std::uint32_t, 3> t{point_[a], point_[b], point_[c]};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) points_.triangles.push_back(t);
  }
  hierarchy_ = std::make_unique<TriangleHierarchy>(points_);
  for (const Eigen::Vector3f& p : points_.positions) bounds_m_.add(p.cast<double>());
  findEdges();
  findNormals();
}

void SignedMesh::refit(std::span<const Eigen::Vector3f> positions) {
  for (std::size_t v = 0; v < point_.size(); ++v) points_.positions[point_[v]] = positions[v];
  bounds_m_ = {};
  for (const Eigen::Vector3f& p : points_.positions) bounds_m_.add(p.cast<double>());
  hierarchy_->refit();
  findNormals();
}

void SignedMesh::findEdges() {
  std::map<EdgeKey, std::vector<std::size_t>> sides;
  for (std::size_t t = 0; t < points_.triangles.size(); ++t) {
    const auto& ids = points_.triangles[t];
    for (std::size_t c = 0; c < 3; ++c)
      sides[std::minmax(ids[(c + 1) % 3], ids[(c + 2) % 3])].push_back(3 * t + c);
  }
  borderEdge_.assign(3 * points_.triangles.size(), 0);
  borderCorner_.assign(points_.positions.size(), 0);
  for (const auto& [edge, of] : sides) {
    if (of.size() == 2) {
      edges_.push_back({of[0], of[1]});
      continue;
    }
    borders_ += of.size(), borderTriangles_ = of.size();
    borderCorner_[edge.first] = borderCorner_[edge.second] = 1;
    for (const std::size_t side : of) borderEdge_[side] = 1;
  }
  faceNormals_.resize(points_.triangles.size());
  edgeNormals_.resize(3 * points_.triangles.size());
  cornerNormals_.resize(points_.positions.size());
}

void SignedMesh::findNormals() {
  std::ranges::fill(cornerNormals_, Vec3(Vec3::Zero()));
  for (std::size_t t = 0; t < points_.triangles.size(); ++t) {
    const Vec3 face = (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0));
    faceNormals_[t] = face.norm() > 0 ? Vec3(face.normalized()) : Vec3::Zero();
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3 u = corner(t, c + 1) - corner(t, c), v = corner(t, c + 2) - corner(t, c);
      const double angle_rad = std::atan2(u.cross(v).norm(), u.dot(v));
      cornerNormals_[points_.triangles[t][c]] += angle_rad * faceNormals_[t];
      if (borderEdge_[3 * t + c]) edgeNormals_[3 * t + c] = faceNormals_[t];
    }
  }
  for (Vec3& n : cornerNormals_) n.normalize();
  for (const Edge& edge : edges_) {
    const Vec3 sum = faceNormals_[edge.first / 3] + faceNormals_[edge.second / 3];
    edgeNormals_[edge.first] = edgeNormals_[edge.second] = sum.normalized();
  }
}

SignedMesh::Feature SignedMesh::featureAt(std::uint32_t triangle, const Vec3& weights) const {
  std::size_t zeros = 0, zero = 0, other = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    if (weights[static_cast<Eigen::Index>(c)] < kOnEdge)
      ++zeros, zero = c;
    else
      other = c;
  }
  if (zeros == 0) return {&faceNormals_[triangle], false};
  const std::size_t edge = 3 * std::size_t{triangle} + zero;
  if (zeros == 1) return {&edgeNormals_[edge], borderEdge_[edge] != 0};
  const std::uint32_t point = points_.triangles[triangle][other];
  return {&cornerNormals_[point], borderCorner_[point] != 0};
}

std::optional<SignedMesh::Nearest> SignedMesh::nearest(const Vec3& p) const {
  const auto found = hierarchy_->closest(p);
  if (!found) return {};
  const Vec3 away = p - found->position;
  const Feature feature = featureAt(found->triangle, found->weights);
  const double sign = !feature.border && away.dot(*feature.normal) < 0 ? -1 : 1;
  const bool near = found->distance_m < kOnSurface * bounds_m_.size().maxCoeff();
  return Nearest{found->triangle, found->weights, sign * found->distance_m,
                 near ? *feature.normal : Vec3(sign / found->distance_m * away)};
}

}  // namespace fascia
