#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>

#include <fascia/base/aligned.h>
#include <fascia/field/field.h>
#include <fascia/skin/point/point_model.h>

namespace fascia {

// Non-penetration of skin and flesh (Turner & Gobbetti 1998, §4.1.4 and §4.2.3): every point keeps
// the distance of its fat τ from every solid. The paper tests the point moved inward along the
// skin's normal, g(r − τ n) ≥ 0; where a distance changes at most as fast as its point moves, d(r)
// ≥ τ implies that for every n, also where the skin folds and its normal is doubtful. Knows nothing
// of how points are connected.
class SkinContact {
 public:
  virtual ~SkinContact() = default;

  struct Result {
    float maxCorrection_m = 0;
    float maxSpeed_m_per_s = 0;  // relative to the anchors
  };

  // Projects points out of the solids exactly, removes the approaching part of their velocity
  // relative to the flesh, and writes each point's half space (normal, offset, flesh velocity) for
  // the steps that follow: the nearest solid within `reach_m`. A point in several solids is
  // projected in turn until it is outside of all; what many turns do not bring out (a narrow
  // crease, a pocket that solids close) leaves all of them at once.
  virtual Result project(const MovingField& field, const PointModel& points, float reach_m,
                         float restitution, VectorArray& position, VectorArray& velocity,
                         PointSurroundings& around) = 0;

  // How deep the deepest point is (m, ≥ 0), measured afresh and without changing anything.
  virtual float deepest(const DistanceField& field, const PointModel& points,
                        const VectorArray& position) const = 0;

 protected:
  // Of the parts' results, whose speeds are squared.
  static Result largest(std::span<const Result> parts) {
    Result all;
    for (const Result& r : parts) {
      all.maxCorrection_m = std::max(all.maxCorrection_m, r.maxCorrection_m);
      all.maxSpeed_m_per_s = std::max(all.maxSpeed_m_per_s, r.maxSpeed_m_per_s);
    }
    all.maxSpeed_m_per_s = std::sqrt(all.maxSpeed_m_per_s);
    return all;
  }
};

}  // namespace fascia
