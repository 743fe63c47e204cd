#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/skin/point_kernels.h>
#include <fascia/skin/point_model.h>

namespace fascia {

// What of a skin may touch what, prepared once from the rest shape (spec L22). Constant.
struct SelfContactModel {
  std::vector<std::array<std::uint32_t, 3>> triangles;  // storage indices of points
  std::vector<PointBlock> blocks;                       // compact patches of points that are tested
  float gap_m = 0.002f;  // distance that is kept between two sheets of skin

  // (helper's own prepared data: pairs of patches that are neighbours in the rest shape or cross
  // there already and are left alone, triangles per patch, rest distances …)
};

// Keeps a skin out of itself. Once per interval: finds points near or behind triangles of other
// parts of the skin, moves both sides apart, and gives the points half spaces for the steps that
// follow. What crosses in the rest shape already is left alone: it never melts, sticks or jitters.
class SelfContact {
 public:
  SelfContact() = default;
  explicit SelfContact(const SelfContactModel& model);

  struct Result {
    std::uint64_t contacts = 0;
    float deepest_m = 0;
  };
  // reach_m: how far a point may come until the next call. Half spaces in `around` that are nearer
  // than the flesh's replace those; `around` has been written by FleshContact::project before.
  Result resolve(const PointModel& points, float reach_m, VectorArray& position,
                 VectorArray& velocity, PointSurroundings& around);

 private:
  const SelfContactModel* model_ = nullptr;
};

}  // namespace fascia
