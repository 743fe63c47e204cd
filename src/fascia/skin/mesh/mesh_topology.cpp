#include <fascia/skin/mesh/mesh_topology.h>

#include <cmath>

#include <fascia/math/points.h>
#include <fascia/skin/mesh/mesh_kernels.h>
#include <fascia/skin/mesh/mesh_stretch_limit.h>

namespace fascia {
namespace {

class MeshSurfaceStepper final : public SurfaceStepper {
 public:
  explicit MeshSurfaceStepper(const TriangleMembrane& membrane) : stepper_(membrane) {}

  void forces(const VectorArray& position, VectorArray& force) override {
    stepper_.forces(position, force);
  }
  void run(const StepInputs& inputs, int firstStep, int steps, VectorArray& position,
           VectorArray& velocity) override {
    stepper_.run(inputs, firstStep, steps, position, velocity);
  }

 private:
  MeshStepper stepper_;
};

}  // namespace

MeshTopology::MeshTopology(std::size_t pointCount, TriangleMembrane membrane, Drawn drawn)
    : all_{0, pointCount}, membrane_(std::move(membrane)), drawn_(std::move(drawn)) {}

std::unique_ptr<SurfaceStepper> MeshTopology::makeStepper() const {
  return std::make_unique<MeshSurfaceStepper>(membrane_);
}

void MeshTopology::addForceJacobian(const VectorArray& position,
                                    std::vector<Eigen::Triplet<double>>& entries) const {
  membrane_.addForceJacobian(position, false, entries);
}

StretchLimit MeshTopology::makeStretchLimit() const {
  return StretchLimit(meshStretchLimits(membrane_.edges(static_cast<float>(allowedStretch()))));
}

void MeshTopology::surface(const VectorArray& position, TriangleMesh& mesh) const {
  const bool first = mesh.positions.size() != drawn_.points.size();
  mesh.positions.resize(drawn_.points.size());
  for (std::size_t v = 0; v < drawn_.points.size(); ++v) {
    const std::size_t k = drawn_.points[v];
    mesh.positions[v] = {position.x[k], position.y[k], position.z[k]};
  }
  if (first) {
    mesh.triangles = drawn_.triangles;
    mesh.uvs = drawn_.uvs;
  }
  if (drawn_.smooth) smoothNormals(position, mesh);
}

void MeshTopology::smoothNormals(const VectorArray& position, TriangleMesh& mesh) const {
  std::vector<Eigen::Vector3f> places(all_.count), normals;
  for (std::size_t k = 0; k < all_.count; ++k) places[k] = floatPointAt(position, k);
  std::vector<std::array<std::uint32_t, 3>> triangles = drawn_.triangles;
  for (auto& t : triangles)
    for (std::uint32_t& corner : t) corner = drawn_.points[corner];
  computeNormals(places, triangles, normals);
  mesh.normals.resize(drawn_.points.size());
  for (std::size_t v = 0; v < drawn_.points.size(); ++v)
    mesh.normals[v] = normals[drawn_.points[v]];
}

}  // namespace fascia
