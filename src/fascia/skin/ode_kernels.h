#pragma once

#include <span>

#include <fascia/skin/point/point_model.h>
#include <fascia/skin/point/skin_topology.h>

namespace fascia {

// SIMD kernels of a skin that a solver of the ODE library steps: the forces of its points besides
// the surface's own, in single precision, and the way from the solver's coordinates (in double,
// x0 y0 z0 x1 …, points in the order of `ranges`) to arrays in storage order and back. Dispatched
// at run time.

// Rounds the coordinates into `out`; what is in no range keeps its value, but for a vector's lanes
// behind the end of one.
void loadCoordinates(std::span<const SkinTopology::Range> ranges, std::span<const double> from,
                     VectorArray& out);
// to = from + change; `to` may be `from`.
void addCoordinates(std::span<const SkinTopology::Range> ranges, const VectorArray& change,
                    std::span<const double> from, std::span<double> to);
// Takes over what has changed since the values were loaded: the rest keeps its double precision.
void takeChanges(std::span<const SkinTopology::Range> ranges, const VectorArray& loaded,
                 std::span<double> values);

// What acts on points at one moment of an interval.
struct StrandScene {
  std::span<const SkinTopology::Range> ranges;
  const PointModel* points;
  const PointSurroundings* around;  // at the interval's start
  float since_s;                    // since then
  float gravity[3];                 // m/s²
};

// Adds weight and the pull of the strands to `force`.
void addStrandForces(const StrandScene& scene, const VectorArray& position, VectorArray& force);
// Overwrites `force` with drag and the strands' damping.
void dampingForces(const StrandScene& scene, const VectorArray& position,
                   const VectorArray& velocity, VectorArray& force);
// The change of velocity over h seconds by `force`, drag and the strands' damping, the last two at
// the mean of the velocities before and after: solved for it, point by point.
void midpointKicks(const StrandScene& scene, const FloatArray& inverseMass, float h_s,
                   const VectorArray& position, const VectorArray& velocity,
                   const VectorArray& force, VectorArray& change);

}  // namespace fascia
