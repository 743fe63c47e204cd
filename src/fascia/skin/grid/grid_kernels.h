#pragma once

#include <fascia/base/aligned.h>
#include <fascia/skin/grid/elastic_grid.h>
#include <fascia/skin/grid/grid_layout.h>
#include <fascia/skin/point/step_inputs.h>

namespace fascia {

// SIMD kernels on a grid skin, dispatched at run time to the widest vectors of the machine.

// A few rows of scratch that the kernels need; reuse it between calls, one per thread.
class SweepScratch {
 public:
  void resize(const GridLayout& layout);
  float* data() { return floats_.data(); }

 private:
  FloatArray floats_;
};

// Membrane forces (N) of the whole grid, overwrites `force`; padding gets 0.
void gridForces(const GridLayout& layout, const ElasticGrid::Coefficients& elastic,
                const VectorArray& position, VectorArray& force, SweepScratch& scratch);

struct SweepModel {
  const GridLayout* layout;
  const ElasticGrid::Coefficients* elastic;
  StepInputs inputs;
};

// A band of rows being stepped in place: position and velocity of rows [firstStored, …), row-major
// with the layout's stride.
struct SweepBand {
  float* position[3];
  float* velocity[3];
  int firstStored;
};

// One step of the stabilised leapfrog for rows [rowBegin, rowEnd): membrane, tissue, gravity, drag,
// contact half spaces and integration fused into one pass over memory. time_s counts from the start
// of the interval to the *end* of this step. Reads rows rowBegin−1 … rowEnd as they were before the
// step. Each row's result has the same bits whatever band it is computed in.
void sweepRows(const SweepModel& model, const SweepBand& band, int rowBegin, int rowEnd,
               float time_s, SweepScratch& scratch);

// Outward unit normals of the skin (columns around, rows upwards: right-handed), 0 in padding.
void gridNormals(const GridLayout& layout, const VectorArray& position, int rowBegin, int rowEnd,
                 VectorArray& normal);

}  // namespace fascia
