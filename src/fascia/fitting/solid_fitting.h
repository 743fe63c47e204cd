#pragma once

#include <span>
#include <vector>

#include <fascia/fitting/fitted_solid.h>
#include <fascia/fitting/rest_surface.h>

namespace fascia {

// What a solid should look like.
struct SolidTarget {
  // Skin that it should reach up to, fat_m below.
  struct Reach {
    Vec3 position_m;
    double fat_m, weight;
  };
  // Skin that it must stay under, `margin_m` at least.
  struct Bound {
    Vec3 position_m;
    double margin_m, weight;
  };
  // Points that it should cover, `depth_m` deep (joints' centres: neighbours then overlap there).
  struct Pin {
    Vec3 position_m;
    double depth_m, weight;
  };
  std::vector<Reach> reach;
  std::vector<Bound> bounds;
  std::vector<Pin> pins;
  double size_m = 0.1;     // of the part's radius: unit of residuals
  bool symmetric = false;  // keep its xz-plane where it is
  bool bends = true;
  double prior = 0.05;  // pull towards the first guess's proportions
};

// The target's best superellipsoid by nonlinear least squares from `start`; where the points leave
// it open it keeps to the first guess: distances at `reach` are to be the fat's thickness, robustly
// on the far side (what a convex solid cannot reach shall not pull it out elsewhere), heavily on
// the near one.
FittedSolid fitSolid(const SolidTarget& target, const FittedSolid& guess, const FittedSolid& start);
inline FittedSolid fitSolid(const SolidTarget& target, const FittedSolid& guess) {
  return fitSolid(target, guess, guess);
}

// Root mean square of |distance − fat| over `reach`, weighted.
double residualRms_m(const SolidTarget& target, const FittedSolid& solid);

// Signed distances of points to the solid, in the world.
void distances(const FittedSolid& solid, std::span<const Vec3> points, std::vector<double>& out);

}  // namespace fascia
