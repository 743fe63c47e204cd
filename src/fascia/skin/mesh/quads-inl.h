// Vectors of points from and to quads: four floats x, y, z, 0 per point, see MeshLayout. Included
// once per Highway target.
#if defined(FASCIA_SKIN_QUADS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FASCIA_SKIN_QUADS_INL_H_
#undef FASCIA_SKIN_QUADS_INL_H_
#else
#define FASCIA_SKIN_QUADS_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include <fascia/skin/point/simd_vector-inl.h>

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE V3 loadQuads(const float* quads, const std::uint32_t* offsets) {
  const D d;
  const float* q = quads + offsets[0];
  return {hn::Set(d, q[0]), hn::Set(d, q[1]), hn::Set(d, q[2])};
}
HWY_INLINE V3 loadQuads(const float* quads) {
  const std::uint32_t first = 0;
  return loadQuads(quads, &first);
}
HWY_INLINE void storeQuads(V3 v, float* quads) {
  quads[0] = hn::GetLane(v.x), quads[1] = hn::GetLane(v.y), quads[2] = hn::GetLane(v.z);
}
HWY_INLINE void sumQuads(const float* quads, const std::uint32_t* offsets, std::size_t count,
                         float* sum) {
  for (int a = 0; a < 3; ++a) {
    float total = 0;
    for (std::size_t i = 0; i < count; ++i) total += quads[offsets[i] + a];
    sum[a] = total;
  }
}

#else

using Quad = hn::FixedTag<float, 4>;

// Quads at offsets[0], offsets[4], …: one per 128-bit block.
template <class Tag>
HWY_INLINE hn::Vec<Tag> loadBlocks(Tag d, const float* quads, const std::uint32_t* offsets) {
  if constexpr (hn::MaxLanes(Tag()) == 4) {
    return hn::Load(d, quads + offsets[0]);
  } else {
    const hn::Half<Tag> half;
    return hn::Combine(d, loadBlocks(half, quads, offsets + hn::MaxLanes(half)),
                       loadBlocks(half, quads, offsets));
  }
}

// Within each 128-bit block: row k of the block is a quad; to columns x, y, z.
HWY_INLINE V3 transposed(V q0, V q1, V q2, V q3) {
  const D d;
  const V xy02 = hn::InterleaveLower(d, q0, q2), xy13 = hn::InterleaveLower(d, q1, q3);
  const V zw02 = hn::InterleaveUpper(d, q0, q2), zw13 = hn::InterleaveUpper(d, q1, q3);
  return {hn::InterleaveLower(d, xy02, xy13), hn::InterleaveUpper(d, xy02, xy13),
          hn::InterleaveLower(d, zw02, zw13)};
}

// The quads at the offsets of a vector's lanes.
HWY_INLINE V3 loadQuads(const float* quads, const std::uint32_t* offsets) {
  const D d;
  return transposed(loadBlocks(d, quads, offsets), loadBlocks(d, quads, offsets + 1),
                    loadBlocks(d, quads, offsets + 2), loadBlocks(d, quads, offsets + 3));
}
// The quads of consecutive items, in the order of MeshLayout::quadOffset.
HWY_INLINE V3 loadQuads(const float* quads) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  return transposed(hn::Load(d, quads), hn::Load(d, quads + lanes), hn::Load(d, quads + 2 * lanes),
                    hn::Load(d, quads + 3 * lanes));
}
HWY_INLINE void storeQuads(V3 v, float* quads) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  const V zero = hn::Zero(d);
  const V xz01 = hn::InterleaveLower(d, v.x, v.z), xz23 = hn::InterleaveUpper(d, v.x, v.z);
  const V yw01 = hn::InterleaveLower(d, v.y, zero), yw23 = hn::InterleaveUpper(d, v.y, zero);
  hn::Store(hn::InterleaveLower(d, xz01, yw01), d, quads);
  hn::Store(hn::InterleaveUpper(d, xz01, yw01), d, quads + lanes);
  hn::Store(hn::InterleaveLower(d, xz23, yw23), d, quads + 2 * lanes);
  hn::Store(hn::InterleaveUpper(d, xz23, yw23), d, quads + 3 * lanes);
}
HWY_INLINE void sumQuads(const float* quads, const std::uint32_t* offsets, std::size_t count,
                         float* sum) {
  const Quad d;
  hn::Vec<Quad> total = hn::Zero(d);
  for (std::size_t i = 0; i < count; ++i) total = hn::Add(total, hn::Load(d, quads + offsets[i]));
  hn::Store(total, d, sum);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#endif
