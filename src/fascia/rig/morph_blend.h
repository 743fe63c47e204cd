#pragma once

#include <span>

#include <fascia/rig/rigged_model.h>

namespace fascia {

// What morphs add to points that are moved by linear blend skinning, as players of files do it:
// `share` times Σ_morphs (w − w at rest) L d with L = Σ_joints w_j R_j. `weights`: one per morph;
// motion: per joint, rest -> now.
void addMorphs(const RiggedModel& model, std::span<const double> weights,
               std::span<const Transform> motion, double share, std::span<Eigen::Vector3f> points);

}  // namespace fascia
