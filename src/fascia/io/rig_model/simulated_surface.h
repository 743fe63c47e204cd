#pragma once

#include <functional>
#include <span>

#include <fascia/rig/rigged_model.h>

namespace fascia {

// Makes the simulated surface of a model out of the drawn one: fills points_m, weights, triangles,
// component and vertices[].point. `positions_m` and `weights` are per vertex, finite, weights
// sorted and summing to one. Vertices at one position (within a millionth of the size) that
// continue the surface and are moved alike, by joints and as `alike` says (empty: always), become
// one point (see weldVertices); triangles without area and doubled ones are left out, which is
// noted. Throws Error if nothing is left.
void buildSimulatedSurface(std::span<const Eigen::Vector3f> positions_m,
                           std::span<const PointWeights> weights, RiggedModel& model,
                           const std::function<bool(std::uint32_t, std::uint32_t)>& alike = {});

// Notes what a person would notice at once: a height that no character has, a figure that lies on
// its back because the file's up axis is another. `scale` is the one it was read with.
void noteOddSize(double scale, RiggedModel& model);

// Keeps the heaviest of any number of influences (joint, weight), one per joint, and makes them sum
// to one. Weights that are negative or no numbers count as 0. Returns false if nothing is left.
bool packWeights(std::vector<std::pair<std::uint16_t, float>>& influences, PointWeights& out);

// Names for joints that have none, or another's: "joint 3", "hand (2)"; noted.
void makeNamesUnique(RiggedModel& model);

}  // namespace fascia
