#pragma once

#include <vector>

#include <fascia/pose/limb_parts.h>

namespace fascia {

// How much of the flesh below each point may move by itself, 0 … 1: by anatomy (names of joints),
// thickness, and how the artist weighted it. Hands, feet, skulls and pieces that follow one joint
// only (armour, robots) are hard.
std::vector<float> softnessOf(const PoseSource& source, const PoseMesh& mesh,
                              const LimbParts& parts);

// Points of pieces that a single joint carries: they stay exactly as they are.
std::vector<char> stiffPieces(const PoseSource& source);

}  // namespace fascia
