#pragma once

#include <span>

#include <fascia/math/supernodal_cholesky.h>
#include <fascia/pose/limb_parts.h>

namespace fascia {

// Spreads amounts of volume (m³ per point) into displacements along the normal (m): the solution g
// of (M + 0.35 r² C) g = s, which keeps the volume, ∫ g = Σ s, and is too smooth to show as a lump.
class SkinSpread {
 public:
  SkinSpread() = default;
  SkinSpread(const PoseMesh& mesh, const LimbParts& parts);
  void spread(std::span<float> values, SupernodalCholesky::Scratch& scratch) const {
    system_.solve(values, scratch);
  }
  void spread(std::span<float> a, std::span<float> b, std::span<float> c,
              SupernodalCholesky::Scratch& scratch) const {
    system_.solve(a, b, c, scratch);
  }

 private:
  SupernodalCholesky system_;
};

}  // namespace fascia
