#pragma once

#include <fascia/base/aligned.h>
#include <fascia/skin/mesh/mesh_layout.h>
#include <fascia/skin/mesh/triangle_membrane.h>
#include <fascia/skin/point/step_inputs.h>

namespace fascia {

// SIMD kernels on a triangle-mesh skin, dispatched at run time; see grid_kernels.h for the grid's.

// Runs `steps` steps of one interval over the whole mesh, on all cores when it is large; the same
// bits on any number of threads. firstStep counts from the start of the interval. Arrays have
// membrane.storage() points, a multiple of 16. Allocates when constructed only.
class MeshStepper {
 public:
  MeshStepper() = default;
  explicit MeshStepper(const TriangleMembrane& membrane);
  void run(const StepInputs& inputs, int firstStep, int steps, VectorArray& position,
           VectorArray& velocity);
  // Forces (N) of membrane and bending, overwrites `force`.
  void forces(const VectorArray& position, VectorArray& force);

 private:
  template <class Task>
  void forEachChunk(const Task& task);

  MeshLayout layout_;
  FloatArray quads_, nextQuads_;     // positions, 4 floats per point
  std::vector<FloatArray> scratch_;  // one per task
};

// The same once: prepares a MeshStepper for it.
void meshForces(const TriangleMembrane& membrane, const VectorArray& position, VectorArray& force);

}  // namespace fascia
