// Signed distances of the primitives on SIMD vectors. Included once per SIMD target.

#if defined(FASCIA_FIELD_KERNEL_PRIMITIVES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FASCIA_FIELD_KERNEL_PRIMITIVES_INL_H_
#undef FASCIA_FIELD_KERNEL_PRIMITIVES_INL_H_
#else
#define FASCIA_FIELD_KERNEL_PRIMITIVES_INL_H_
#endif

#include <fascia/field/kernel_math-inl.h>
#include <fascia/field/kernels.h>

HWY_BEFORE_NAMESPACE();
namespace fascia::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class V>
struct Vector3 {
  V x, y, z;
};
template <class V>
struct FieldValue {
  V distance_m;
  Vector3<V> normal;
};

template <class V>
HWY_INLINE V dot(const Vector3<V>& a, const Vector3<V>& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
template <class D, class V = hn::Vec<D>>
HWY_INLINE Vector3<V> constants(D d, const float (&c)[3]) {
  return {hn::Set(d, c[0]), hn::Set(d, c[1]), hn::Set(d, c[2])};
}
template <class V>
HWY_INLINE Vector3<V> product(const Vector3<V>& a, const Vector3<V>& b) {
  return {hn::Mul(a.x, b.x), hn::Mul(a.y, b.y), hn::Mul(a.z, b.z)};
}
template <class V>
HWY_INLINE Vector3<V> scaled(const Vector3<V>& a, V s) {
  return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)};
}
template <class V>
HWY_INLINE Vector3<V> withSigns(const Vector3<V>& a, const Vector3<V>& signs) {
  return {hn::CopySign(a.x, signs.x), hn::CopySign(a.y, signs.y), hn::CopySign(a.z, signs.z)};
}

// Constants stay in memory as floats and are broadcast where they are used: with the short batches
// of the skin, filling registers first would cost more than the evaluation.
template <class D>
class SphereKernel {
  using V = hn::Vec<D>;

 public:
  explicit SphereKernel(const PrimitiveKernel& k) : k_(k) {}

  HWY_INLINE FieldValue<V> at(D d, const Vector3<V>& p) const {
    const V length2 = dot(p, p);
    const V length = hn::Sqrt(length2);
    const auto central = hn::Lt(length2, hn::Set(d, 1e-30f));
    const V inverse = hn::IfThenElse(central, hn::Zero(d), hn::Div(hn::Set(d, 1.0f), length));
    Vector3<V> n = scaled(p, inverse);
    n.x = hn::IfThenElse(central, hn::Set(d, 1.0f), n.x);
    return {hn::Sub(length, hn::Set(d, k_.half_m[0])), n};
  }

 private:
  const PrimitiveKernel& k_;
};

template <class D>
class CapsuleKernel {
  using V = hn::Vec<D>;

 public:
  explicit CapsuleKernel(const PrimitiveKernel& k) : k_(k) {}

  HWY_INLINE FieldValue<V> at(D d, const Vector3<V>& p) const {
    const V half = hn::Set(d, k_.halfLength_m);
    const V onAxis = hn::Min(hn::Max(p.z, hn::Neg(half)), half);
    return SphereKernel<D>(k_).at(d, {p.x, p.y, hn::Sub(p.z, onAxis)});
  }

 private:
  const PrimitiveKernel& k_;
};

// The closest point x of an ellipsoid obeys p − x = t x / a², so x = a² p / (a² + t) with
// Σ (a p / (a² + t))² = 1. Newton on 1/‖·‖ − 1, which is concave and nearly linear in t (the
// secular equation of trust-region methods: Moré & Sorensen 1983), clamped to t >= a (|p| − a),
// which every solution obeys. The distance then comes from the support function of the normal.
template <class D>
class EllipsoidKernel {
  using V = hn::Vec<D>;

 public:
  explicit EllipsoidKernel(const PrimitiveKernel& k) : k_(k) {}
  HWY_INLINE FieldValue<V> at(D d, const Vector3<V>& p) const {
    // Off the symmetry planes by a hair: there the normal would be 0 / 0 beyond the focal curves.
    const V hair = hn::Set(d, 1e-6f * k_.least_m);
    const Vector3<V> a = constants(d, k_.half_m), square = constants(d, k_.square_m2);
    const Vector3<V> magnitude = {hn::Abs(p.x), hn::Abs(p.y), hn::Abs(p.z)};
    const Vector3<V> m = {hn::Max(magnitude.x, hair), hn::Max(magnitude.y, hair),
                          hn::Max(magnitude.z, hair)};
    const Vector3<V> c = product(m, a);
    const V low =
        hn::Max(hn::Sub(c.x, square.x), hn::Max(hn::Sub(c.y, square.y), hn::Sub(c.z, square.z)));
    V t = hn::Max(firstGuess(d, m), low);
    for (int i = 0; i < 2; ++i) t = hn::Max(newton(d, c, t), low);
    Vector3<V> n = product(m, reciprocals(d, t));
    n = scaled(n, inverseSqrt(d, dot(n, n)));
    const Vector3<V> s = product(n, a);
    return {hn::Sub(dot(n, magnitude), hn::Sqrt(dot(s, s))), withSigns(n, p)};
  }

 private:
  // Distance to the tangent plane at the radial projection, as a value of t.
  HWY_INLINE V firstGuess(D d, const Vector3<V>& m) const {
    const Vector3<V> inverse = constants(d, k_.inverse_per_m);
    const Vector3<V> u = product(m, inverse), g = product(u, inverse);
    const V gauge2 = dot(u, u);
    const V excess = hn::MulSub(gauge2, inverseSqrt(d, gauge2), hn::Set(d, 1.0f));
    return hn::Mul(excess, hn::Mul(gauge2, reciprocal(d, dot(g, g))));
  }

  HWY_INLINE Vector3<V> reciprocals(D d, V t) const {
    const V least = hn::Set(d, 1e-7f * k_.least_m * k_.least_m);
    const Vector3<V> square = constants(d, k_.square_m2);
    return {reciprocal(d, hn::Max(hn::Add(square.x, t), least)),
            reciprocal(d, hn::Max(hn::Add(square.y, t), least)),
            reciprocal(d, hn::Max(hn::Add(square.z, t), least))};
  }

  HWY_INLINE V newton(D d, const Vector3<V>& c, V t) const {
    const Vector3<V> r = reciprocals(d, t);
    const Vector3<V> s = product(c, r), s2 = product(s, s);
    const V sum = hn::Add(s2.x, hn::Add(s2.y, s2.z));
    const V excess = hn::MulSub(sum, inverseSqrt(d, sum), hn::Set(d, 1.0f));
    return hn::MulAdd(hn::Mul(sum, excess), reciprocal(d, dot(s2, r)), t);
  }

  const PrimitiveKernel& k_;
};

// The gauge h of a superellipsoid (homogeneous of degree 1, h = 1 on the surface), in logarithms so
// that no power overflows:
//   ρ = (|x/a|^P + |y/b|^P)^(1/P), h = (ρ^Q + |z/c|^Q)^(1/Q), P = 2/e2, Q = 2/e1 (Barr 1981).
// The tangent plane at the radial projection p / h has the normal of the vector slope_i = w_i / x_i
// (w: the share of each axis, Σ w = 1; ∇h = h slope) and the distance 1 / (h |slope|) from the
// origin. A second plane is taken where p meets the first one; the farther plane wins.
template <class D>
class SuperellipsoidKernel {
  using V = hn::Vec<D>;

 public:
  explicit SuperellipsoidKernel(const PrimitiveKernel& k) : k_(k) {}

  HWY_INLINE FieldValue<V> at(D d, const Vector3<V>& p) const {
    const Vector3<V> m = {hn::Abs(p.x), hn::Abs(p.y), hn::Abs(p.z)};
    const Plane first = tangentPlane(d, m);
    const V d0 = hn::Sub(dot(first.normal, m), first.offset_m);
    const V zero = hn::Zero(d);
    const Vector3<V> foot = {hn::Max(hn::NegMulAdd(d0, first.normal.x, m.x), zero),
                             hn::Max(hn::NegMulAdd(d0, first.normal.y, m.y), zero),
                             hn::Max(hn::NegMulAdd(d0, first.normal.z, m.z), zero)};
    const Plane second = tangentPlane(d, foot);
    const V d1 = hn::Sub(dot(second.normal, m), second.offset_m);
    const auto better = hn::Gt(d1, d0);
    const Vector3<V> n = {hn::IfThenElse(better, second.normal.x, first.normal.x),
                          hn::IfThenElse(better, second.normal.y, first.normal.y),
                          hn::IfThenElse(better, second.normal.z, first.normal.z)};
    return {hn::Max(d0, d1), withSigns(n, p)};
  }

 private:
  struct Norm {
    V log, shareA, shareB;
  };
  struct Plane {
    Vector3<V> normal;
    V offset_m;
  };

  // log2 of (a^p + b^p)^(1/p) from the logarithms of a and b, and each one's share of the sum.
  static HWY_INLINE Norm powerNorm(D d, V a, V b, float power, float root) {
    const V larger = hn::Max(a, b);
    const V t = exp2Saturating(d, hn::Mul(hn::Set(d, power), hn::Sub(hn::Min(a, b), larger)));
    const V major = reciprocal(d, hn::Add(hn::Set(d, 1.0f), t));
    const V minor = hn::Mul(t, major);
    const auto aLeads = hn::Ge(a, b);
    return {hn::MulAdd(hn::Set(d, root), log2OnePlus(d, t), larger),
            hn::IfThenElse(aLeads, major, minor), hn::IfThenElse(aLeads, minor, major)};
  }

  HWY_INLINE Plane tangentPlane(D d, const Vector3<V>& m) const {
    const V tiny = hn::Set(d, 1e-9f);
    const Vector3<V> inverse = constants(d, k_.inverse_per_m);
    const Vector3<V> u = {hn::Max(hn::Mul(m.x, inverse.x), tiny),
                          hn::Max(hn::Mul(m.y, inverse.y), tiny),
                          hn::Max(hn::Mul(m.z, inverse.z), tiny)};
    const Norm lateral =
        powerNorm(d, log2Positive(d, u.x), log2Positive(d, u.y), k_.eastWestPower, k_.eastWestRoot);
    const Norm whole =
        powerNorm(d, lateral.log, log2Positive(d, u.z), k_.northSouthPower, k_.northSouthRoot);
    const Vector3<V> share = {hn::Mul(whole.shareA, lateral.shareA),
                              hn::Mul(whole.shareA, lateral.shareB), whole.shareB};
    const Vector3<V> overU = {reciprocal(d, u.x), reciprocal(d, u.y), reciprocal(d, u.z)};
    const Vector3<V> slope = product(product(share, overU), inverse);
    const V inverseLength = inverseSqrt(d, dot(slope, slope));
    const V inverseGauge = exp2Saturating(d, hn::Neg(whole.log));
    return {scaled(slope, inverseLength), hn::Mul(inverseLength, inverseGauge)};
  }

  const PrimitiveKernel& k_;
};

}  // namespace fascia::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
