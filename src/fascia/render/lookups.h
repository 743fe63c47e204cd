#pragma once

#include <cstdint>
#include <vector>

namespace fascia {

// Diffuse light on skin, pre-integrated around a cylinder of radius 1/κ: rows = κ × scatter length
// from 0 (flat) to 1, columns = n·l from -1 to 1, three floats (red travels farthest).
// After Penner & Borshukov, "Pre-Integrated Skin Shading", GPU Pro 2 (2011), with the sum of
// Gaussians of d'Eon & Luebke, GPU Gems 3, chapter 14. Changed: a cylinder in place of their ring,
// where each Gaussian stays a Gaussian in the angle and narrow ones cannot be missed.
std::vector<float> scatterLookup(int width, int height);

// Smooth noise that tiles: two octaves of values in [0, 255], side x side.
std::vector<std::uint8_t> tileableNoise(int side);

}  // namespace fascia
