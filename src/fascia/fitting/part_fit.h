#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <fascia/fitting/flesh_part.h>

namespace fascia {

// One of a joint's solids.
struct NamedSolid {
  std::string suffix;  // after the joint's name; empty: it has that name itself
  FittedSolid solid;
  Color color;
  // Flexion of the joint at the end of the bone by a right angle changes its length by this share;
  // its thickness changes so that the volume stays.
  double stretchPerRightAngle = 0;
};

// What became of one part.
struct PartFit {
  std::vector<NamedSolid> solids;
  std::string why;  // where there are none
  double residual_rms_m = 0;
  std::vector<std::uint32_t> worn;  // pieces of the mesh over the flesh that get none
};

// What all parts' fits share.
struct FitSetting {
  const RestSurface& surface;
  const Symmetry& symmetry;

  double margin_m() const { return 0.25 * surface.leastFat_m(); }
  // Beyond the fat, from which a place counts as unfilled.
  double mostGap_m(const SurfaceSample& sample) const {
    constexpr double kLeastGap = 0.35;  // of the local radius
    return std::max(kLeastGap * sample.radius_m, 2 * surface.leastFat_m());
  }
  // Across which the part's solids are repeated on its other side.
  const MirrorPlane* plane(const FleshPart& part) const {
    return part.paired ? &symmetry.plane : nullptr;
  }
};

inline constexpr Color kFlesh{0.72f, 0.28f, 0.26f};
inline constexpr Color kTendon{0.88f, 0.80f, 0.72f};

// Gaps between the skin's fat and the nearest of the solids, for all of the part's own samples (m).
std::vector<double> gaps_m(const FleshPart& part, const std::vector<NamedSolid>& solids);

}  // namespace fascia
