// How points take up a solid's distances; for contact kernels. Included once per Highway target.
#if defined(FASCIA_SKIN_ABSORB_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FASCIA_SKIN_ABSORB_INL_H_
#undef FASCIA_SKIN_ABSORB_INL_H_
#else
#define FASCIA_SKIN_ABSORB_INL_H_
#endif

#include <fascia/skin/point/simd_vector-inl.h>

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {

// Moves points that are inside (gap < 0) out along the normal. A point that another solid has just
// moved (by `push`), and that would be moved back into it, leaves along that one's surface instead:
// in a crease between two solids going to and fro would take dozens of turns. Along the other's
// surface t = n − (n·p) p the way out is depth / (n·t), n·t = 1 − (n·p)².
HWY_INLINE void pushOut(V gap, V3 normal, V3& place, V3& push, V& pushed) {
  const D d;
  const V zero = hn::Zero(d);
  const auto inside = hn::Lt(gap, zero);
  const V back = hn::Min(dot(normal, push), zero);
  const V slope = hn::Max(hn::NegMulAdd(back, back, hn::Set(d, 1.f)), hn::Set(d, 0.02f));
  const V3 along = mulAdd(hn::Neg(back), push, normal);
  const V way = hn::Div(hn::Neg(gap), slope);
  place = select(inside, mulAdd(way, along, place), place);
  pushed = hn::Add(pushed, hn::IfThenElseZero(inside, way));
  push = select(inside, normal, push);
}

// Keeps the nearest solid.
HWY_INLINE void keepNearest(V gap, V3 normal, V solid, V& nearest, V3& nearestNormal,
                            V& nearestSolid) {
  const D d;
  const V outside = hn::Max(gap, hn::Zero(d));
  const auto nearer = hn::Lt(outside, nearest);
  nearest = hn::Min(outside, nearest);
  nearestNormal = select(nearer, normal, nearestNormal);
  nearestSolid = hn::IfThenElse(nearer, solid, nearestSolid);
}

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#endif
