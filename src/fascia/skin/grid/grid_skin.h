#pragma once

#include <memory>

#include <fascia/skin/grid/grid_topology.h>
#include <fascia/skin/point/flesh_attachment.h>

namespace fascia {

// What only a grid skin has; point p = j * columns + i.
struct GridSkin {
  std::shared_ptr<const GridTopology> topology;
  std::shared_ptr<const FleshAttachment> attachment;

  const GridLayout& layout() const { return topology->layout(); }
  int columns() const { return layout().columns; }
  int rows() const { return layout().rows; }
  const ElasticGrid& elastic() const { return topology->elastic(); }
  const Bending& bending() const { return topology->bending(); }
  // The inner ends of the strands, in their solids' matter.
  const TissueAnchors& anchors() const { return attachment->anchors(); }
  // The two end rows.
  const std::vector<FleshAttachment::Fixed>& fixed() const { return attachment->fixed(); }
};

}  // namespace fascia
