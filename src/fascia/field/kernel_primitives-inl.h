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
template <class V>
HWY_INLINE Vector3<V> scaled(const Vector3<V>& a, V s) {
  return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)};
}
template <class V>
HWY_INLINE Vector3<V> withSigns(const Vector3<V>& a, const Vector3<V>& signs) {
  return {hn::CopySign(a.x, signs.x), hn::CopySign(a.y, signs.y), hn::CopySign(a.z, signs.z)};
}

template <class D>
class SphereKernel {
  using V = hn::Vec<D>;

 public:
  SphereKernel(D d, const PrimitiveKernel& k) : radius_(hn::Set(d, k.half_m[0])) {}

  HWY_INLINE FieldValue<V> at(D d, const Vector3<V>& p) const {
    const V length2 = dot(p, p);
    const V length = hn::Sqrt(length2);
    const auto central = hn::Lt(length2, hn::Set(d, 1e-30f));
    const V inverse = hn::IfThenElse(central, hn::Zero(d), hn::Div(hn::Set(d, 1.0f), length));
    Vector3<V> n = scaled(p, inverse);
    n.x = hn::IfThenElse(central, hn::Set(d, 1.0f), n.x);
    return {hn::Sub(length, radius_), n};
  }

 private:
  V radius_;
};

template <class D>
class CapsuleKernel {
  using V = hn::Vec<D>;

 public:
  CapsuleKernel(D d, const PrimitiveKernel& k)
      : ball_(d, k), halfLength_(hn::Set(d, k.halfLength_m)) {}

  HWY_INLINE FieldValue<V> at(D d, const Vector3<V>& p) const {
    const V onAxis = hn::Min(hn::Max(p.z, hn::Neg(halfLength_)), halfLength_);
    return ball_.at(d, {p.x, p.y, hn::Sub(p.z, onAxis)});
  }

 private:
  SphereKernel<D> ball_;
  V halfLength_;
};

// The closest point x of an ellipsoid obeys p − x = t x / a², so x = a² p / (a² + t) with
// Σ (a p / (a² + t))² = 1. Newton on 1/‖·‖ − 1, which is concave and nearly linear in t (the
// secular equation of trust-region methods: Moré & Sorensen 1983), clamped to t >= a (|p| − a),
// which every solution obeys. The distance then comes from the support function of the normal.
template <class D>
class EllipsoidKernel {
  using V = hn::Vec<D>;

 public:
  EllipsoidKernel(D d, const PrimitiveKernel& k) {
    const float least = HWY_MIN(k.half_m[0], HWY_MIN(k.half_m[1], k.half_m[2]));
    least_ = hn::Set(d, 1e-6f * least);
    leastDen_ = hn::Set(d, 1e-7f * least * least);
    half_ = {hn::Set(d, k.half_m[0]), hn::Set(d, k.half_m[1]), hn::Set(d, k.half_m[2])};
    square_ = {hn::Mul(half_.x, half_.x), hn::Mul(half_.y, half_.y), hn::Mul(half_.z, half_.z)};
    inverse_ = {hn::Set(d, 1 / k.half_m[0]), hn::Set(d, 1 / k.half_m[1]),
                hn::Set(d, 1 / k.half_m[2])};
  }

  HWY_INLINE FieldValue<V> at(D d, const Vector3<V>& p) const {
    // Off the symmetry planes by a hair: there the normal would be 0 / 0 beyond the focal curves.
    const Vector3<V> m = {hn::Max(hn::Abs(p.x), least_), hn::Max(hn::Abs(p.y), least_),
                          hn::Max(hn::Abs(p.z), least_)};
    const Vector3<V> c = {hn::Mul(m.x, half_.x), hn::Mul(m.y, half_.y), hn::Mul(m.z, half_.z)};
    V t = firstGuess(d, m, c);
    const V low =
        hn::Max(hn::Sub(c.x, square_.x), hn::Max(hn::Sub(c.y, square_.y), hn::Sub(c.z, square_.z)));
    t = hn::Max(t, low);
    for (int i = 0; i < 2; ++i) t = hn::Max(newton(d, c, t), low);
    const Vector3<V> r = reciprocals(d, t);
    Vector3<V> n = {hn::Mul(m.x, r.x), hn::Mul(m.y, r.y), hn::Mul(m.z, r.z)};
    n = scaled(n, hn::Div(hn::Set(d, 1.0f), hn::Sqrt(dot(n, n))));
    const Vector3<V> s = {hn::Mul(n.x, half_.x), hn::Mul(n.y, half_.y), hn::Mul(n.z, half_.z)};
    const Vector3<V> magnitude = {hn::Abs(p.x), hn::Abs(p.y), hn::Abs(p.z)};
    return {hn::Sub(dot(n, magnitude), hn::Sqrt(dot(s, s))), withSigns(n, p)};
  }

 private:
  // Distance to the tangent plane at the radial projection, as a value of t.
  HWY_INLINE V firstGuess(D d, const Vector3<V>& m, const Vector3<V>&) const {
    const Vector3<V> u = {hn::Mul(m.x, inverse_.x), hn::Mul(m.y, inverse_.y),
                          hn::Mul(m.z, inverse_.z)};
    const Vector3<V> g = {hn::Mul(u.x, inverse_.x), hn::Mul(u.y, inverse_.y),
                          hn::Mul(u.z, inverse_.z)};
    const V gauge2 = dot(u, u);
    const V excess = hn::Sub(hn::Sqrt(gauge2), hn::Set(d, 1.0f));
    return hn::Mul(excess, hn::Div(gauge2, dot(g, g)));
  }

  HWY_INLINE Vector3<V> reciprocals(D d, V t) const {
    const V one = hn::Set(d, 1.0f);
    return {hn::Div(one, hn::Max(hn::Add(square_.x, t), leastDen_)),
            hn::Div(one, hn::Max(hn::Add(square_.y, t), leastDen_)),
            hn::Div(one, hn::Max(hn::Add(square_.z, t), leastDen_))};
  }

  HWY_INLINE V newton(D d, const Vector3<V>& c, V t) const {
    const Vector3<V> r = reciprocals(d, t);
    const Vector3<V> s = {hn::Mul(c.x, r.x), hn::Mul(c.y, r.y), hn::Mul(c.z, r.z)};
    const Vector3<V> s2 = {hn::Mul(s.x, s.x), hn::Mul(s.y, s.y), hn::Mul(s.z, s.z)};
    const V sum = hn::Add(s2.x, hn::Add(s2.y, s2.z));
    const V step = hn::Div(hn::Mul(sum, hn::Sub(hn::Sqrt(sum), hn::Set(d, 1.0f))), dot(s2, r));
    return hn::Add(t, step);
  }

  Vector3<V> half_, square_, inverse_;
  V least_, leastDen_;
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
  SuperellipsoidKernel(D d, const PrimitiveKernel& k) {
    inverse_ = {hn::Set(d, 1 / k.half_m[0]), hn::Set(d, 1 / k.half_m[1]),
                hn::Set(d, 1 / k.half_m[2])};
    tiny_ = {hn::Set(d, 1e-9f * k.half_m[0]), hn::Set(d, 1e-9f * k.half_m[1]),
             hn::Set(d, 1e-9f * k.half_m[2])};
    eastWest_ = {hn::Set(d, k.eastWestPower), hn::Set(d, 1 / k.eastWestPower)};
    northSouth_ = {hn::Set(d, k.northSouthPower), hn::Set(d, 1 / k.northSouthPower)};
  }

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
  struct Power {
    V value, inverse;
  };
  struct Norm {
    V log, shareA, shareB;
  };
  struct Plane {
    Vector3<V> normal;
    V offset_m;
  };

  // log2 of (a^p + b^p)^(1/p) from the logarithms of a and b, and each one's share of the sum.
  static HWY_INLINE Norm powerNorm(D d, V a, V b, const Power& p) {
    const V larger = hn::Max(a, b);
    const V t = exp2Saturating(d, hn::Mul(p.value, hn::Sub(hn::Min(a, b), larger)));
    const V major = hn::Div(hn::Set(d, 1.0f), hn::Add(hn::Set(d, 1.0f), t));
    const V minor = hn::Mul(t, major);
    const auto aLeads = hn::Ge(a, b);
    return {hn::MulAdd(p.inverse, log2OnePlus(d, t), larger), hn::IfThenElse(aLeads, major, minor),
            hn::IfThenElse(aLeads, minor, major)};
  }

  HWY_INLINE Plane tangentPlane(D d, const Vector3<V>& m) const {
    const Vector3<V> p = {hn::Max(m.x, tiny_.x), hn::Max(m.y, tiny_.y), hn::Max(m.z, tiny_.z)};
    const V lx = log2Positive(d, hn::Mul(p.x, inverse_.x));
    const V ly = log2Positive(d, hn::Mul(p.y, inverse_.y));
    const V lz = log2Positive(d, hn::Mul(p.z, inverse_.z));
    const Norm lateral = powerNorm(d, lx, ly, eastWest_);
    const Norm whole = powerNorm(d, lateral.log, lz, northSouth_);
    const Vector3<V> slope = {hn::Div(hn::Mul(whole.shareA, lateral.shareA), p.x),
                              hn::Div(hn::Mul(whole.shareA, lateral.shareB), p.y),
                              hn::Div(whole.shareB, p.z)};
    const V inverseLength = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(dot(slope, slope)));
    const V inverseGauge = exp2Saturating(d, hn::Neg(whole.log));
    return {scaled(slope, inverseLength), hn::Mul(inverseLength, inverseGauge)};
  }

  Vector3<V> inverse_, tiny_;
  Power eastWest_, northSouth_;
};

}  // namespace fascia::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
