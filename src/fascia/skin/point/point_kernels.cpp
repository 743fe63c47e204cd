#include <fascia/skin/point/point_kernels.h>

#include <utility>

// SSSE3 and AVX3_DL add code, not speed, here.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fascia/skin/point/point_kernels.cpp"
#include <hwy/foreach_target.h>

#include <fascia/skin/point/simd_vector-inl.h>

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {

float followImpl(const VectorArray& nextAnchor, float rate, const FloatArray* carry,
                 PointSurroundings& around, VectorArray& velocity) {
  const D d;
  const std::size_t n = nextAnchor.size() / hn::Lanes(d) * hn::Lanes(d);
  const Pointers anchor = pointers(std::as_const(around.anchor));
  const MutablePointers anchorVelocity = pointers(around.anchorVelocity);
  const MutablePointers flesh = pointers(around.fleshVelocity), v = pointers(velocity);
  V farthest = hn::Zero(d);
  for (std::size_t k = 0; k < n; k += hn::Lanes(d)) {
    const V3 way = pointers(nextAnchor).at(k) - anchor.at(k);
    farthest = hn::Max(farthest, dot(way, way));
    const V3 next = scaled(hn::Set(d, rate), way);
    const V3 change = next - anchorVelocity.at(k);
    if (carry) v.set(k, mulAdd(hn::LoadU(d, carry->data() + k), change, v.at(k)));
    flesh.set(k, flesh.at(k) + change);
    anchorVelocity.set(k, next);
  }
  return hn::GetLane(hn::MaxOfLanes(d, farthest));
}

void followCoarseImpl(const VectorArray& next, const FloatArray& carry, VectorArray& coarseVelocity,
                      VectorArray& velocity) {
  const D d;
  const std::size_t n = carry.size() / hn::Lanes(d) * hn::Lanes(d);
  const MutablePointers v = pointers(velocity), coarse = pointers(coarseVelocity);
  for (std::size_t k = 0; k < n; k += hn::Lanes(d)) {
    const V3 now = pointers(next).at(k);
    v.set(k, mulAdd(hn::LoadU(d, carry.data() + k), now - coarse.at(k), v.at(k)));
    coarse.set(k, now);
  }
}

bool brokenImpl(const VectorArray& position, const VectorArray& velocity,
                const VectorArray& anchorVelocity, float fastest, std::size_t first,
                std::size_t last) {
  const D d;
  const V speedLimit = hn::Set(d, fastest * fastest), placeLimit = hn::Set(d, 1e18f);
  auto sound = hn::Eq(speedLimit, speedLimit);
  for (std::size_t k = first; k < last; k += hn::Lanes(d)) {
    const V3 v = pointers(velocity).at(k) - pointers(anchorVelocity).at(k);
    const V3 r = pointers(position).at(k);
    // Comparisons with NaN are false.
    sound = hn::And(sound, hn::And(hn::Lt(dot(v, v), speedLimit), hn::Lt(dot(r, r), placeLimit)));
  }
  return !hn::AllTrue(d, sound);
}

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fascia {

HWY_EXPORT(followImpl);
HWY_EXPORT(followCoarseImpl);
HWY_EXPORT(brokenImpl);

float followAnchors(const VectorArray& nextAnchor, float rate_per_s, const FloatArray* carry,
                    PointSurroundings& around, VectorArray& velocity) {
  return HWY_DYNAMIC_DISPATCH(followImpl)(nextAnchor, rate_per_s, carry, around, velocity);
}

void followCoarse(const VectorArray& next, const FloatArray& carry, VectorArray& coarseVelocity,
                  VectorArray& velocity) {
  HWY_DYNAMIC_DISPATCH(followCoarseImpl)(next, carry, coarseVelocity, velocity);
}

bool anyBroken(const VectorArray& position, const VectorArray& velocity,
               const VectorArray& anchorVelocity, float fastest_m_per_s, std::size_t first,
               std::size_t last) {
  return HWY_DYNAMIC_DISPATCH(brokenImpl)(position, velocity, anchorVelocity, fastest_m_per_s,
                                          first, last);
}

}  // namespace fascia
#endif
