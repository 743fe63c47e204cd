#include <fascia/field/affine_kernels.h>

#include <algorithm>

// SSSE3 and AVX3_DL add code, not speed, here.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fascia/field/affine_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <fascia/base/assert.h>

#ifndef FASCIA_AFFINE_MAP
#define FASCIA_AFFINE_MAP
namespace fascia {
struct AffineMap {
  float matrix[9], from[3], to[3];
};
}  // namespace fascia
#endif

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

HWY_INLINE void mapVector(const AffineMap& map, const float* const in[3], float* const out[3]) {
  const hn::ScalableTag<float> d;
  const auto x = hn::Sub(hn::LoadU(d, in[0]), hn::Set(d, map.from[0]));
  const auto y = hn::Sub(hn::LoadU(d, in[1]), hn::Set(d, map.from[1]));
  const auto z = hn::Sub(hn::LoadU(d, in[2]), hn::Set(d, map.from[2]));
  for (int r = 0; r < 3; ++r) {
    const float* row = map.matrix + 3 * r;
    const auto sum =
        hn::MulAdd(hn::Set(d, row[0]), x,
                   hn::MulAdd(hn::Set(d, row[1]), y,
                              hn::MulAdd(hn::Set(d, row[2]), z, hn::Set(d, map.to[r]))));
    hn::StoreU(sum, d, out[r]);
  }
}

void mapPoints(const AffineMap& map, ConstVectors in, Vectors out) {
  const hn::ScalableTag<float> d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + lanes <= in.count; i += lanes) {
    const float* const source[3] = {in.x + i, in.y + i, in.z + i};
    float* const target[3] = {out.x + i, out.y + i, out.z + i};
    mapVector(map, source, target);
  }
  if (i == in.count) return;
  // The rest goes through a buffer, so that every point is computed by the same instructions.
  constexpr std::size_t kWidest = 64;
  alignas(64) float buffer[3][kWidest] = {};
  const float* const source[3] = {in.x + i, in.y + i, in.z + i};
  float* const target[3] = {out.x + i, out.y + i, out.z + i};
  const float* const read[3] = {buffer[0], buffer[1], buffer[2]};
  float* const write[3] = {buffer[0], buffer[1], buffer[2]};
  for (int a = 0; a < 3; ++a) std::copy_n(source[a], in.count - i, buffer[a]);
  mapVector(map, read, write);
  for (int a = 0; a < 3; ++a) std::copy_n(buffer[a], in.count - i, target[a]);
}

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fascia {

HWY_EXPORT(mapPoints);

void affinePoints(const Mat3& matrix, const Vec3& from, const Vec3& to, ConstVectors in,
                  Vectors out) {
  AffineMap map;
  FASCIA_ASSERT(out.count >= in.count, "a place for each point");
  FASCIA_ASSERT(matrix.allFinite() && to.allFinite(), "the map is finite");
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) map.matrix[3 * r + c] = static_cast<float>(matrix(r, c));
    map.from[r] = static_cast<float>(from[r]);
    map.to[r] = static_cast<float>(to[r]);
  }
  HWY_DYNAMIC_DISPATCH(mapPoints)(map, in, out);
}

}  // namespace fascia
#endif
