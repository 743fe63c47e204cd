#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <fascia/geometry/triangle_hierarchy.h>
#include <fascia/geometry/triangle_mesh.h>

namespace fascia {

// Signed distances to a triangle mesh, negative inside, by the angle-weighted normals of faces,
// edges and corners: whichever of them is nearest, its normal tells the two sides apart (Bærentzen
// & Aanæs 2005). Vertices at the same place are one point, so that neighbours know each other
// across seams. The mesh may move: refit.
class SignedMesh {
 public:
  explicit SignedMesh(const TriangleMesh& mesh);
  SignedMesh(const SignedMesh&) = delete;
  SignedMesh& operator=(const SignedMesh&) = delete;

  // `positions` of the vertices the mesh was made with, in their order. Allocates nothing.
  void refit(std::span<const Eigen::Vector3f> positions);

  const TriangleMesh& welded() const { return points_; }  // without normals
  std::uint32_t pointOf(std::size_t vertex) const { return point_[vertex]; }
  const Box& bounds_m() const { return bounds_m_; }
  // Triangles at the edges that do not have two, 0 if the mesh is closed; and how many some such
  // edge has.
  std::size_t borderCount() const { return borders_; }
  std::size_t borderTriangles() const { return borderTriangles_; }

  struct Nearest {
    std::uint32_t triangle;  // of welded()
    Vec3 weights;            // of its corners
    double distance_m;       // signed
    Vec3 normal;             // out of the mesh, of unit length
  };
  // Nothing only for places that are none. Beyond a border there is no inside: the distance is
  // positive where the nearest point lies on one.
  std::optional<Nearest> nearest(const Vec3& p) const;

 private:
  Vec3 corner(std::size_t t, std::size_t c) const {
    return points_.positions[points_.triangles[t][c % 3]].cast<double>();
  }
  void findEdges();
  void findNormals();
  struct Feature {
    const Vec3* normal;
    bool border;
  };
  Feature featureAt(std::uint32_t triangle, const Vec3& weights) const;

  TriangleMesh points_;
  std::vector<std::uint32_t> point_;  // of each vertex
  std::unique_ptr<TriangleHierarchy> hierarchy_;
  Box bounds_m_;
  struct Edge {
    std::size_t first, second;  // 3 × triangle + corner opposite
  };
  std::vector<Edge> edges_;
  std::vector<char> borderEdge_, borderCorner_;  // as the normals
  std::size_t borders_ = 0, borderTriangles_ = 0;
  std::vector<Vec3> faceNormals_, edgeNormals_, cornerNormals_;  // edge: 3 per triangle
};

}  // namespace fascia
