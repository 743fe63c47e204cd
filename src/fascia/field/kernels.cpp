#include <fascia/field/kernels.h>

// SSE4, AVX2 and AVX-512 besides the baseline: more targets cost compile time, and gain nothing.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fascia/field/kernels.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, which includes this file once per target:
#include <hwy/highway.h>

#include <fascia/field/kernel_deformations-inl.h>

HWY_BEFORE_NAMESPACE();
namespace fascia::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kMaxLanes = 16;
using Tag = hn::CappedTag<float, kMaxLanes>;
using Vector = hn::Vec<Tag>;

struct Frame {
  Vector r[3][3], t[3];

  Frame(Tag d, const KernelFrame& f) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) r[i][j] = hn::Set(d, f.rotation[i][j]);
      t[i] = hn::Set(d, f.translation_m[i]);
    }
  }
  HWY_INLINE Vector3<Vector> toLocal(Tag d, const Vector3<Vector>& p) const {
    const Vector x = clampTo(d, hn::Sub(p.x, t[0]), 1e9f);
    const Vector y = clampTo(d, hn::Sub(p.y, t[1]), 1e9f);
    const Vector z = clampTo(d, hn::Sub(p.z, t[2]), 1e9f);
    return {hn::MulAdd(r[0][0], x, hn::MulAdd(r[1][0], y, hn::Mul(r[2][0], z))),
            hn::MulAdd(r[0][1], x, hn::MulAdd(r[1][1], y, hn::Mul(r[2][1], z))),
            hn::MulAdd(r[0][2], x, hn::MulAdd(r[1][2], y, hn::Mul(r[2][2], z)))};
  }
  HWY_INLINE Vector3<Vector> toWorld(const Vector3<Vector>& n) const {
    return {hn::MulAdd(r[0][0], n.x, hn::MulAdd(r[0][1], n.y, hn::Mul(r[0][2], n.z))),
            hn::MulAdd(r[1][0], n.x, hn::MulAdd(r[1][1], n.y, hn::Mul(r[1][2], n.z))),
            hn::MulAdd(r[2][0], n.x, hn::MulAdd(r[2][1], n.y, hn::Mul(r[2][2], n.z)))};
  }
};

// Undo the deformations last to first, ask the primitive, then carry its gradient outward by the
// inverse transposed Jacobians. Its length says how much the deformation compresses distances.
template <class Primitive>
HWY_INLINE FieldValue<Vector> deformedAt(Tag d, const SolidKernel& solid,
                                         const Primitive& primitive, Vector3<Vector> p) {
  // In memory, for a vector type without a fixed size cannot be an array's element.
  HWY_ALIGN float kept[kMaxDeformations][4][kMaxLanes];
  for (std::size_t i = solid.deformationCount; i-- > 0;) {
    const Undone<Vector> u = undo(d, solid.deformations[i], p);
    hn::Store(u.a, d, kept[i][0]);
    hn::Store(u.b, d, kept[i][1]);
    hn::Store(u.c, d, kept[i][2]);
    hn::Store(u.d, d, kept[i][3]);
  }
  FieldValue<Vector> value = primitive.at(d, p);
  for (std::size_t i = 0; i < solid.deformationCount; ++i) {
    const Undone<Vector> u = {hn::Load(d, kept[i][0]), hn::Load(d, kept[i][1]),
                              hn::Load(d, kept[i][2]), hn::Load(d, kept[i][3])};
    redo(solid.deformations[i], u, value.normal);
  }
  const Vector inverse = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(dot(value.normal, value.normal)));
  return {hn::Mul(value.distance_m, inverse), scaled(value.normal, inverse)};
}

template <class Primitive>
HWY_INLINE void evaluateLanes(Tag d, const SolidKernel& solid, const Primitive& primitive,
                              const Frame& frame, const float* x, const float* y, const float* z,
                              float* distance_m, float* nx, float* ny, float* nz) {
  const Vector3<Vector> local =
      frame.toLocal(d, {hn::LoadU(d, x), hn::LoadU(d, y), hn::LoadU(d, z)});
  const FieldValue<Vector> value =
      solid.deformationCount == 0 ? primitive.at(d, local) : deformedAt(d, solid, primitive, local);
  const Vector3<Vector> n = frame.toWorld(value.normal);
  hn::StoreU(value.distance_m, d, distance_m);
  hn::StoreU(n.x, d, nx);
  hn::StoreU(n.y, d, ny);
  hn::StoreU(n.z, d, nz);
}

template <class Primitive>
void evaluateWith(const SolidKernel& solid, const KernelFrame& kernelFrame, ConstVectors p,
                  float* distance_m, Vectors normal) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const Primitive primitive(d, solid.primitive);
  const Frame frame(d, kernelFrame);
  std::size_t i = 0;
  for (; i + lanes <= p.count; i += lanes) {
    evaluateLanes(d, solid, primitive, frame, p.x + i, p.y + i, p.z + i, distance_m + i,
                  normal.x + i, normal.y + i, normal.z + i);
  }
  const std::size_t rest = p.count - i;
  if (rest == 0) return;
  HWY_ALIGN float in[3][kMaxLanes] = {}, out[4][kMaxLanes];
  for (std::size_t k = 0; k < rest; ++k) {
    in[0][k] = p.x[i + k], in[1][k] = p.y[i + k], in[2][k] = p.z[i + k];
  }
  evaluateLanes(d, solid, primitive, frame, in[0], in[1], in[2], out[0], out[1], out[2], out[3]);
  for (std::size_t k = 0; k < rest; ++k) {
    distance_m[i + k] = out[0][k];
    normal.x[i + k] = out[1][k], normal.y[i + k] = out[2][k], normal.z[i + k] = out[3][k];
  }
}

void evaluateAll(const SolidKernel& solid, const KernelFrame& frame, ConstVectors points,
                 float* distance_m, Vectors normal) {
  switch (solid.primitive.kind) {
    case PrimitiveKernel::Kind::sphere:
      return evaluateWith<SphereKernel<Tag>>(solid, frame, points, distance_m, normal);
    case PrimitiveKernel::Kind::capsule:
      return evaluateWith<CapsuleKernel<Tag>>(solid, frame, points, distance_m, normal);
    case PrimitiveKernel::Kind::ellipsoid:
      return evaluateWith<EllipsoidKernel<Tag>>(solid, frame, points, distance_m, normal);
    case PrimitiveKernel::Kind::superellipsoid:
      return evaluateWith<SuperellipsoidKernel<Tag>>(solid, frame, points, distance_m, normal);
  }
}

}  // namespace fascia::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fascia {

HWY_EXPORT(evaluateAll);

void evaluateKernel(const SolidKernel& solid, const KernelFrame& frame, ConstVectors points,
                    float* distance_m, Vectors normal) {
  HWY_DYNAMIC_DISPATCH(evaluateAll)(solid, frame, points, distance_m, normal);
}

}  // namespace fascia
#endif
