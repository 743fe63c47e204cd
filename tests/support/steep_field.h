#pragma once

#include <fascia/field/field.h>

namespace fascia::test {

// A field whose distances grow three times as fast as they should from near_m of its surface on, as
// those of blended elements may: whoever trusts them goes through.
template <class Base>
class Steep final : public Base {
 public:
  using Base::Base;
  explicit Steep(const Base& base) : Base(base) {}
  static constexpr double near_m = 0.01, steepness = 3;

  double lipschitz(SolidId) const override { return steepness; }
  void evaluate(SolidId solid, ConstVectors points, float* distance_m,
                Vectors normal) const override {
    Base::evaluate(solid, points, distance_m, normal);
    for (std::size_t i = 0; i < points.count; ++i)
      if (distance_m[i] > static_cast<float>(near_m))
        distance_m[i] = static_cast<float>(near_m + steepness * (distance_m[i] - near_m));
  }
};

}  // namespace fascia::test
