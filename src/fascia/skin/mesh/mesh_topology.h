#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <fascia/skin/mesh/triangle_membrane.h>
#include <fascia/skin/point/skin_topology.h>

namespace fascia {

// A skin on a triangle mesh. Points are numbered by storage.
class MeshTopology final : public SkinTopology {
 public:
  // What is drawn: its vertices are points of the skin, several of them for one point at a seam.
  struct Drawn {
    std::vector<std::uint32_t> points;  // storage index of each drawn vertex
    std::vector<Eigen::Vector2f> uvs;
    std::vector<std::array<std::uint32_t, 3>> triangles;  // of drawn vertices
    // Whether normals are written: smooth across seams. Those of an imported mesh are its artist's.
    bool smooth = false;
  };

  MeshTopology(std::size_t pointCount, TriangleMembrane membrane, Drawn drawn);

  const TriangleMembrane& membrane() const { return membrane_; }

  std::size_t storage() const override { return membrane_.storage(); }
  std::size_t pointCount() const override { return all_.count; }
  std::size_t storageIndex(std::size_t point) const override { return point; }
  std::span<const Range> ranges() const override { return {&all_, 1}; }
  void complete(VectorArray&) const override {}  // its padding belongs to no triangle
  std::unique_ptr<SurfaceStepper> makeStepper() const override;
  void addForceJacobian(const VectorArray& position,
                        std::vector<Eigen::Triplet<double>>& entries) const override;
  double maxStretch(const VectorArray& position) const override {
    return membrane_.maxStretch(position);
  }
  double allowedStretch() const override { return std::sqrt(1 + membrane_.cap()); }
  StretchLimit makeStretchLimit() const override;
  void surface(const VectorArray& position, TriangleMesh& mesh) const override;

 private:
  void smoothNormals(const VectorArray& position, TriangleMesh& mesh) const;

  Range all_;
  TriangleMembrane membrane_;
  Drawn drawn_;
};

}  // namespace fascia
