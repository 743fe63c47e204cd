#include <fascia/skin/point/stretch_kernels.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fascia/skin/point/stretch_kernels.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h

#include <fascia/skin/point/simd_vector-inl.h>

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {

// Lanes from k on, of which `left` are wanted: the others are 0.
HWY_INLINE V someOf(const float* list, std::size_t k, std::size_t left) {
  const D d;
  if (left >= hn::Lanes(d)) return hn::LoadU(d, list + k);
  return hn::MaskedLoad(hn::FirstN(d, left), d, list + k);
}

bool anyExceedsImpl(std::span<const EdgeRun> runs, const FloatArray& longest,
                    const VectorArray& position, float share) {
  const D d;
  const V most = hn::Set(d, (1 + share) * (1 + share));
  for (const EdgeRun& run : runs) {
    auto any = hn::FirstN(d, 0);
    for (std::size_t i = 0; i < run.count; i += hn::Lanes(d)) {
      const std::size_t left = run.count - i, a = run.first + i;
      const std::size_t b = a + static_cast<std::size_t>(run.step);
      const auto way = [&](const FloatArray& axis) HWY_ATTR {
        return hn::Sub(someOf(axis.data(), b, left), someOf(axis.data(), a, left));
      };
      const V x = way(position.x), y = way(position.y), z = way(position.z);
      const V squared = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
      const V limit = someOf(longest.data() + run.longest, i, left);
      any = hn::Or(any, hn::Gt(squared, hn::Mul(hn::Mul(most, limit), limit)));
    }
    if (!hn::AllFalse(d, any)) return true;
  }
  return false;
}

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fascia {

HWY_EXPORT(anyExceedsImpl);

bool anyEdgeExceeds(std::span<const EdgeRun> runs, const FloatArray& longest_m,
                    const VectorArray& position, float share) {
  return HWY_DYNAMIC_DISPATCH(anyExceedsImpl)(runs, longest_m, position, share);
}

}  // namespace fascia
#endif
