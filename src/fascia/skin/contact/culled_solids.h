#pragma once

#include <cstddef>

#include <Eigen/Core>

#include <fascia/base/aligned.h>
#include <fascia/math/types.h>

namespace fascia {

// All solids of a field side by side, for tests of groups of points against each of them.
class CulledSolids {
 public:
  static constexpr std::size_t kWide = 16;  // floats; the widest vector

  // A solid's motion as an affine map: x goes by change (x − origin) + shift.
  struct Motion {
    Eigen::Matrix3f change;
    Eigen::Vector3f origin, shift;
    float turn;           // norm of change
    float extra_m;        // what is not rigid: swelling and bending
    float steepness = 1;  // the field's Lipschitz bound: how much a way can change distances
  };

  // Forgets what there was.
  void resize(std::size_t count);
  std::size_t count() const { return count_; }
  std::size_t padded() const { return (count_ + kWide - 1) / kWide * kWide; }
  void setBox(std::size_t solid, const Box& box);
  void setMotion(std::size_t solid, const Motion& motion);

  // Lists of padded() floats, one per component: low, high; change by rows, origin, shift; the
  // rest.
  const float* low(int axis) const { return list(axis); }
  const float* high(int axis) const { return list(3 + axis); }
  const float* change(int row, int column) const { return list(6 + 3 * row + column); }
  const float* origin(int axis) const { return list(15 + axis); }
  const float* shift(int axis) const { return list(18 + axis); }
  const float* turn() const { return list(21); }
  const float* extra_m() const { return list(22); }
  const float* steepness() const { return list(23); }

 private:
  static constexpr int kLists = 24;
  const float* list(int n) const { return values_.data() + static_cast<std::size_t>(n) * padded(); }
  float* list(int n) { return values_.data() + static_cast<std::size_t>(n) * padded(); }

  std::size_t count_ = 0;
  FloatArray values_;
};

// A gap that is not known.
inline constexpr float kUnknownGap_m = -1e30f;

}  // namespace fascia
