#pragma once

#include <memory>

#include <fascia/skin/cloth/cloth_bending.h>
#include <fascia/skin/cloth/cloth_kernels.h>
#include <fascia/skin/cloth/cloth_model.h>
#include <fascia/skin/grid/grid_topology.h>
#include <fascia/skin/point/skin_topology.h>

namespace fascia {

// Steps grids that hardly stretch: few long steps, whatever the stiffness.
//
// A step starts where points get without their edges, and takes edges that are too long together
// again: position based dynamics (Müller et al. 2007) with compliance (Macklin et al. 2016), on a
// hierarchy of levels, coarsest first. A chord is never longer than the way along the edges that it
// spans, so that a coarse level's corrections are never wrong for the finer ones, and nothing needs
// to be handed back. Left out: edges do not resist being shortened. A sheet that gives way to
// compression by wrinkles finer than its grid does the same (tension-field theory).
//
// Each level is swept there and back; one way alone would pump energy in. Velocities go with the
// theta method: of a step with mean velocity v̄ they end at
//
//   v' = v̄ + s (v̄ − v),   r' = r + h v̄,   r₀ = r + h v + h² a/(1 + s),
//
// s = kSwing; 1 would be of second order and never come to rest, 0 implicit Euler, which damps.
//
// Results have the same bits on any number of threads: bands of rows depend on the grid alone.
class ClothStepper final : public SurfaceStepper {
 public:
  static constexpr double kSwing = 0.5;

  // bending_Nm: per point, as Bending has it. The grid must outlive the stepper.
  ClothStepper(const GridTopology& grid, const VectorArray& rest, const PointModel& points,
               const FloatArray& bending_Nm);

  void forces(const VectorArray& position, VectorArray& force) override;
  // Reads the step's length, slide and bounce of inputs.step, and inputs.points as they were given
  // to the constructor.
  void run(const StepInputs& inputs, int firstStep, int steps, VectorArray& position,
           VectorArray& velocity) override;

 private:
  // Rows that are swept on their own in a step. Seams would show if they stayed where they are:
  // they move to and fro by a third of a band.
  struct Bands {
    int count, rows, shift;
    Bands(const ClothLevel& level, int number);
    int start(int band) const;  // start(count): all rows
  };

  bool bends(std::size_t level) const { return bending_.active() && level == bendingLevel_; }
  void prepare(const StepInputs& inputs);
  void prepareMotion(const PointModel& points, double h);
  void step(const ClothStep& step, int number);
  void sweepLevel(std::size_t l, const ClothStep& step, int number);
  void adjust(std::size_t l, int number);
  template <class Down, class Up>
  static void thereAndBack(ClothLevel& level, const Bands& bands, const Down& down, const Up& up);
  template <class Task>
  static void forBands(const ClothLevel& level, int number, const Task& task);

  const GridTopology& grid_;
  ClothModel model_;
  std::vector<ClothLevel> levels_;
  ClothMotion motion_;
  double prepared_s_ = 0;
  std::unique_ptr<SurfaceStepper> forces_;
  ClothBending bending_;
  std::size_t bendingLevel_ = 0;
};

}  // namespace fascia
