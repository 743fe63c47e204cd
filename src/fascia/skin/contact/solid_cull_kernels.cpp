#include <fascia/skin/contact/solid_cull_kernels.h>

#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fascia/skin/contact/solid_cull_kernels.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h

#include <fascia/skin/point/simd_vector-inl.h>

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {

void ageGapsImpl(const BlockMotion& block, const CulledSolids& solids, float* gaps) {
  const D d;
  for (std::size_t s = 0; s < solids.padded(); s += hn::Lanes(d)) {
    const auto load = [&](const float* list) HWY_ATTR { return hn::LoadU(d, list + s); };
    V from[3], way2 = hn::Zero(d);
    for (int a = 0; a < 3; ++a)
      from[a] = hn::Sub(hn::Set(d, block.center[a]), load(solids.origin(a)));
    for (int a = 0; a < 3; ++a) {
      V matter = load(solids.shift(a));
      for (int b = 0; b < 3; ++b) matter = hn::MulAdd(load(solids.change(a, b)), from[b], matter);
      const V way = hn::Sub(hn::Set(d, block.way[a]), matter);
      way2 = hn::MulAdd(way, way, way2);
    }
    const V rigid = hn::Add(hn::Sqrt(way2), hn::Set(d, block.spread_m));
    const V turned = hn::MulAdd(load(solids.turn()), hn::Set(d, block.radius_m), rigid);
    const V nearer = hn::Mul(load(solids.steepness()), hn::Add(turned, load(solids.extra_m())));
    // Also what is not a number makes a gap unknown.
    const auto known = hn::Lt(nearer, hn::Set(d, -kUnknownGap_m));
    hn::StoreU(hn::IfThenElse(known, hn::Sub(load(gaps), nearer), hn::Set(d, kUnknownGap_m)), d,
               gaps + s);
  }
}

std::size_t findNearImpl(const BlockBox& box, const CulledSolids& solids, float reach,
                         const float* gaps, std::int32_t* nearby) {
  const D d;
  const hn::RebindToSigned<D> di;
  std::size_t found = 0;
  for (std::size_t s = 0; s < solids.padded(); s += hn::Lanes(d)) {
    auto isNear =
        hn::Lt(hn::Iota(d, static_cast<float>(s)), hn::Set(d, static_cast<float>(solids.count())));
    if (gaps) isNear = hn::And(isNear, hn::Le(hn::LoadU(d, gaps + s), hn::Set(d, reach)));
    for (int a = 0; a < 3; ++a) {
      const V low = hn::Set(d, box.low[a] - reach), high = hn::Set(d, box.high[a] + reach);
      isNear = hn::And(isNear, hn::And(hn::Le(low, hn::LoadU(d, solids.high(a) + s)),
                                       hn::Ge(high, hn::LoadU(d, solids.low(a) + s))));
    }
    if (hn::AllFalse(d, isNear)) continue;
    found += hn::CompressStore(hn::Iota(di, static_cast<std::int32_t>(s)),
                               hn::RebindMask(di, isNear), di, nearby + found);
  }
  return found;
}

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fascia {

HWY_EXPORT(ageGapsImpl);
HWY_EXPORT(findNearImpl);

void CulledSolids::resize(std::size_t count) {
  count_ = count;
  values_.assign(kLists * padded(), 0.f);
}

// Rounded outwards: a solid too many is tested in vain, one too few would be missed.
void CulledSolids::setBox(std::size_t solid, const Box& box) {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  for (int a = 0; a < 3; ++a) {
    list(a)[solid] = std::nextafter(static_cast<float>(box.low[a]), -kFar);
    list(3 + a)[solid] = std::nextafter(static_cast<float>(box.high[a]), kFar);
  }
}

void CulledSolids::setMotion(std::size_t solid, const Motion& m) {
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) list(6 + 3 * a + b)[solid] = m.change(a, b);
    list(15 + a)[solid] = m.origin[a];
    list(18 + a)[solid] = m.shift[a];
  }
  list(21)[solid] = m.turn;
  list(22)[solid] = m.extra_m;
  list(23)[solid] = m.steepness;
}

void ageGaps(const BlockMotion& block, const CulledSolids& solids, float* gaps) {
  HWY_DYNAMIC_DISPATCH(ageGapsImpl)(block, solids, gaps);
}

std::size_t findNearSolids(const BlockBox& box, const CulledSolids& solids, float reach_m,
                           const float* gaps, std::int32_t* nearby) {
  return HWY_DYNAMIC_DISPATCH(findNearImpl)(box, solids, reach_m, gaps, nearby);
}

}  // namespace fascia
#endif
