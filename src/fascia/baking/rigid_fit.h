#pragma once

#include <fascia/math/types.h>

namespace fascia {

// What a rigid fit needs of weighted points and their targets, collected around an origin near the
// points, to keep digits.
struct RigidSums {
  double mass = 0, spread = 0;      // Σ s², Σ s² |q|², q = p - origin
  Vec3 point = Vec3::Zero();        // Σ s² q
  Vec3 target = Vec3::Zero();       // Σ s x
  Mat3 correlation = Mat3::Zero();  // Σ s q xᵀ
};

// The rotation and translation T that minimise Σ |s (T p) - x|², by the singular values of the
// correlation (Kabsch 1976): s = 1 is the usual fit; others are Le & Deng 2012, eqs. 8 to 12, where
// the bone carries only a part of the point. `like` decides what the points leave open (fewer than
// three, or all in a line), and is where the search starts.
Transform fitRigidly(const RigidSums& sums, const Vec3& origin_m, const Transform& like);

// The rotation R that maximises tr(R · correlation). Newton's method from `start`, or a singular
// value decomposition where that leads nowhere.
Mat3 bestRotation(const Mat3& correlation, const Mat3& start);

}  // namespace fascia
