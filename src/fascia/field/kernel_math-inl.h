// Elementary functions on SIMD vectors, for the field kernels. Included once per SIMD target.
// Every polynomial is a minimax fit (Remez exchange); the bound is stated beside it.

#if defined(FASCIA_FIELD_KERNEL_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FASCIA_FIELD_KERNEL_MATH_INL_H_
#undef FASCIA_FIELD_KERNEL_MATH_INL_H_
#else
#define FASCIA_FIELD_KERNEL_MATH_INL_H_
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace fascia::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Estrin's scheme, coefficients from the constant term up, at most 16: half the latency of Horner's
// rule, and latency is what a batch of a single vector costs.
template <std::size_t First, std::size_t Count, class D, class V, std::size_t N>
HWY_INLINE V polynomialPart(D d, V x, V x2, V x4, V x8, const float (&c)[N]) {
  if constexpr (Count == 1) {
    return hn::Set(d, c[First]);
  } else if constexpr (First + Count / 2 >= N) {
    return polynomialPart<First, Count / 2>(d, x, x2, x4, x8, c);
  } else {
    const V low = polynomialPart<First, Count / 2>(d, x, x2, x4, x8, c);
    const V high = polynomialPart<First + Count / 2, Count / 2>(d, x, x2, x4, x8, c);
    return hn::MulAdd(high, Count == 2 ? x : Count == 4 ? x2 : Count == 8 ? x4 : x8, low);
  }
}
template <class D, class V = hn::Vec<D>, std::size_t N>
HWY_INLINE V polynomial(D d, V x, const float (&c)[N]) {
  static_assert(N <= 16);
  const V x2 = hn::Mul(x, x), x4 = hn::Mul(x2, x2);
  return polynomialPart<0, 16>(d, x, x2, x4, hn::Mul(x4, x4), c);
}

// Newton steps that bring the machine's estimates to within 3e-7 (x86 starts from 12 bits or more).
inline constexpr bool kGoodEstimates =
    (HWY_TARGET & (HWY_SSSE3 | HWY_SSE4 | HWY_AVX2 | HWY_AVX3 | HWY_AVX3_DL)) != 0;
inline constexpr int kNewtonSteps = kGoodEstimates ? 1 : 2;

// 1/x for x in [1e-36, 1e36]: a division would cost as much as ten multiplications here.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V reciprocal(D d, V x) {
  V r = hn::ApproximateReciprocal(x);
  for (int i = 0; i < kNewtonSteps; ++i) r = hn::Mul(r, hn::NegMulAdd(x, r, hn::Set(d, 2.0f)));
  return r;
}

// 1/sqrt(x) for x in [1e-36, 1e36].
template <class D, class V = hn::Vec<D>>
HWY_INLINE V inverseSqrt(D d, V x) {
  V r = hn::ApproximateReciprocalSqrt(x);
  const V half = hn::Mul(hn::Set(d, 0.5f), x);
  for (int i = 0; i < kNewtonSteps; ++i) {
    r = hn::Mul(r, hn::NegMulAdd(hn::Mul(half, r), r, hn::Set(d, 1.5f)));
  }
  return r;
}

// log2 of a positive normal number; absolute error < 2e-7 + rounding of the exponent.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V log2Positive(D d, V x) {
  static constexpr float kC[] = {1.442694792e+00f,  -7.213566477e-01f, 4.809384700e-01f,
                                 -3.601038271e-01f, 2.867273377e-01f,  -2.499236576e-01f,
                                 2.367460507e-01f,  -1.459906377e-01f};
  const hn::RebindToSigned<D> di;
  // Subtracting the bits of sqrt(1/2) puts the mantissa into [sqrt(1/2), sqrt(2)).
  const auto kRootHalf = hn::Set(di, 0x3f3504f3);
  const auto shifted = hn::Sub(hn::BitCast(di, x), kRootHalf);
  const V exponent = hn::ConvertTo(d, hn::ShiftRight<23>(shifted));
  const auto mantissaBits = hn::Add(hn::And(shifted, hn::Set(di, 0x007fffff)), kRootHalf);
  const V m = hn::Sub(hn::BitCast(d, mantissaBits), hn::Set(d, 1.0f));
  return hn::MulAdd(m, polynomial(d, m, kC), exponent);
}

// log2(1 + t) for t in [0, 1]; absolute error < 7e-8.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V log2OnePlus(D d, V t) {
  static constexpr float kC[] = {1.442692113e+00f,  -7.212141758e-01f, 4.790583674e-01f,
                                 -3.487194008e-01f, 2.447908021e-01f,  -1.408807766e-01f,
                                 5.407573458e-02f,  -9.802721116e-03f};
  return hn::Mul(t, polynomial(d, t, kC));
}

// 2^x, saturating at 2^±126; relative error < 8e-8.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V exp2Saturating(D d, V x) {
  static constexpr float kC[] = {1.000000072e+00f, 6.931469671e-01f, 2.402211972e-01f,
                                 5.550713274e-02f, 9.675541330e-03f, 1.327647186e-03f};
  const hn::RebindToSigned<D> di;
  x = hn::Min(hn::Max(x, hn::Set(d, -126.0f)), hn::Set(d, 126.0f));
  const V whole = hn::Round(x);
  const V scale =
      hn::BitCast(d, hn::ShiftLeft<23>(hn::Add(hn::ConvertTo(di, whole), hn::Set(di, 127))));
  return hn::Mul(polynomial(d, hn::Sub(x, whole), kC), scale);
}

// Sine and cosine for |x| <= 4; absolute error < 1.2e-7.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void sinCos(D d, V x, V& sine, V& cosine) {
  static constexpr float kSin[] = {9.999999969e-01f, -1.666665070e-01f, 8.332036875e-03f,
                                   -1.950402200e-04f};
  static constexpr float kCos[] = {1.0f, -4.999999962e-01f, 4.166661674e-02f, -1.388661921e-03f,
                                   2.437992941e-05f};
  const hn::RebindToSigned<D> di;
  const V quarters = hn::Round(hn::Mul(x, hn::Set(d, 0.636619772f)));
  // π/2 in two parts (Cody & Waite), so that the reduced angle keeps its low bits.
  V r = hn::NegMulAdd(quarters, hn::Set(d, 1.5707963109016418f), x);
  r = hn::NegMulAdd(quarters, hn::Set(d, 1.5893254712295857e-8f), r);
  const V r2 = hn::Mul(r, r);
  const V s = hn::Mul(r, polynomial(d, r2, kSin));
  const V c = polynomial(d, r2, kCos);
  const auto q = hn::ConvertTo(di, quarters);
  const auto one = hn::Set(di, 1), two = hn::Set(di, 2);
  const auto swap = hn::RebindMask(d, hn::Eq(hn::And(q, one), one));
  const auto negateSin = hn::RebindMask(d, hn::Eq(hn::And(q, two), two));
  const auto negateCos = hn::RebindMask(d, hn::Eq(hn::And(hn::Add(q, one), two), two));
  const V sin0 = hn::IfThenElse(swap, c, s), cos0 = hn::IfThenElse(swap, s, c);
  sine = hn::IfThenElse(negateSin, hn::Neg(sin0), sin0);
  cosine = hn::IfThenElse(negateCos, hn::Neg(cos0), cos0);
}

// Angle of (x, y) in [-π, π]; 0 for (0, 0); absolute error < 2e-7, relative near y = 0, x > 0.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V atan2(D d, V y, V x) {
  static constexpr float kC[] = {9.999999864e-01f,  -3.333309396e-01f, 1.999305412e-01f,
                                 -1.420713380e-01f, 1.065467800e-01f,  -7.533677417e-02f,
                                 4.303938450e-02f,  -1.628301858e-02f, 2.903555245e-03f};
  const V ax = hn::Abs(x), ay = hn::Abs(y);
  const V ratio = hn::Div(hn::Min(ax, ay), hn::Max(hn::Max(ax, ay), hn::Set(d, 1e-30f)));
  V angle = hn::Mul(ratio, polynomial(d, hn::Mul(ratio, ratio), kC));
  angle = hn::IfThenElse(hn::Gt(ay, ax), hn::Sub(hn::Set(d, 1.570796327f), angle), angle);
  angle = hn::IfThenElse(hn::Lt(x, hn::Zero(d)), hn::Sub(hn::Set(d, 3.141592654f), angle), angle);
  return hn::CopySign(angle, y);
}

}  // namespace fascia::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
