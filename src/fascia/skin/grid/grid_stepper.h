#pragma once

#include <vector>

#include <fascia/skin/grid/grid_kernels.h>

namespace fascia {

// Runs `steps` steps of one interval over the whole grid, on all cores when the grid is large.
// Tiles of rows are stepped several times while they are in the cache, with a border of rows
// computed twice instead of exchanged; results have the same bits for any tiling and threads.
class GridStepper {
 public:
  explicit GridStepper(const GridLayout& layout = {});
  // firstStep counts from the start of the interval (the time base of the surroundings).
  void run(const SweepModel& model, int firstStep, int steps, VectorArray& position,
           VectorArray& velocity);

 private:
  struct Tile {
    int begin, end;
    VectorArray position, velocity;
    SweepScratch scratch;
  };
  void runTile(const SweepModel& model, int firstStep, int steps, Tile& tile,
               const VectorArray& position, const VectorArray& velocity);

  GridLayout layout_;
  std::vector<Tile> tiles_;
  VectorArray nextPosition_, nextVelocity_;
};

}  // namespace fascia
