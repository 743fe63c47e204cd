#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include <fascia/geometry/triangle_mesh.h>

namespace fascia {

// How good a deformation is: every measure is a closed definition that its test checks on a shape
// with a known answer. Metres; triangles are counter-clockwise seen from outside. Explained for
// people in docs/deformation.md.

using TriangleList = std::span<const std::array<std::uint32_t, 3>>;
using PointList = std::span<const Eigen::Vector3f>;

// --- Crossings (crossings.cpp)

// Two triangles that cross, by their numbers; first < second.
struct CrossingPair {
  std::uint32_t first, second;
  friend auto operator<=>(const CrossingPair&, const CrossingPair&) = default;
};

// All pairs of triangles that share no point and of which an edge of one passes through the inside
// of the other; increasing. Touching, and overlapping in one plane, is not crossing.
std::vector<CrossingPair> findCrossings(TriangleList triangles, PointList points);
std::size_t crossingTrianglePairs(TriangleList triangles, PointList points);
// How many of `now` are not in `before`; both increasing.
std::size_t newCrossings(std::span<const CrossingPair> before, std::span<const CrossingPair> now);

// Surfaces nearer than this share of their size touch (new_crossings.cpp): a fifth of a millimetre
// on a person. A larger one would forgive thin clothes that a body comes through; a smaller one
// counts what only rounding makes of shells that lie on each other.
inline constexpr double kTouching = 1e-4;

// The crossings of a pose that are not those of its rest shape; increasing. Shells that lie on each
// other at rest would cross and part again by rounding, so that a pair is no crossing
// - if it has one at rest (`atRest`: findCrossings of `rest`);
// - if two corners lie on one place (within the tolerance) at rest and still do: as triangles that
//   share a point;
// - if it lies within the tolerance at rest and a translation of no more than that parts it again.
std::vector<CrossingPair> newCrossings(TriangleList triangles, PointList rest,
                                       std::span<const CrossingPair> atRest, PointList points,
                                       double tolerance_m);

// --- Stretch (edge_stretch.cpp)

// Largest and 99th percentile of edge length over rest length, each edge once. Edges without rest
// length are left out; 1 where there are no others.
struct EdgeStretch {
  double largest = 1, percentile99 = 1;
};
EdgeStretch edgeStretch(TriangleList triangles, PointList rest, PointList points);

// --- Lumps (lumpiness.cpp)

// What lumpiness() needs of a rest shape, found once. A point's detail is x − mean of its
// neighbours: the umbrella Laplacian (Taubin 1995). Points on open edges and with fewer than three
// neighbours have none.
class RestDetail {
 public:
  RestDetail(TriangleList triangles, PointList rest);
  std::size_t pointCount() const { return first_.size() - 1; }
  bool has(std::size_t point) const { return edge_m_[point] > 0; }
  // |n · (Rᵀ d' − d)| / e of one point that has detail: d at rest, d' now, n the rest normal, e the
  // mean length of the point's edges at rest, R the rotation that fits the ring of neighbours at
  // rest best to the one now.
  double change(std::size_t point, PointList points) const;

 private:
  std::vector<std::uint32_t> first_, neighbour_;  // first_: one more than points
  std::vector<Eigen::Vector3f> rest_, normal_;
  std::vector<double> edge_m_;  // 0: no detail
};

// How much a surface's finest detail changes, in edge lengths: 0 for a rigid motion. It ranks
// pictures as the eye does, which sees a lump or a crease that was not there at once. 0 where no
// point has detail.
struct Lumpiness {
  double rms = 0, percentile99 = 0;
};
Lumpiness lumpiness(const RestDetail& detail, std::span<const std::uint32_t> which,
                    PointList points);

// --- Turned triangles (turned_triangles.cpp)

// Triangles whose normal stands more than 90° off where the bones carry it: torn, or folded inside
// out. `carried`: of every point the weighted sum of its bones' rotations; a triangle's is the sum
// of its corners'. Triangles that are no numbers count too.
std::size_t turnedTriangles(TriangleList triangles, PointList rest,
                            std::span<const Eigen::Matrix3f> carried, PointList points);

// --- Volume (occupied_volume.cpp)

// The space inside a surface. Open edges are closed by a fan from the middle of each connected run
// of them, so that a piece cut out of a body has a volume too; wherever such a run moves rigidly,
// its fan adds nothing to differences.
struct SurfaceVolume {
  double counted_m3 = 0;   // by the divergence theorem: overlapping space counts repeatedly
  double repeated_m3 = 0;  // of that, space counted again (or, < 0, space turned inside out)
  double occupied_m3() const { return counted_m3 - repeated_m3; }
};
SurfaceVolume surfaceVolume(TriangleList triangles, PointList points);

// Share of a joint's volume that a pose loses: what the limb occupies less than at rest, over the
// rest volume of the part of it that is near the joint (at least a quarter of the ball with as much
// surface, which says something of parts that hardly close, too). Negative: it gained.
double jointVolumeLoss(TriangleList limb, TriangleList nearJoint, PointList rest, PointList points);

// --- Motion against the skeleton (skin_motion.cpp)

// Which bone carries each point, and where each bone went: rest → now.
struct Carriers {
  std::span<const std::uint32_t> bone;  // per point
  std::span<const Transform> motion;    // per bone
};

// How far skin lies from where its bone would carry it, along the surface: the part of the
// displacement that is perpendicular to the carried rest normal.
struct SkinSlide {
  double rms_m = 0, largest_m = 0;
};
SkinSlide skinSlide(std::span<const std::uint32_t> which, PointList rest, PointList restNormals,
                    const Carriers& carriers, PointList points);

// Points as seen from their bones: the carried rest position is the rest position.
void intoBones(const Carriers& carriers, PointList points, std::vector<Eigen::Vector3f>& seen);

// Root mean square of the third difference in time of points seen from their bones. A vibration of
// frequency f appears with (2 sin(π f / rate))³ times its amplitude: at 60 frames per second 1 at
// 10 Hz, 0.009 at 2 Hz, 8 at 30 Hz. 0 with fewer than four frames.
double jitter_m(std::span<const std::vector<Eigen::Vector3f>> framesInBones);

}  // namespace fascia
