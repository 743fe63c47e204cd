#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/field/field.h>

namespace fascia {

// Places on the faces of a skin, between its points. Where flesh is curved more finely than points
// lie, faces cut it though no point does.
struct FaceSamples {
  struct Sample {
    std::array<std::uint32_t, 3> corners;  // storage indices of points
    std::array<float, 3> weights;          // barycentric: sum 1
  };
  // Samples whose faces lie together, and the points that these faces hang between.
  struct Block {
    std::uint32_t firstSample, sampleCount;
    std::uint32_t firstPoint, pointCount;
  };
  // Of all edges of the faces around points that samples lie between.
  struct Edge {
    std::array<std::uint32_t, 2> ends;
    float rest_m;  // its length
  };
  std::vector<Sample> samples;
  std::vector<Block> blocks;
  std::vector<std::uint32_t> points;  // of blocks, without repetition within one
  std::vector<Edge> edges;

  bool empty() const { return samples.empty(); }
};

// Samples on faces that sink into the fat at rest, whose thickness their corners keep: the deeper a
// face sinks, the more, so that what is left between them is about `tolerance_m`. Faces that come
// after each other make blocks.
FaceSamples sampleFaces(const DistanceField& field,
                        std::span<const std::array<std::uint32_t, 3>> faces,
                        const VectorArray& rest, double fat_m, double tolerance_m);
// Takes the edges' lengths from another rest shape.
void measureEdges(const VectorArray& rest, FaceSamples& faces);

}  // namespace fascia
