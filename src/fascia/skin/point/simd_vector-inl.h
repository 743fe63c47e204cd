// Three-component vectors of SIMD lanes for the skin's kernels. Included once per Highway target.
#if defined(FASCIA_SKIN_SIMD_VECTOR_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FASCIA_SKIN_SIMD_VECTOR_INL_H_
#undef FASCIA_SKIN_SIMD_VECTOR_INL_H_
#else
#define FASCIA_SKIN_SIMD_VECTOR_INL_H_
#endif

#include <fascia/base/aligned.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;

struct V3 {
  V x, y, z;
};
HWY_INLINE V3 operator+(V3 a, V3 b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE V3 operator-(V3 a, V3 b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE V3 scaled(V s, V3 a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
HWY_INLINE V3 mulAdd(V s, V3 a, V3 b) {
  return {hn::MulAdd(s, a.x, b.x), hn::MulAdd(s, a.y, b.y), hn::MulAdd(s, a.z, b.z)};
}
HWY_INLINE V dot(V3 a, V3 b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE V3 cross(V3 a, V3 b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}
template <class M>
HWY_INLINE V3 select(M mask, V3 yes, V3 no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
          hn::IfThenElse(mask, yes.z, no.z)};
}
HWY_INLINE V clampAbs(V t, V limit) {
  return hn::Max(hn::Neg(limit), hn::Min(t, limit));
}
// 1/√a for a > 0: the approximation and one Newton step, within 2 ulp of exact.
HWY_INLINE V inverseRoot(V a) {
  const D d;
  const V r = hn::ApproximateReciprocalSqrt(a);
  return hn::Mul(r, hn::NegMulAdd(hn::Mul(hn::Mul(a, r), r), hn::Set(d, 0.5f), hn::Set(d, 1.5f)));
}

// Indices are signed: one before a row is its pad.
struct Pointers {
  const float *x, *y, *z;
  HWY_INLINE V3 at(std::ptrdiff_t k) const {
    const D d;
    return {hn::LoadU(d, x + k), hn::LoadU(d, y + k), hn::LoadU(d, z + k)};
  }
};
struct MutablePointers {
  float *x, *y, *z;
  HWY_INLINE V3 at(std::ptrdiff_t k) const { return Pointers{x, y, z}.at(k); }
  HWY_INLINE void set(std::ptrdiff_t k, V3 v) const {
    const D d;
    hn::StoreU(v.x, d, x + k), hn::StoreU(v.y, d, y + k), hn::StoreU(v.z, d, z + k);
  }
};
inline Pointers pointers(const VectorArray& a) {
  return {a.x.data(), a.y.data(), a.z.data()};
}
inline MutablePointers pointers(VectorArray& a) {
  return {a.x.data(), a.y.data(), a.z.data()};
}

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#endif
