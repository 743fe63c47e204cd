#include <fascia/skin/self_contact_kernels.h>

#include <algorithm>
#include <cmath>

// SSSE3 and AVX3_DL add code, not speed, here.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fascia/skin/self_contact_kernels.cpp"
#include <hwy/foreach_target.h>

#include <fascia/skin/simd_vector-inl.h>

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {

using DI = hn::RebindToSigned<D>;
using VI = hn::Vec<DI>;

HWY_INLINE V3 gather(const VectorArray& a, VI k) {
  const D d;
  return {hn::GatherIndex(d, a.x.data(), k), hn::GatherIndex(d, a.y.data(), k),
          hn::GatherIndex(d, a.z.data(), k)};
}
HWY_INLINE V3 least(V3 a, V3 b) {
  return {hn::Min(a.x, b.x), hn::Min(a.y, b.y), hn::Min(a.z, b.z)};
}
HWY_INLINE V3 most(V3 a, V3 b) {
  return {hn::Max(a.x, b.x), hn::Max(a.y, b.y), hn::Max(a.z, b.z)};
}
HWY_INLINE V3 all(float x, float y, float z) {
  const D d;
  return {hn::Set(d, x), hn::Set(d, y), hn::Set(d, z)};
}
HWY_INLINE V3 all(const float* v) {
  return all(v[0], v[1], v[2]);
}
// 1/|a|, and 0 for what has no direction.
HWY_INLINE V inverseLength(V3 a) {
  const D d;
  const V square = dot(a, a);
  const auto any = hn::Gt(square, hn::Set(d, 1e-30f));
  return hn::IfThenElseZero(any, inverseRoot(hn::IfThenElse(any, square, hn::Set(d, 1.f))));
}
inline Pointers pointers(const PointLanes::Lanes3& a) {
  return {a.x.data(), a.y.data(), a.z.data()};
}

// Bounds of vectors that are added one after the other.
struct Extent {
  V3 low, high;

  HWY_INLINE Extent() : low(all(1e30f, 1e30f, 1e30f)), high(all(-1e30f, -1e30f, -1e30f)) {}
  HWY_INLINE void add(V3 from, V3 to) { low = least(low, from), high = most(high, to); }
  HWY_INLINE void write(float* lowOut, float* highOut) const {
    const D d;
    const V lows[] = {low.x, low.y, low.z}, highs[] = {high.x, high.y, high.z};
    for (int a = 0; a < 3; ++a) {
      lowOut[a] = hn::GetLane(hn::MinOfLanes(d, lows[a]));
      highOut[a] = hn::GetLane(hn::MaxOfLanes(d, highs[a]));
    }
  }
};

// The cone around the mean of `count` unit vectors; directions(i) gives a vector of them.
template <class Directions>
HWY_INLINE NormalCone coneOf(std::size_t count, const Directions& directions) {
  const D d;
  V3 sum = all(0, 0, 0);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) sum = sum + directions(i);
  const float x = hn::GetLane(hn::SumOfLanes(d, sum.x)), y = hn::GetLane(hn::SumOfLanes(d, sum.y)),
              z = hn::GetLane(hn::SumOfLanes(d, sum.z));
  const float length = std::sqrt(x * x + y * y + z * z);
  if (!(length > 1e-6f)) return {{0, 0, 1}, -1};
  const V3 axis = all(x / length, y / length, z / length);
  V cosine = hn::Set(d, 1.f);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d))
    cosine = hn::Min(cosine, dot(axis, directions(i)));
  return {{x / length, y / length, z / length}, hn::GetLane(hn::MinOfLanes(d, cosine))};
}

MotionBounds updateGroupImpl(const SelfContactModel& m, std::size_t group,
                             const VectorArray& position, const VectorArray& velocity,
                             SurfaceFrame& frame) {
  const D d;
  const DI di;
  const SelfContactModel::Group g = m.groups[group];
  Extent places, speeds;
  for (std::size_t t = g.first; t < g.first + g.count; t += hn::Lanes(d)) {
    const V3 a = gather(position, hn::LoadU(di, m.corners[0].data() + t));
    const V3 b = gather(position, hn::LoadU(di, m.corners[1].data() + t));
    const V3 c = gather(position, hn::LoadU(di, m.corners[2].data() + t));
    const V3 normal = cross(b - a, c - a);
    const V3 low = least(a, least(b, c)), high = most(a, most(b, c));
    pointers(frame.areaNormal).set(static_cast<std::ptrdiff_t>(t), normal);
    hn::StoreU(inverseLength(normal), d, frame.inverseLength.data() + t);
    pointers(frame.corner).set(static_cast<std::ptrdiff_t>(t), a);
    pointers(frame.low).set(static_cast<std::ptrdiff_t>(t), low);
    pointers(frame.high).set(static_cast<std::ptrdiff_t>(t), high);
    places.add(low, high);
  }
  const std::span<const std::int32_t> points = m.groupPoints[group];
  for (std::size_t i = 0; i < points.size(); i += hn::Lanes(d)) {
    const V3 v = gather(velocity, hn::LoadU(di, points.data() + i));
    speeds.add(v, v);
  }
  MotionBounds out;
  places.write(out.low, out.high);
  speeds.write(out.slowest, out.fastest);
  out.normals = coneOf(g.count, [&](std::size_t i) HWY_ATTR {
    const V inverse = hn::LoadU(d, frame.inverseLength.data() + g.first + i);
    const auto t = static_cast<std::ptrdiff_t>(g.first + i);
    return scaled(inverse, pointers(frame.areaNormal).at(t));
  });
  return out;
}

void updateNormalsImpl(const SelfContactModel& m, std::size_t chunk, SurfaceFrame& frame) {
  const D d;
  const DI di;
  const std::span<const std::int32_t> fan = m.fans[chunk];
  for (std::size_t l = 0; l < SelfContactModel::kLanes; l += hn::Lanes(d)) {
    V3 sum = all(0, 0, 0);
    for (std::size_t slot = 0; slot < fan.size(); slot += SelfContactModel::kLanes)
      sum = sum + gather(frame.areaNormal, hn::LoadU(di, fan.data() + slot + l));
    pointers(frame.normal)
        .set(static_cast<std::ptrdiff_t>(chunk * SelfContactModel::kLanes + l),
             scaled(inverseLength(sum), sum));
  }
}

MotionBounds boundsOfLanesImpl(const PointLanes& lanes, const PointLanes::Lanes3& velocity) {
  const D d;
  Extent places, speeds;
  const auto at = [](const PointLanes::Lanes3& a, std::size_t l)
                      HWY_ATTR { return pointers(a).at(static_cast<std::ptrdiff_t>(l)); };
  for (std::size_t l = 0; l < lanes.count; l += hn::Lanes(d)) {
    places.add(at(lanes.place, l), at(lanes.place, l));
    speeds.add(at(velocity, l), at(velocity, l));
  }
  MotionBounds out;
  places.write(out.low, out.high);
  speeds.write(out.slowest, out.fastest);
  out.normals = coneOf(lanes.count, [&](std::size_t l) HWY_ATTR { return at(lanes.normal, l); });
  return out;
}

// Calls visit(i) for the lanes of a mask below `count`.
template <class Mask, class Visit>
HWY_INLINE void forEachLane(Mask mask, std::size_t count, const Visit& visit) {
  const D d;
  if (hn::AllFalse(d, mask)) return;
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(d, mask, bits);
  for (std::size_t i = 0; i < std::min(count, hn::Lanes(d)); ++i)
    if (bits[i / 8] >> (i % 8) & 1) visit(i);
}

// The points near one triangle, appended to `out`.
HWY_INLINE std::size_t pointsNear(const SelfContactModel& m, const SurfaceFrame& f, std::size_t t,
                                  const PointLanes& lanes, const PairReach& reach,
                                  std::array<Candidate, kMostCandidates>& out, std::size_t count) {
  const D d;
  const V3 low =
      all(f.low.x[t] - reach.above[0], f.low.y[t] - reach.above[1], f.low.z[t] - reach.above[2]);
  const V3 high =
      all(f.high.x[t] + reach.below[0], f.high.y[t] + reach.below[1], f.high.z[t] + reach.below[2]);
  const float inverse = f.inverseLength[t];
  const V3 normal =
      all(f.areaNormal.x[t] * inverse, f.areaNormal.y[t] * inverse, f.areaNormal.z[t] * inverse);
  const V front = hn::Set(d, reach.ahead_m), back = hn::Set(d, -reach.depthScale * m.depth_m[t]);
  const V3 corner = all(f.corner.x[t], f.corner.y[t], f.corner.z[t]);
  for (std::size_t l = 0; l < lanes.count; l += hn::Lanes(d)) {
    const V3 r = pointers(lanes.place).at(static_cast<std::ptrdiff_t>(l));
    const V3 n = pointers(lanes.normal).at(static_cast<std::ptrdiff_t>(l));
    const V height = dot(r - corner, normal);
    const auto inside = hn::And(hn::And(hn::And(hn::Ge(r.x, low.x), hn::Le(r.x, high.x)),
                                        hn::And(hn::Ge(r.y, low.y), hn::Le(r.y, high.y))),
                                hn::And(hn::Ge(r.z, low.z), hn::Le(r.z, high.z)));
    const auto facing = hn::And(hn::Lt(dot(n, normal), hn::Set(d, kMayFace)),
                                hn::And(hn::Le(height, front), hn::Ge(height, back)));
    forEachLane(hn::And(inside, facing), lanes.count - l, [&](std::size_t i) {
      out[count++] = {static_cast<std::uint32_t>(l + i), static_cast<std::uint32_t>(t)};
    });
  }
  return count;
}

std::size_t candidatesImpl(const SelfContactModel& m, std::size_t group, const SurfaceFrame& f,
                           const PointLanes& lanes, const PairReach& reach,
                           std::array<Candidate, kMostCandidates>& out) {
  const D d;
  const SelfContactModel::Group g = m.groups[group];
  const V3 boxLow = all(reach.low), boxHigh = all(reach.high);
  std::size_t count = 0;
  for (std::size_t t = g.first; t < g.first + g.count; t += hn::Lanes(d)) {
    const V3 low = pointers(f.low).at(static_cast<std::ptrdiff_t>(t));
    const V3 high = pointers(f.high).at(static_cast<std::ptrdiff_t>(t));
    const auto meet = hn::And(hn::And(hn::And(hn::Le(low.x, boxHigh.x), hn::Ge(high.x, boxLow.x)),
                                      hn::And(hn::Le(low.y, boxHigh.y), hn::Ge(high.y, boxLow.y))),
                              hn::And(hn::Le(low.z, boxHigh.z), hn::Ge(high.z, boxLow.z)));
    forEachLane(meet, hn::Lanes(d),
                [&](std::size_t i) { count = pointsNear(m, f, t + i, lanes, reach, out, count); });
  }
  return count;
}

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fascia {

HWY_EXPORT(updateGroupImpl);
HWY_EXPORT(updateNormalsImpl);
HWY_EXPORT(boundsOfLanesImpl);
HWY_EXPORT(candidatesImpl);

SurfaceFrame::SurfaceFrame(const SelfContactModel& model)
    : areaNormal(model.triangleCount() + 1),
      inverseLength(model.triangleCount()),
      corner(model.triangleCount()),
      low(model.triangleCount()),
      high(model.triangleCount()),
      normal(model.fans.size() * SelfContactModel::kLanes) {}

MotionBounds updateGroup(const SelfContactModel& model, std::size_t group,
                         const VectorArray& position, const VectorArray& velocity,
                         SurfaceFrame& frame) {
  return HWY_DYNAMIC_DISPATCH(updateGroupImpl)(model, group, position, velocity, frame);
}

void updateNormals(const SelfContactModel& model, std::size_t chunk, SurfaceFrame& frame) {
  HWY_DYNAMIC_DISPATCH(updateNormalsImpl)(model, chunk, frame);
}

namespace {

// Lanes behind the last point repeat the first one.
void load(const PointBlock& block, const VectorArray& from, PointLanes::Lanes3& to) {
  const auto copy = [&](const FloatArray& a, PointLanes::Lanes<float>& lanes) {
    const auto first = a.begin() + static_cast<std::ptrdiff_t>(block.first);
    std::fill(std::copy_n(first, block.count, lanes.begin()), lanes.end(), *first);
  };
  copy(from.x, to.x), copy(from.y, to.y), copy(from.z, to.z);
}

}  // namespace

MotionBounds loadLanes(const PointBlock& block, const VectorArray& position,
                       const VectorArray& velocity, const SurfaceFrame& frame, PointLanes& lanes) {
  PointLanes::Lanes3 speed;
  lanes.count = block.count;
  load(block, position, lanes.place);
  load(block, frame.normal, lanes.normal);
  load(block, velocity, speed);
  return HWY_DYNAMIC_DISPATCH(boundsOfLanesImpl)(lanes, speed);
}

std::size_t findCandidates(const SelfContactModel& model, std::size_t group,
                           const SurfaceFrame& frame, const PointLanes& lanes,
                           const PairReach& reach, std::array<Candidate, kMostCandidates>& out) {
  return HWY_DYNAMIC_DISPATCH(candidatesImpl)(model, group, frame, lanes, reach, out);
}

}  // namespace fascia
#endif
