#pragma once

#include <span>

#include <fascia/io/rig_export/rig_source.h>

namespace fascia {

// Replaces a part's joints and weights by these; `slot` numbers bones within its skin. As many sets
// of four as the heaviest vertex needs, at most two.
void setWeights(RigSource& source, std::size_t part, std::span<const PointWeights> weights,
                const std::vector<int>& slot);

// Brings a part's positions, normals, tangents and morph targets into another space, from which
// `toWorld` leads to the bind pose.
void moveGeometry(RigSource& source, std::size_t part, const Affine& toWorld);

}  // namespace fascia
