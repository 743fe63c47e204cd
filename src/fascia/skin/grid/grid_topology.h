#pragma once

#include <cmath>

#include <fascia/skin/grid/bending.h>
#include <fascia/skin/grid/elastic_grid.h>
#include <fascia/skin/grid/grid_layout.h>
#include <fascia/skin/point/skin_topology.h>

namespace fascia {

// A skin on an M x N grid: Terzopoulos' membrane and bending (1987).
class GridTopology final : public SkinTopology {
 public:
  GridTopology(const GridLayout& layout, ElasticGrid elastic, Bending bending);

  const GridLayout& layout() const { return layout_; }
  const ElasticGrid& elastic() const { return elastic_; }
  const Bending& bending() const { return bending_; }

  std::size_t storage() const override { return layout_.storage(); }
  std::size_t pointCount() const override { return layout_.pointCount(); }
  std::size_t storageIndex(std::size_t point) const override;
  std::span<const Range> ranges() const override { return rows_; }
  void complete(VectorArray& values) const override { fillPads(layout_, values); }
  std::unique_ptr<SurfaceStepper> makeStepper() const override;
  void addForceJacobian(const VectorArray& position,
                        std::vector<Eigen::Triplet<double>>& entries) const override;
  double maxStretch(const VectorArray& position) const override {
    return elastic_.maxStretch(position);
  }
  double allowedStretch() const override { return std::sqrt(1 + elastic_.coefficients().cap); }
  StretchLimit makeStretchLimit() const override;
  void surface(const VectorArray& position, TriangleMesh& mesh) const override;

 private:
  GridLayout layout_;
  ElasticGrid elastic_;
  Bending bending_;
  std::vector<Range> rows_;
};

}  // namespace fascia
