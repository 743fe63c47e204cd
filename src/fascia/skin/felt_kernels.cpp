#include <fascia/skin/felt_kernels.h>

#include <cmath>

// SSSE3 and AVX3_DL add code, not speed, here.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fascia/skin/felt_kernels.cpp"
#include <hwy/foreach_target.h>

#include <fascia/skin/absorb-inl.h>

#ifndef FASCIA_FELT_KERNELS
#define FASCIA_FELT_KERNELS
namespace fascia {
// Share of a gap that a point has to go at least before it may be at the solid. Distances of
// deformed solids are estimates, and change a little faster than their points move.
constexpr float kTrust = 0.75f;
// Rounding of places in a solid's frame, relative to the largest of the numbers they come from.
constexpr float kRounding = 1e-6f;
}  // namespace fascia
#endif

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {

using Index = hn::Vec<hn::RebindToSigned<D>>;

inline Pointers pointers(const FeltVectors& a) {
  return {a.x.data(), a.y.data(), a.z.data()};
}
inline MutablePointers pointers(FeltVectors& a) {
  return {a.x.data(), a.y.data(), a.z.data()};
}
inline MutablePointers pointers(const Vectors& a) {
  return {a.x, a.y, a.z};
}
HWY_INLINE Index loadIndex(const std::int32_t* index) {
  return hn::LoadU(hn::RebindToSigned<D>(), index);
}
HWY_INLINE V gather(const FeltFloats& a, Index i) {
  return hn::GatherIndex(D(), a.data(), i);
}
HWY_INLINE V3 gather(const FeltVectors& a, Index i) {
  const D d;
  return {hn::GatherIndex(d, a.x.data(), i), hn::GatherIndex(d, a.y.data(), i),
          hn::GatherIndex(d, a.z.data(), i)};
}
HWY_INLINE void scatter(V v, Index i, FeltFloats& a) {
  hn::ScatterIndex(v, D(), a.data(), i);
}
HWY_INLINE void scatter(V3 v, Index i, FeltVectors& a) {
  const D d;
  hn::ScatterIndex(v.x, d, a.x.data(), i);
  hn::ScatterIndex(v.y, d, a.y.data(), i);
  hn::ScatterIndex(v.z, d, a.z.data(), i);
}

HWY_INLINE V3 toLocal(const KernelFrame& f, V3 world) {
  const D d;
  const V3 r = {hn::Sub(world.x, hn::Set(d, f.translation_m[0])),
                hn::Sub(world.y, hn::Set(d, f.translation_m[1])),
                hn::Sub(world.z, hn::Set(d, f.translation_m[2]))};
  const auto along = [&](int a) HWY_ATTR {
    const V3 axis = {hn::Set(d, f.rotation[0][a]), hn::Set(d, f.rotation[1][a]),
                     hn::Set(d, f.rotation[2][a])};
    return dot(axis, r);
  };
  return {along(0), along(1), along(2)};
}

void boundImpl(const FeltSolid& solid, std::span<const std::int32_t> point,
               const FeltMemory& memory, bool lowerLimits, FeltLanes& lanes, float* bound) {
  const D d;
  const V far = hn::Set(d, kFarAway), swelling = hn::Set(d, solid.swelling_m);
  const float* t = solid.frame.translation_m;
  const V rounding = hn::Set(d, kRounding * (1 + std::abs(t[0]) + std::abs(t[1]) + std::abs(t[2])));
  for (std::size_t i = 0; i < point.size(); i += hn::Lanes(d)) {
    const Index k = loadIndex(point.data() + i);
    const V3 way = toLocal(solid.frame, gather(lanes.place, k)) - pointers(memory.place).at(i);
    const V distance = hn::Add(hn::Sqrt(dot(way, way)), rounding);
    const V lower = hn::Sub(hn::LoadU(d, memory.lower + i), swelling);
    const V upper = hn::Add(hn::LoadU(d, memory.upper + i), swelling);
    hn::StoreU(lower, d, memory.lower + i);
    hn::StoreU(upper, d, memory.upper + i);
    // What is not a number makes a gap unknown.
    const V least = hn::Sub(lower, distance), most = hn::Add(upper, distance);
    const auto known = hn::Eq(least, least);
    const V yield = hn::LoadU(d, memory.yield + i);
    hn::StoreU(hn::Add(hn::IfThenElse(known, least, hn::Neg(far)), yield), d, bound + i);
    if (!lowerLimits) continue;
    const V limit = hn::Add(hn::IfThenElse(known, most, far), yield);
    scatter(hn::Min(gather(lanes.limit, k), limit), k, lanes.limit);
  }
}

// Appends the marked pairs, of those from i on, to the batch.
template <class Mask>
HWY_INLINE void append(Mask wanted, std::size_t i, Index k, FeltBatch& batch) {
  const hn::RebindToSigned<D> di;
  if (hn::AllFalse(D(), wanted)) return;
  const std::size_t n = batch.count;
  const auto chosen = hn::RebindMask(di, wanted);
  hn::CompressStore(hn::Iota(di, static_cast<std::int32_t>(i)), chosen, di, batch.pair.data() + n);
  hn::CompressStore(k, chosen, di, batch.point.data() + n);
  batch.count = n + hn::CountTrue(D(), wanted);
}

// Fills the last vector with the pads' point, and gathers all places.
HWY_INLINE void gatherPlaces(const FeltLanes& lanes, FeltBatch& batch) {
  const D d;
  const hn::RebindToSigned<D> di;
  hn::StoreU(hn::Set(di, static_cast<std::int32_t>(FleshSense::kChunk)), di,
             batch.point.data() + batch.count);
  for (std::size_t i = 0; i < batch.count; i += hn::Lanes(d))
    pointers(batch.place).set(i, gather(lanes.place, loadIndex(batch.point.data() + i)));
}

void selectImpl(std::span<const std::int32_t> point, const float* bound, const FeltLanes& lanes,
                FeltBatch& batch) {
  const D d;
  batch.count = 0;
  for (std::size_t i = 0; i < point.size(); i += hn::Lanes(d)) {
    const Index k = loadIndex(point.data() + i);
    append(hn::Le(hn::LoadU(d, bound + i), gather(lanes.limit, k)), i, k, batch);
  }
  gatherPlaces(lanes, batch);
}

void selectNearestImpl(std::span<const std::int32_t> point, float solid, const FeltLanes& lanes,
                       FeltBatch& batch) {
  const D d;
  batch.count = 0;
  for (std::size_t i = 0; i < point.size(); i += hn::Lanes(d)) {
    const Index k = loadIndex(point.data() + i);
    const auto mine = hn::Eq(gather(lanes.nearestSolid, k), hn::Set(d, solid));
    const auto near = hn::Le(gather(lanes.nearest, k), gather(lanes.limit, k));
    append(hn::And(mine, near), i, k, batch);
  }
  gatherPlaces(lanes, batch);
}

void subtractImpl(const FeltLanes& lanes, FeltBatch& batch) {
  const D d;
  for (std::size_t i = 0; i < batch.count; i += hn::Lanes(d)) {
    const V fat = gather(lanes.fat, loadIndex(batch.point.data() + i));
    hn::StoreU(hn::Sub(hn::LoadU(d, batch.gap.data() + i), fat), d, batch.gap.data() + i);
  }
}

void rememberImpl(const KernelFrame& frame, const FeltBatch& batch, const FeltMemory& memory) {
  const D d;
  alignas(kSimdAlignment) float local[3][FleshSense::kPad];
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t i = 0; i < batch.count; i += lanes) {
    const V3 place = toLocal(frame, pointers(batch.place).at(i));
    hn::Store(place.x, d, local[0]);
    hn::Store(place.y, d, local[1]);
    hn::Store(place.z, d, local[2]);
    for (std::size_t l = 0; l < lanes && i + l < batch.count; ++l) {
      const auto pair = static_cast<std::size_t>(batch.pair[i + l]);
      const float gap = batch.gap[i + l];
      memory.place.x[pair] = local[0][l];
      memory.place.y[pair] = local[1][l];
      memory.place.z[pair] = local[2][l];
      memory.lower[pair] = gap > 0 ? kTrust * gap : gap;
      memory.upper[pair] = gap;
    }
  }
}

void absorbImpl(float solid, bool move, const FeltBatch& batch, FeltLanes& lanes) {
  const D d;
  for (std::size_t i = 0; i < batch.count; i += hn::Lanes(d)) {
    const Index k = loadIndex(batch.point.data() + i);
    const V gap = hn::LoadU(d, batch.gap.data() + i);
    const V3 normal = pointers(batch.answer).at(i);
    if (move) {
      V3 place = gather(lanes.place, k), push = gather(lanes.pushNormal, k);
      V pushed = gather(lanes.pushed, k);
      pushOut(gap, normal, place, push, pushed);
      scatter(place, k, lanes.place);
      scatter(push, k, lanes.pushNormal);
      scatter(pushed, k, lanes.pushed);
    }
    V nearest = gather(lanes.nearest, k), nearestSolid = gather(lanes.nearestSolid, k);
    V3 nearestNormal = gather(lanes.nearestNormal, k);
    keepNearest(gap, normal, hn::Set(d, solid), nearest, nearestNormal, nearestSolid);
    scatter(nearest, k, lanes.nearest);
    scatter(nearestNormal, k, lanes.nearestNormal);
    scatter(nearestSolid, k, lanes.nearestSolid);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fascia {

HWY_EXPORT(boundImpl);
HWY_EXPORT(selectImpl);
HWY_EXPORT(selectNearestImpl);
HWY_EXPORT(subtractImpl);
HWY_EXPORT(rememberImpl);
HWY_EXPORT(absorbImpl);

void boundPairs(const FeltSolid& solid, std::span<const std::int32_t> point,
                const FeltMemory& memory, bool lowerLimits, FeltLanes& lanes, float* bound) {
  HWY_DYNAMIC_DISPATCH(boundImpl)(solid, point, memory, lowerLimits, lanes, bound);
}

void selectPairs(std::span<const std::int32_t> point, const float* bound, const FeltLanes& lanes,
                 FeltBatch& batch) {
  HWY_DYNAMIC_DISPATCH(selectImpl)(point, bound, lanes, batch);
}

void selectNearest(std::span<const std::int32_t> point, float solid, const FeltLanes& lanes,
                   FeltBatch& batch) {
  HWY_DYNAMIC_DISPATCH(selectNearestImpl)(point, solid, lanes, batch);
}

void subtractFat(const FeltLanes& lanes, FeltBatch& batch) {
  HWY_DYNAMIC_DISPATCH(subtractImpl)(lanes, batch);
}

void rememberPairs(const KernelFrame& frame, const FeltBatch& batch, const FeltMemory& memory) {
  HWY_DYNAMIC_DISPATCH(rememberImpl)(frame, batch, memory);
}

void absorbPairs(float solid, bool move, const FeltBatch& batch, FeltLanes& lanes) {
  HWY_DYNAMIC_DISPATCH(absorbImpl)(solid, move, batch, lanes);
}

}  // namespace fascia
#endif
