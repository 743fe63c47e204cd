#pragma once

#include <optional>
#include <span>

#include <fascia/geometry/box_tree.h>
#include <fascia/geometry/triangle_mesh.h>

namespace fascia {

// Nearest-point and ray queries on a triangle mesh. Keeps a reference to the mesh, which must
// outlive it; after its positions move, refit.
class TriangleHierarchy {
 public:
  explicit TriangleHierarchy(const TriangleMesh& mesh);
  void refit();

  struct Nearest {
    std::uint32_t triangle;
    Vec3 position, weights;  // barycentric
    double distance_m;
  };
  // The mesh's nearest point within `limit_m`, the lowest triangle among equals.
  std::optional<Nearest> closest(const Vec3& p, double limit_m = 1e150) const;

  struct Hit {
    std::uint32_t triangle;
    double t;  // position = origin + t direction
    Vec3 weights;
  };
  // The first crossing with t in [0, tMax], from either side of a triangle.
  std::optional<Hit> firstHit(const Vec3& origin, const Vec3& direction, double tMax = 1e150) const;
  // Every crossing with t in [0, tMax], in the order of t, then of triangles; replaces `hits`. For
  // rays that are followed through many surfaces: it costs no more than firstHit() where nothing is
  // near.
  void allHits(const Vec3& origin, const Vec3& direction, double tMax,
               std::vector<Hit>& hits) const;
  // Of one triangle only.
  std::optional<Hit> hitOf(std::uint32_t triangle, const Vec3& origin, const Vec3& direction) const;

 private:
  std::array<Vec3, 3> corners(std::uint32_t triangle) const;
  void updateBoxes();

  const TriangleMesh* mesh_;
  std::vector<Box> boxes_;
  BoxTree tree_;
};

}  // namespace fascia
