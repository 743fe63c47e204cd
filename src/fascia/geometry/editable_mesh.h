#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <fascia/geometry/triangle_mesh.h>
#include <fascia/math/types.h>

namespace fascia {

// A closed, 2-manifold triangle mesh whose edges can be split, collapsed and flipped. What is said
// to be possible here keeps it closed and 2-manifold; whether triangles turn over is the caller's
// business.
class EditableMesh {
 public:
  using Corners = std::array<std::uint32_t, 3>;
  struct Edge {
    std::uint32_t a, b;  // a < b
  };

  explicit EditableMesh(const TriangleMesh& mesh);

  // Numbers of points stay theirs; those of collapsed ones have no triangles.
  std::size_t pointCount() const { return places_.size(); }
  const Vec3& place(std::uint32_t p) const { return places_[p]; }
  void setPlace(std::uint32_t p, const Vec3& place) { places_[p] = place; }
  const std::vector<std::uint32_t>& around(std::uint32_t p) const { return around_[p]; }
  const Corners& corners(std::uint32_t triangle) const { return triangles_[triangle]; }
  std::size_t valence(std::uint32_t p) const { return around_[p].size(); }

  std::vector<Edge> edges() const;  // increasing
  // The corners that face an edge, left and right of the way from a to b; none if there is no such
  // edge (any more).
  std::optional<std::array<std::uint32_t, 2>> wings(std::uint32_t a, std::uint32_t b) const;

  std::uint32_t split(std::uint32_t a, std::uint32_t b, const Vec3& place);
  bool canCollapse(std::uint32_t a, std::uint32_t b) const;
  void collapse(std::uint32_t a, std::uint32_t b, const Vec3& place);  // b becomes a
  bool canFlip(std::uint32_t a, std::uint32_t b) const;
  void flip(std::uint32_t a, std::uint32_t b);

  TriangleMesh mesh() const;  // without what was collapsed

 private:
  bool isEdge(std::uint32_t a, std::uint32_t b) const;
  std::optional<std::uint32_t> triangleAlong(std::uint32_t a, std::uint32_t b) const;
  void replaceCorner(std::uint32_t triangle, std::uint32_t from, std::uint32_t to);
  void detach(std::uint32_t triangle, std::uint32_t p);

  std::vector<Vec3> places_;
  std::vector<Corners> triangles_;
  std::vector<std::vector<std::uint32_t>> around_;  // triangles of each point
};

}  // namespace fascia
