#include <fascia/skin/grid/grid_topology.h>

#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/skin/grid/grid_kernels.h>
#include <fascia/skin/grid/grid_stepper.h>
#include <fascia/skin/grid/grid_stretch_limit.h>

namespace fascia {
namespace {

class GridSurfaceStepper final : public SurfaceStepper {
 public:
  explicit GridSurfaceStepper(const GridTopology& grid) : grid_(grid), stepper_(grid.layout()) {
    scratch_.resize(grid.layout());
    if (grid.bending().active()) bendingForce_.resize(grid.storage());
  }

  void forces(const VectorArray& position, VectorArray& force) override {
    gridForces(grid_.layout(), grid_.elastic().coefficients(), position, force, scratch_);
    if (grid_.bending().active()) grid_.bending().addForces(position, force);
  }

  void run(const StepInputs& inputs, int firstStep, int steps, VectorArray& position,
           VectorArray& velocity) override {
    FASCIA_ASSERT(!inputs.extraForce, "only meshes have fat that presses");
    SweepModel model{&grid_.layout(), &grid_.elastic().coefficients(), inputs};
    if (!grid_.bending().active()) {
      stepper_.run(model, firstStep, steps, position, velocity);
      return;
    }
    model.inputs.extraForce = &bendingForce_;
    for (int s = 0; s < steps; ++s) {
      bendingForce_.fill(0.f);
      grid_.bending().addForces(position, bendingForce_);
      stepper_.run(model, firstStep + s, 1, position, velocity);
    }
  }

 private:
  const GridTopology& grid_;
  GridStepper stepper_;
  SweepScratch scratch_;
  VectorArray bendingForce_;
};

}  // namespace

GridTopology::GridTopology(const GridLayout& layout, ElasticGrid elastic, Bending bending)
    : layout_(layout), elastic_(std::move(elastic)), bending_(std::move(bending)) {
  for (int j = 0; j < layout.rows; ++j)
    rows_.push_back({layout.row(j), static_cast<std::size_t>(layout.columns)});
}

std::size_t GridTopology::storageIndex(std::size_t point) const {
  const auto columns = static_cast<std::size_t>(layout_.columns);
  return layout_.at(static_cast<int>(point % columns), static_cast<int>(point / columns));
}

std::unique_ptr<SurfaceStepper> GridTopology::makeStepper() const {
  return std::make_unique<GridSurfaceStepper>(*this);
}

void GridTopology::addForceJacobian(const VectorArray& position,
                                    std::vector<Eigen::Triplet<double>>& entries) const {
  elastic_.addForceJacobian(position, false, entries);
  if (bending_.active()) bending_.addForceJacobian(position, entries);
}

StretchLimit GridTopology::makeStretchLimit() const {
  return StretchLimit(gridStretchLimits(elastic_, static_cast<float>(allowedStretch())));
}

void GridTopology::surface(const VectorArray& position, TriangleMesh& mesh) const {
  const int columns = layout_.columns, rows = layout_.rows;
  const auto across = static_cast<std::uint32_t>(columns + 1);
  const std::size_t vertices =
      static_cast<std::size_t>(columns + 1) * static_cast<std::size_t>(rows) + 2;
  const bool first = mesh.positions.size() != vertices;
  mesh.positions.resize(vertices);
  Eigen::Vector3f centers[2] = {Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero()};
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const std::size_t k = layout_.at(i % columns, j);
      const Eigen::Vector3f p(position.x[k], position.y[k], position.z[k]);
      mesh.positions[static_cast<std::size_t>(j) * across + static_cast<std::size_t>(i)] = p;
      if (i < columns && (j == 0 || j + 1 == rows)) centers[j == 0 ? 0 : 1] += p;
    }
  }
  const auto cap = static_cast<std::uint32_t>(vertices - 2);
  mesh.positions[cap] = centers[0] / static_cast<float>(columns);
  mesh.positions[cap + 1] = centers[1] / static_cast<float>(columns);

  if (first) {
    mesh.triangles.clear();
    mesh.uvs.clear();
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i <= columns; ++i)
        mesh.uvs.emplace_back(static_cast<float>(i) / static_cast<float>(columns),
                              1 - static_cast<float>(j) / static_cast<float>(rows - 1));
    mesh.uvs.emplace_back(0.5f, 1.f);
    mesh.uvs.emplace_back(0.5f, 0.f);
    const auto last = static_cast<std::uint32_t>(rows - 1) * across;
    for (std::uint32_t j = 0; j + 1 < static_cast<std::uint32_t>(rows); ++j) {
      for (std::uint32_t i = 0; i + 1 < across; ++i) {
        const std::uint32_t a = j * across + i, b = a + 1, c = a + across, d = c + 1;
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({a, d, c});
      }
    }
    for (std::uint32_t i = 0; i + 1 < across; ++i) {
      mesh.triangles.push_back({cap, i + 1, i});
      mesh.triangles.push_back({cap + 1, last + i, last + i + 1});
    }
  }
  computeNormals(mesh.positions, mesh.triangles, mesh.normals);
  // The seam's two copies of a point share one normal, or the seam would show.
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(rows); ++j) {
    Eigen::Vector3f &a = mesh.normals[j * across], &b = mesh.normals[j * across + across - 1];
    const Eigen::Vector3f sum = a + b;
    if (sum.squaredNorm() > 1e-12f) a = b = sum.normalized();
  }
}

}  // namespace fascia
