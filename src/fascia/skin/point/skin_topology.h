#pragma once

#include <memory>
#include <span>
#include <vector>

#include <Eigen/SparseCore>

#include <fascia/base/aligned.h>
#include <fascia/geometry/triangle_mesh.h>
#include <fascia/skin/point/step_inputs.h>
#include <fascia/skin/point/stretch_limit.h>

namespace fascia {

// Computes a surface's own forces and steps its points; owns what memory that takes. One per run.
class SurfaceStepper {
 public:
  virtual ~SurfaceStepper() = default;
  // All elastic forces, N; overwrites `force`.
  virtual void forces(const VectorArray& position, VectorArray& force) = 0;
  // So many steps of the stabilised leapfrog (leapfrog.h), firstStep ones after an interval's
  // start. A grid takes no inputs.extraForce and no inputs.stepEnd.
  virtual void run(const StepInputs& inputs, int firstStep, int steps, VectorArray& position,
                   VectorArray& velocity) = 0;
};

// How the points of a skin hang together: all that differs between a grid and a triangle mesh.
// Constant once built.
class SkinTopology {
 public:
  struct Range {
    std::size_t first, count;
  };

  virtual ~SkinTopology() = default;
  virtual std::size_t storage() const = 0;  // entries of per-point arrays, padding included
  virtual std::size_t pointCount() const = 0;
  virtual std::size_t storageIndex(std::size_t point) const = 0;
  virtual std::span<const Range> ranges() const = 0;  // all points in storage, without padding
  // Fills padding that repeats points (a grid's seam); after positions were written one by one.
  virtual void complete(VectorArray& values) const = 0;
  virtual std::unique_ptr<SurfaceStepper> makeStepper() const = 0;
  // Adds ∂f/∂r of the elastic forces; row and column 3p + c of point p.
  virtual void addForceJacobian(const VectorArray& position,
                                std::vector<Eigen::Triplet<double>>& entries) const = 0;
  virtual double maxStretch(const VectorArray& position) const = 0;  // edge over rest length
  // max_stretch of the material.
  virtual double allowedStretch() const = 0;
  // What keeps edges within it.
  virtual StretchLimit makeStretchLimit() const = 0;
  // The surface for display and export; see skinSurface().
  virtual void surface(const VectorArray& position, TriangleMesh& mesh) const = 0;
};

}  // namespace fascia
