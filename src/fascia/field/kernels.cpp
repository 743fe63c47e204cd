#include <fascia/field/kernels.h>

#include <cstring>

// SSE4, AVX2 and AVX-512 besides the baseline: more targets cost compile time, and gain nothing.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fascia/field/kernels.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, which includes this file once per target:
#include <hwy/highway.h>

#include <fascia/base/assert.h>
#include <fascia/field/kernel_deformations-inl.h>

HWY_BEFORE_NAMESPACE();
namespace fascia::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kMaxLanes = 16;
using Tag = hn::CappedTag<float, kMaxLanes>;
using Vector = hn::Vec<Tag>;

HWY_INLINE Vector3<Vector> toLocal(Tag d, const KernelFrame& f, const Vector3<Vector>& world) {
  const Vector x = clampTo(d, hn::Sub(world.x, hn::Set(d, f.translation_m[0])), 1e9f);
  const Vector y = clampTo(d, hn::Sub(world.y, hn::Set(d, f.translation_m[1])), 1e9f);
  const Vector z = clampTo(d, hn::Sub(world.z, hn::Set(d, f.translation_m[2])), 1e9f);
  const auto& [rx, ry, rz] = f.rotation;
  return {dot(constants(d, {rx[0], ry[0], rz[0]}), {x, y, z}),
          dot(constants(d, {rx[1], ry[1], rz[1]}), {x, y, z}),
          dot(constants(d, {rx[2], ry[2], rz[2]}), {x, y, z})};
}

HWY_INLINE Vector3<Vector> toWorld(Tag d, const KernelFrame& f, const Vector3<Vector>& n) {
  return {dot(constants(d, f.rotation[0]), n), dot(constants(d, f.rotation[1]), n),
          dot(constants(d, f.rotation[2]), n)};
}

// Undo the deformations last to first, ask the primitive, then carry its gradient outward by the
// inverse transposed Jacobians. Its length says how much the deformation compresses distances.
template <class Primitive>
HWY_INLINE FieldValue<Vector> deformedAt(Tag d, const SolidKernel& solid, Vector3<Vector> p) {
  // In memory, for a vector type without a fixed size cannot be an array's element.
  HWY_ALIGN float kept[kMaxDeformations][4][kMaxLanes];
  for (std::size_t i = solid.deformationCount; i-- > 0;) {
    const Undone<Vector> u = undo(d, solid.deformations[i], p);
    hn::Store(u.a, d, kept[i][0]);
    hn::Store(u.b, d, kept[i][1]);
    hn::Store(u.c, d, kept[i][2]);
    hn::Store(u.d, d, kept[i][3]);
  }
  FieldValue<Vector> value = Primitive(solid.primitive).at(d, p);
  for (std::size_t i = 0; i < solid.deformationCount; ++i) {
    const Undone<Vector> u = {hn::Load(d, kept[i][0]), hn::Load(d, kept[i][1]),
                              hn::Load(d, kept[i][2]), hn::Load(d, kept[i][3])};
    redo(solid.deformations[i], u, value.normal);
  }
  const Vector inverse = inverseSqrt(d, dot(value.normal, value.normal));
  return {hn::Mul(value.distance_m, inverse), scaled(value.normal, inverse)};
}

// Whole vectors only. Deformed solids apart: their constants would otherwise be made ready in every
// call.
template <class Primitive, bool kDeformed>
HWY_NOINLINE void evaluateWhole(const SolidKernel& solid, const KernelFrame& frame, ConstVectors p,
                                float* distance_m, Vectors normal) {
  const Tag d;
  for (std::size_t i = 0; i < p.count; i += hn::Lanes(d)) {
    const Vector3<Vector> world = {hn::LoadU(d, p.x + i), hn::LoadU(d, p.y + i),
                                   hn::LoadU(d, p.z + i)};
    const Vector3<Vector> local = toLocal(d, frame, world);
    FieldValue<Vector> value;
    if constexpr (kDeformed) {
      value = deformedAt<Primitive>(d, solid, local);
    } else {
      value = Primitive(solid.primitive).at(d, local);
    }
    const Vector3<Vector> n = toWorld(d, frame, value.normal);
    hn::StoreU(value.distance_m, d, distance_m + i);
    hn::StoreU(n.x, d, normal.x + i);
    hn::StoreU(n.y, d, normal.y + i);
    hn::StoreU(n.z, d, normal.z + i);
  }
}

// The points that do not fill a vector, by way of one that is full.
template <class Primitive, bool kDeformed>
HWY_NOINLINE void evaluateRest(const SolidKernel& solid, const KernelFrame& frame, ConstVectors p,
                               float* distance_m, Vectors normal) {
  HWY_ALIGN float in[3][kMaxLanes] = {}, out[4][kMaxLanes];
  const std::size_t bytes = p.count * sizeof(float);
  std::memcpy(in[0], p.x, bytes);
  std::memcpy(in[1], p.y, bytes);
  std::memcpy(in[2], p.z, bytes);
  const std::size_t lanes = hn::Lanes(Tag());
  evaluateWhole<Primitive, kDeformed>(solid, frame, {in[0], in[1], in[2], lanes}, out[0],
                                      {out[1], out[2], out[3], lanes});
  std::memcpy(distance_m, out[0], bytes);
  std::memcpy(normal.x, out[1], bytes);
  std::memcpy(normal.y, out[2], bytes);
  std::memcpy(normal.z, out[3], bytes);
}

template <class Primitive, bool kDeformed>
void evaluateWith(const SolidKernel& solid, const KernelFrame& frame, ConstVectors p,
                  float* distance_m, Vectors normal) {
  const std::size_t rest = p.count % hn::Lanes(Tag()), whole = p.count - rest;
  evaluateWhole<Primitive, kDeformed>(solid, frame, {p.x, p.y, p.z, whole}, distance_m, normal);
  if (rest == 0) return;
  evaluateRest<Primitive, kDeformed>(solid, frame, {p.x + whole, p.y + whole, p.z + whole, rest},
                                     distance_m + whole,
                                     {normal.x + whole, normal.y + whole, normal.z + whole, rest});
}

template <class Primitive>
void evaluateAs(const SolidKernel& solid, const KernelFrame& frame, ConstVectors points,
                float* distance_m, Vectors normal) {
  if (solid.deformationCount == 0) {
    evaluateWith<Primitive, false>(solid, frame, points, distance_m, normal);
  } else {
    evaluateWith<Primitive, true>(solid, frame, points, distance_m, normal);
  }
}

void evaluateAll(const SolidKernel& solid, const KernelFrame& frame, ConstVectors points,
                 float* distance_m, Vectors normal) {
  switch (solid.primitive.kind) {
    case PrimitiveKernel::Kind::sphere:
      return evaluateAs<SphereKernel<Tag>>(solid, frame, points, distance_m, normal);
    case PrimitiveKernel::Kind::capsule:
      return evaluateAs<CapsuleKernel<Tag>>(solid, frame, points, distance_m, normal);
    case PrimitiveKernel::Kind::ellipsoid:
      return evaluateAs<EllipsoidKernel<Tag>>(solid, frame, points, distance_m, normal);
    case PrimitiveKernel::Kind::superellipsoid:
      return evaluateAs<SuperellipsoidKernel<Tag>>(solid, frame, points, distance_m, normal);
  }
}

}  // namespace fascia::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fascia {

HWY_EXPORT(evaluateAll);

void evaluateKernel(const SolidKernel& solid, const KernelFrame& frame, ConstVectors points,
                    float* distance_m, Vectors normal) {
  FASCIA_ASSERT(normal.count >= points.count, "a normal for each point");
  FASCIA_ASSERT(solid.deformationCount <= kMaxDeformations,
                "no more deformations than there is room for");
  HWY_DYNAMIC_DISPATCH(evaluateAll)(solid, frame, points, distance_m, normal);
}

}  // namespace fascia
#endif
