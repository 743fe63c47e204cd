#include <cmath>
#include <map>
#include <string>
#include <tuple>

#include <fascia/deformable/surfaces/body_surface.h>
#include <fascia/geometry/triangle_hierarchy.h>

namespace fascia {
namespace {

// Weights of the nearest point below this are 0: it lies on an edge or in a corner.
constexpr double kOnEdge = 1e-9;

using EdgeKey = std::pair<std::uint32_t, std::uint32_t>;  // lower index first

// Triangles between points instead of vertices, so that neighbours know each other across seams.
TriangleMesh weldedByPlace(const TriangleMesh& mesh) {
  std::map<std::tuple<float, float, float>, std::uint32_t> known;
  TriangleMesh welded;
  std::vector<std::uint32_t> point;
  for (const Eigen::Vector3f& p : mesh.positions) {
    const auto [at, isNew] = known.try_emplace({p.x(), p.y(), p.z()},
                                               static_cast<std::uint32_t>(welded.positions.size()));
    if (isNew) welded.positions.push_back(p);
    point.push_back(at->second);
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::array<std::uint32_t, 3> t{point[a], point[b], point[c]};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) welded.triangles.push_back(t);
  }
  return welded;
}

[[noreturn]] void refuse(const std::string& message) {
  Issue issue{{}, "mesh of a body: " + message, "close it, and turn its triangles outward"};
  throw Error(issue);
}

// Distances are signed by the angle-weighted normals of faces, edges and corners: whichever of
// them is nearest, its normal tells the two sides apart (Bærentzen & Aanæs 2005).
class MeshSurface final : public BodySurface {
 public:
  explicit MeshSurface(TriangleMesh mesh)
      : mesh_(std::move(mesh)), points_(weldedByPlace(mesh_)), hierarchy_(points_) {
    for (const Eigen::Vector3f& p : points_.positions) bounds_m_.add(p.cast<double>());
    if (mesh_.normals.size() != mesh_.positions.size())
      computeNormals(mesh_.positions, mesh_.triangles, mesh_.normals);
    findNormals();
    if (!(enclosedVolume(points_) > 0)) refuse("found nothing inside, expected some volume");
  }
  MeshSurface(const MeshSurface&) = delete;
  MeshSurface& operator=(const MeshSurface&) = delete;

  Box bounds_m() const override { return bounds_m_; }
  const TriangleMesh& mesh() const override { return mesh_; }

  void evaluate(ConstVectors X, float* distance_m, Vectors normal) const override {
    for (std::size_t i = 0; i < X.count; ++i) {
      const Vec3 p(X.x[i], X.y[i], X.z[i]);
      const auto nearest = hierarchy_.closest(p);
      if (!nearest) {  // no place at all, so no near one
        distance_m[i] = kNowhere_m;
        normal.x[i] = normal.z[i] = 0, normal.y[i] = 1;
        continue;
      }
      const Vec3 away = p - nearest->position;
      const Vec3& pseudonormal = normalAt(*nearest);
      const double sign = away.dot(pseudonormal) < 0 ? -1 : 1;
      // Off by rounding only, the direction would be noise.
      const bool near = nearest->distance_m < kNear * bounds_m_.size().maxCoeff();
      const Vec3 n = near ? pseudonormal : Vec3(sign / nearest->distance_m * away);
      distance_m[i] = static_cast<float>(sign * nearest->distance_m);
      normal.x[i] = static_cast<float>(n.x());
      normal.y[i] = static_cast<float>(n.y());
      normal.z[i] = static_cast<float>(n.z());
    }
  }

 private:
  static constexpr double kNear = 1e-6;
  static constexpr float kNowhere_m = 1e9f;

  Vec3 corner(std::size_t t, std::size_t c) const {
    return points_.positions[points_.triangles[t][c % 3]].cast<double>();
  }

  void findNormals() {
    std::map<EdgeKey, std::vector<std::size_t>> sides;  // 3 × triangle + corner opposite
    cornerNormals_.assign(points_.positions.size(), Vec3::Zero());
    for (std::size_t t = 0; t < points_.triangles.size(); ++t) {
      const Vec3 face = (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0));
      faceNormals_.push_back(face.norm() > 0 ? Vec3(face.normalized()) : Vec3::Zero());
      for (std::size_t c = 0; c < 3; ++c) {
        const Vec3 u = corner(t, c + 1) - corner(t, c), v = corner(t, c + 2) - corner(t, c);
        const double angle_rad = std::atan2(u.cross(v).norm(), u.dot(v));
        cornerNormals_[points_.triangles[t][c]] += angle_rad * faceNormals_[t];
        const auto& ids = points_.triangles[t];
        sides[std::minmax(ids[(c + 1) % 3], ids[(c + 2) % 3])].push_back(3 * t + c);
      }
    }
    for (Vec3& n : cornerNormals_) n.normalize();
    edgeNormals_.resize(3 * points_.triangles.size());
    for (const auto& [edge, of] : sides) {
      if (of.size() != 2)
        refuse("found an edge of " + std::to_string(of.size()) + " triangles, expected 2");
      const Vec3 sum = faceNormals_[of[0] / 3] + faceNormals_[of[1] / 3];
      for (const std::size_t side : of) edgeNormals_[side] = sum.normalized();
    }
  }

  const Vec3& normalAt(const TriangleHierarchy::Nearest& nearest) const {
    const std::size_t t = nearest.triangle;
    std::size_t zeros = 0, zero = 0, other = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      if (nearest.weights[static_cast<Eigen::Index>(c)] < kOnEdge)
        ++zeros, zero = c;
      else
        other = c;
    }
    if (zeros == 0) return faceNormals_[t];
    return zeros == 1 ? edgeNormals_[3 * t + zero] : cornerNormals_[points_.triangles[t][other]];
  }

  TriangleMesh mesh_;    // as given
  TriangleMesh points_;  // the same, welded
  TriangleHierarchy hierarchy_;
  Box bounds_m_;
  std::vector<Vec3> faceNormals_, edgeNormals_, cornerNormals_;  // edge: 3 per triangle
};

}  // namespace

BodySurfacePtr makeMeshSurface(TriangleMesh mesh) {
  if (mesh.triangles.empty()) refuse("found no triangles, expected some");
  return std::make_shared<MeshSurface>(std::move(mesh));
}

}  // namespace fascia
