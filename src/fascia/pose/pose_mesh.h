#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include <fascia/rig/rigged_model.h>

namespace fascia {

// An imported surface and what moves it, as the stages of the pose function read it: borrowed while
// a model is built. World space of the rest posture, metres.
struct PoseSource {
  std::span<const Eigen::Vector3f> points;
  std::span<const PointWeights> weights;  // per point
  std::span<const std::array<std::uint32_t, 3>> triangles;
  std::span<const RigJoint> joints;  // parents before children
  std::span<const RigMorph> morphs{};
};

// The rest shape as a graph: each point's neighbours along edges, and beside those the points of
// other pieces that lie on it. Constant once built.
struct PoseMesh {
  struct Edge {
    std::uint32_t to;
    float weight;  // cotangent weight, clamped to a range that keeps thin triangles harmless
  };

  std::vector<Eigen::Vector3f> rest;
  std::vector<Eigen::Vector3f> normal;  // of the rest shape, unit length
  std::vector<float> area_m2;           // a third of the triangles around a point, > 0
  std::vector<float> edge_m;            // mean length of the edges of a point
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> piece;  // per point: the same for all that hang together by triangles
  std::vector<std::uint32_t> firstEdge;  // per point, one more at the end
  std::vector<Edge> edges;               // by point, each edge from both of its ends
  float size_m = 0;                      // diagonal of the box

  std::size_t size() const { return rest.size(); }
  std::span<const Edge> around(std::size_t point) const {
    return {edges.data() + firstEdge[point], edges.data() + firstEdge[point + 1]};
  }
};

PoseMesh makePoseMesh(const PoseSource& source);

// Sum of the differences of two points' weights, 0 (alike) to 2.
float weightDistance(const PointWeights& a, const PointWeights& b);

// How far each point is along edges from the nearest of some points; those that are farther than
// `most_m`: that it is more, no matter how much.
std::vector<float> wayAlongEdges(const PoseMesh& mesh, std::span<const std::uint32_t> from,
                                 float most_m = std::numeric_limits<float>::max());

// Parts `points` into compact clusters of at most so many (halves along the longest side) and calls
// add() with each; reorders them.
void forClusters(const PoseMesh& mesh, std::span<std::uint32_t> points, std::size_t most,
                 const std::function<void(std::span<const std::uint32_t>)>& add);

// The mean of each value and its neighbours', so many times.
void smoothAlongEdges(const PoseMesh& mesh, int passes, std::vector<float>& values);

}  // namespace fascia
