#pragma once

#include <vector>

#include <fascia/skin/cloth/cloth_level.h>
#include <fascia/skin/grid/elastic_grid.h>
#include <fascia/skin/grid/grid_lines.h>
#include <fascia/skin/point/point_model.h>

namespace fascia {

// The edges of a grid and of its coarser levels as limits with compliance. An edge of level l spans
// 2^l edges of the grid: it may be as long as they are together, and is as stiff as a strip of
// them.
class ClothModel {
 public:
  // rest: positions of the rest shape.
  ClothModel(const ElasticGrid& elastic, const VectorArray& rest, const PointModel& points);

  // Finest first, with room for their state and without tables.
  std::vector<ClothLevel> makeLevels() const;
  // The tables of all levels for steps of h seconds of which a force's share `lead` reaches the
  // same step's positions.
  void prepare(double h, double lead, std::vector<ClothLevel>& levels) const;

  // The level whose cells resist shear. Stiff diagonals of small cells would lock: a sheet could
  // not bend over a ball without stretching.
  std::size_t shearLevel() const { return shearLevel_; }
  std::size_t levelCount() const { return levels_.size(); }
  const GridLines& lines(std::size_t level) const { return levels_[level].lines; }
  // The finest level that has no more rows or columns; the coarsest if none has.
  std::size_t levelFor(std::size_t side) const;

 private:
  struct Edge {
    double length_m = 0, stiffness_N_per_m = 0;  // length 0: no edge
  };
  struct Cell {
    double up_m = 0, down_m = 0, stiffness_N_per_m = 0;  // diagonals, both as stiff
  };
  struct Level {
    GridLines lines;
    std::vector<double> lightness;  // 1/kg; 0: fixed
    std::vector<Edge> along, above;
    std::vector<Cell> cells;  // of the level with shear
  };

  std::size_t index(const Level& level, std::size_t i, std::size_t j) const {
    return j * level.lines.columns.size() + i;
  }
  void addPoints(const PointModel& points, double share, Level& level) const;
  void addEdges(const ElasticGrid& elastic, double strips, Level& level) const;
  void addCells(const ElasticGrid& elastic, const VectorArray& rest, Level& level) const;
  static void link(const Level& fine, const Level& coarse, ClothLevel& finer, ClothLevel& coarser);
  void fillRow(const Level& level, std::size_t j, bool sheared, double compliance, ClothLevel& out,
               FloatArray (&lists)[3]) const;

  GridLayout layout_;
  std::vector<Level> levels_;
  std::size_t shearLevel_ = 0;
};

}  // namespace fascia
