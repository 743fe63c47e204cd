#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/skin/point/point_model.h>
#include <fascia/skin/point/stretch_kernels.h>

namespace fascia {

// Keeps the edges of a surface from growing longer than they may: a hierarchy of one-sided limits,
// coarsest first. A chord is never longer than the way along the edges that it spans, so that
// levels do not contradict each other; without the coarse ones a pull would pass one edge a sweep.
// A level's edges are swept there and back (one way alone would pump energy in), and the points
// below go along with what they lie between. Points that part along an edge that is too long stop
// doing so. What is not too long keeps every bit. One thread: it has work in few intervals.
class StretchLimit {
 public:
  struct Edge {
    std::uint32_t a, b;  // storage indices
    float longest_m;
  };
  // A point of the next finer level that goes with this level's.
  struct Follower {
    std::uint32_t point;
    std::array<std::uint32_t, 4> leaders;
    std::array<float, 4> weights;
  };
  struct Level {
    std::vector<Edge> edges;  // in the order of the sweep
    std::vector<Follower> followers;
  };

  StretchLimit() = default;
  explicit StretchLimit(std::vector<Level> levels);

  // Whether an edge is longer than it may be by more than this part of that.
  bool exceeded(const VectorArray& position, float share) const;
  // The share of all edges that are.
  double shareExceeding(const VectorArray& position, float share) const;
  // Points that are not free stay where they are. Allocates when anything is too long for the first
  // time.
  void apply(const PointModel& points, VectorArray& position, VectorArray& velocity);

 private:
  void sweep(const Level& level, const PointModel& points, VectorArray& position,
             VectorArray& velocity) const;
  static void shorten(const Edge& edge, const PointModel& points, VectorArray& position,
                      VectorArray& velocity);
  static void follow(const Level& level, const PointModel& points, const VectorArray& before,
                     VectorArray& values);

  std::vector<Level> levels_;        // the last one has all edges
  std::vector<EdgeRun> runs_;        // of those
  FloatArray longest_m_;             // in their order
  VectorArray position_, velocity_;  // before a level was swept
};

}  // namespace fascia
