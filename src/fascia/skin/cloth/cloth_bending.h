#pragma once

#include <vector>

#include <fascia/math/supernodal_cholesky.h>
#include <fascia/skin/cloth/cloth_level.h>
#include <fascia/skin/grid/bending.h>
#include <fascia/skin/grid/grid_lines.h>
#include <fascia/skin/point/point_model.h>

namespace fascia {

// The bending term of a sheet that is stepped by limits, on one of its levels: half an implicit
// step. The way δ that bending adds solves
//
//   (M + h² L) δ = h² f(r),
//
// f the forces of bending.h and L their stiffness as it is where sheets bend freely, along normals,
// in all directions alike (Bergou et al. 2006). L never changes, so that it is factorised once, and
// is no less than the true stiffness, so that no stiffness is too large; where f is 0 nothing
// moves. Folds finer than the level's spacing are not resisted.
class ClothBending {
 public:
  // Of a grid; its points on `lines` weigh `share` times as much on the level.
  struct Source {
    const GridLayout& layout;
    const GridLines& lines;
    const VectorArray& rest;
    const FloatArray& stiffness_Nm;
    const PointModel& points;
    double share;
  };

  ClothBending() = default;
  explicit ClothBending(const Source& source);

  bool active() const { return bending_.active(); }
  // For steps of which h² (s²) is that part that a force's acceleration goes in a step.
  void prepare(double squaredStep_s2);
  void apply(VectorArray& place, const ClothLevel& level);

 private:
  GridLayout layout_;  // of the level's points
  Bending bending_;
  std::vector<double> mass_kg_;  // by point; 0: fixed
  double squaredStep_s2_ = 0;
  SupernodalCholesky factor_;
  SupernodalCholesky::Scratch scratch_;
  VectorArray position_, force_;
  FloatArray way_[3];  // by point, m
};

}  // namespace fascia
