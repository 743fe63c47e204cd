// Barr's deformations on SIMD vectors: inverse maps and normals. Included once per SIMD target.
// The formulas are derived beside their double-precision twins in deformations/.

#if defined(FASCIA_FIELD_KERNEL_DEFORMATIONS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FASCIA_FIELD_KERNEL_DEFORMATIONS_INL_H_
#undef FASCIA_FIELD_KERNEL_DEFORMATIONS_INL_H_
#else
#define FASCIA_FIELD_KERNEL_DEFORMATIONS_INL_H_
#endif

#include <fascia/field/kernel_primitives-inl.h>

HWY_BEFORE_NAMESPACE();
namespace fascia::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// What the way inward leaves for the way outward; meaning per deformation.
template <class V>
struct Undone {
  V a, b, c, d;
};

template <class D, class V = hn::Vec<D>>
HWY_INLINE V clampTo(D d, V z, float half) {
  return hn::Min(hn::Max(z, hn::Set(d, -half)), hn::Set(d, half));
}

// The rate where z is within the deformed interval, else 0: beyond it the map is rigid.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V rateWithin(D d, V z, const DeformationKernel& k) {
  return hn::IfThenElseZero(hn::Le(hn::Abs(z), hn::Set(d, k.zHalf_m)), hn::Set(d, k.rate_per_m));
}

// a = 1/scale; b, c = undeformed x, y times slope; d unused. The slope counts as it is on the
// surface, at most at its reach: a tangent plane is what measures distances, and far away the map
// is steep.
template <class D, class V = hn::Vec<D>>
HWY_INLINE Undone<V> undoTaper(D d, const DeformationKernel& k, Vector3<V>& p) {
  const V one = hn::Set(d, 1.0f);
  const V scale = hn::MulAdd(hn::Set(d, k.rate_per_m), clampTo(d, p.z, k.zHalf_m), one);
  const V inverse = hn::Div(one, scale);
  p.x = hn::Mul(p.x, inverse);
  p.y = hn::Mul(p.y, inverse);
  const V slope = rateWithin(d, p.z, k);
  return {inverse, hn::Mul(slope, clampTo(d, p.x, k.reach_m)),
          hn::Mul(slope, clampTo(d, p.y, k.reach_m)), hn::Zero(d)};
}

template <class V>
HWY_INLINE void redoTaper(const Undone<V>& u, Vector3<V>& n) {
  n.x = hn::Mul(n.x, u.a);
  n.y = hn::Mul(n.y, u.a);
  n.z = hn::NegMulAdd(u.b, n.x, hn::NegMulAdd(u.c, n.y, n.z));
}

// a, b = sine, cosine; c, d = undeformed x, y times rate.
template <class D, class V = hn::Vec<D>>
HWY_INLINE Undone<V> undoTwist(D d, const DeformationKernel& k, Vector3<V>& p) {
  V s, c;
  sinCos(d, hn::Mul(hn::Set(d, k.rate_per_m), clampTo(d, p.z, k.zHalf_m)), s, c);
  const V x = hn::MulAdd(c, p.x, hn::Mul(s, p.y));
  const V y = hn::NegMulAdd(s, p.x, hn::Mul(c, p.y));
  p.x = x;
  p.y = y;
  const V rate = rateWithin(d, p.z, k);
  return {s, c, hn::Mul(rate, x), hn::Mul(rate, y)};
}

template <class V>
HWY_INLINE void redoTwist(const Undone<V>& u, Vector3<V>& n) {
  n.z = hn::MulAdd(u.d, n.x, hn::NegMulAdd(u.c, n.y, n.z));
  const V x = hn::NegMulAdd(u.a, n.y, hn::Mul(u.b, n.x));
  n.y = hn::MulAdd(u.a, n.x, hn::Mul(u.b, n.y));
  n.x = x;
}

// a, b = sine, cosine; c = 1/(1 − k x) within the bent interval, else 1; d unused.
template <class D, class V = hn::Vec<D>>
HWY_INLINE Undone<V> undoBend(D d, const DeformationKernel& k, Vector3<V>& p) {
  const V one = hn::Set(d, 1.0f);
  const V curvature = hn::Set(d, k.rate_per_m), radius = hn::Set(d, 1.0f / k.rate_per_m);
  const V angle = atan2(d, hn::Mul(curvature, p.z), hn::NegMulAdd(curvature, p.x, one));
  const V z = hn::Mul(angle, radius);
  const V onAxis = clampTo(d, z, k.zHalf_m);
  V s, c;
  sinCos(d, hn::Mul(onAxis, curvature), s, c);
  const V arm = hn::Mul(s, radius);  // sin/k; (1 − cos)/k = arm sin/(1 + cos) keeps small k exact
  const V x = hn::MulAdd(c, p.x, hn::NegMulAdd(s, p.z, hn::Div(hn::Mul(arm, s), hn::Add(one, c))));
  const V beyond = hn::MulAdd(s, p.x, hn::MulSub(c, p.z, arm));
  const auto within = hn::Le(hn::Abs(z), hn::Set(d, k.zHalf_m));
  p = {x, p.y, hn::IfThenElse(within, z, hn::Add(onAxis, beyond))};
  const V stretch = hn::Max(hn::NegMulAdd(curvature, x, one), hn::Set(d, 1e-3f));
  return {s, c, hn::IfThenElse(within, hn::Div(one, stretch), one), hn::Zero(d)};
}

template <class V>
HWY_INLINE void redoBend(const Undone<V>& u, Vector3<V>& n) {
  const V z = hn::Mul(n.z, u.c);
  const V x = hn::MulAdd(u.b, n.x, hn::Mul(u.a, z));
  n.z = hn::NegMulAdd(u.a, n.x, hn::Mul(u.b, z));
  n.x = x;
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE Undone<V> undo(D d, const DeformationKernel& k, Vector3<V>& p) {
  switch (k.kind) {
    case DeformationKernel::Kind::taper:
      return undoTaper(d, k, p);
    case DeformationKernel::Kind::twist:
      return undoTwist(d, k, p);
    case DeformationKernel::Kind::bend:
      break;
  }
  return undoBend(d, k, p);
}

template <class V>
HWY_INLINE void redo(const DeformationKernel& k, const Undone<V>& u, Vector3<V>& n) {
  switch (k.kind) {
    case DeformationKernel::Kind::taper:
      return redoTaper(u, n);
    case DeformationKernel::Kind::twist:
      return redoTwist(u, n);
    case DeformationKernel::Kind::bend:
      return redoBend(u, n);
  }
}

}  // namespace fascia::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
