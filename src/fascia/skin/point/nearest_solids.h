#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/field/field.h>

namespace fascia {

// Which solid is nearest to each point of a block, asked again and again while the points move a
// little: a solid that was found far away is not asked until the points may have come to it.
class NearestSolids {
 public:
  static constexpr std::size_t kBlock = 32;  // most points of a block

  // `field` must stay as it is. `reach_m`: how far the points may go, at least, until all solids
  // are asked again. It changes the cost and not the result; a hundredth of the field is good.
  NearestSolids(const DistanceField& field, double reach_m);

  // Allocates nothing. The first of several solids at the same distance counts.
  void measure(ConstVectors points);
  // Of the last measurement, for each of its points. The distance is the solid's own estimate,
  // negative inside; the normal is unit and points away from the solid.
  float distance_m(std::size_t i) const { return distance_[i]; }
  bool anyNearer(double distance_m) const;
  SolidId solid(std::size_t i) const { return SolidId(solid_[i]); }
  ConstVectors normals() const {
    return {normal_[0].data(), normal_[1].data(), normal_[2].data(), kBlock};
  }

 private:
  using Row = std::array<float, kBlock>;
  using Rows = std::array<Row, 3>;
  bool strayed(ConstVectors points) const;
  void findCandidates(ConstVectors points);
  void offer(SolidId solid, ConstVectors points);

  const DistanceField& field_;
  float least_m_, steepest_ = 1;  // L of the steepest solid
  float slack_m_ = -1;            // how far points may go from known_; negative: anew
  std::size_t count_ = 0;
  Rows known_{};
  std::vector<SolidId> candidates_;  // ascending
  std::vector<float> closest_m_;     // each solid, to any of the points
  Row asked_{}, distance_{};
  Rows askedNormal_{}, normal_{};
  std::array<std::int32_t, kBlock> solid_{};
};

}  // namespace fascia
