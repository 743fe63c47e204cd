#pragma once

#include <fascia/base/aligned.h>
#include <fascia/skin/step_inputs.h>
#include <fascia/skin/triangle_membrane.h>

namespace fascia {

// SIMD kernels on a triangle-mesh skin, dispatched at run time; see grid_kernels.h for the grid's.

// Forces (N) of membrane and bending, overwrites `force`.
void meshForces(const TriangleMembrane& membrane, const VectorArray& position, VectorArray& force);

// Runs `steps` steps of one interval over the whole mesh, on all cores when it is large; the same
// bits on any number of threads. firstStep counts from the start of the interval.
class MeshStepper {
 public:
  explicit MeshStepper(const TriangleMembrane& membrane);
  void run(const StepInputs& inputs, int firstStep, int steps, VectorArray& position,
           VectorArray& velocity);

 private:
  const TriangleMembrane* membrane_;
};

}  // namespace fascia
