#include <fascia/skin/self_contact_kernels.h>

#include <algorithm>
#include <bit>
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
HWY_INLINE V3 crossProduct(V3 a, V3 b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
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
HWY_INLINE V3 at(const PointLanes::Lanes3& a, std::size_t l) {
  return Pointers{a.x.data(), a.y.data(), a.z.data()}.at(static_cast<std::ptrdiff_t>(l));
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
  const V third = hn::Set(d, 1.f / 3);
  Extent places, speeds;
  for (std::size_t t = g.first; t < g.first + g.count; t += hn::Lanes(d)) {
    const VI corners[] = {hn::LoadU(di, m.corners[0].data() + t),
                          hn::LoadU(di, m.corners[1].data() + t),
                          hn::LoadU(di, m.corners[2].data() + t)};
    const V3 a = gather(position, corners[0]), b = gather(position, corners[1]),
             c = gather(position, corners[2]);
    const V3 normal = crossProduct(b - a, c - a), center = scaled(third, a + b + c);
    const V3 v = scaled(third, gather(velocity, corners[0]) + gather(velocity, corners[1]) +
                                   gather(velocity, corners[2]));
    const V square = hn::Max(dot(a - center, a - center),
                             hn::Max(dot(b - center, b - center), dot(c - center, c - center)));
    const auto at = static_cast<std::ptrdiff_t>(t);
    pointers(frame.areaNormal).set(at, normal);
    hn::StoreU(inverseLength(normal), d, frame.inverseLength.data() + t);
    pointers(frame.center).set(at, center);
    hn::StoreU(hn::Sqrt(square), d, frame.radius.data() + t);
    pointers(frame.velocity).set(at, v);
    places.add(least(a, least(b, c)), most(a, most(b, c)));
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

MotionBounds boundsOfLanesImpl(const PointLanes& lanes) {
  const D d;
  Extent places, speeds;
  for (std::size_t l = 0; l < lanes.count; l += hn::Lanes(d)) {
    const V3 r = at(lanes.place, l), v = at(lanes.velocity, l);
    places.add(r, r), speeds.add(v, v);
  }
  MotionBounds out;
  places.write(out.low, out.high);
  speeds.write(out.slowest, out.fastest);
  out.normals = coneOf(lanes.count, [&](std::size_t l) HWY_ATTR { return at(lanes.normal, l); });
  return out;
}

using Mask = hn::Mask<D>;

// Calls visit(i) for the lanes of a mask that are set in `allowed` too.
template <class Visit>
HWY_INLINE void forEachLane(Mask mask, std::uint32_t allowed, const Visit& visit) {
  const D d;
  if (hn::AllFalse(d, mask)) return;
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  for (std::uint32_t bits = (bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8) & allowed;
       bits != 0; bits &= bits - 1)
    visit(static_cast<std::size_t>(std::countr_zero(bits)));
}

// Calls visit(t) for the triangles of a group that the block's points can reach and face.
template <class Visit>
HWY_INLINE void forEachTriangle(const SelfContactModel& m, std::size_t group, const SurfaceFrame& f,
                                const PairReach& reach, const Visit& visit) {
  const D d;
  const SelfContactModel::Group g = m.groups[group];
  const V3 low = all(reach.low), high = all(reach.high), axis = all(reach.axis);
  const auto meets = [](V lowest, V highest, V center, V radius) HWY_ATTR {
    return hn::And(hn::Le(hn::Sub(center, radius), highest),
                   hn::Ge(hn::Add(center, radius), lowest));
  };
  for (std::size_t t = g.first; t < g.first + g.count; t += hn::Lanes(d)) {
    const auto at = static_cast<std::ptrdiff_t>(t);
    const V3 c = pointers(f.center).at(at);
    const V behind = hn::Mul(hn::Set(d, reach.depthScale), hn::LoadU(d, m.depth_m.data() + t));
    const V r =
        hn::Add(hn::LoadU(d, f.radius.data() + t), hn::Max(hn::Set(d, reach.ahead_m), behind));
    const V toAxis =
        hn::Mul(dot(pointers(f.areaNormal).at(at), axis), hn::LoadU(d, f.inverseLength.data() + t));
    const Mask mask = hn::And(
        hn::And(meets(low.x, high.x, c.x, r), meets(low.y, high.y, c.y, r)),
        hn::And(meets(low.z, high.z, c.z, r), hn::Le(toAxis, hn::Set(d, reach.cosineNever))));
    forEachLane(mask, ~0u, [&](std::size_t i) HWY_ATTR { visit(t + i); });
  }
}

// One triangle and how points lie to it.
struct TriangleTest {
  V3 center, velocity, normal;
  V radius, front, back, interval, slack;

  HWY_INLINE TriangleTest(const SelfContactModel& m, const SurfaceFrame& f, std::size_t t,
                          const PairReach& reach) {
    const D d;
    const float inverse = f.inverseLength[t];
    center = all(f.center.x[t], f.center.y[t], f.center.z[t]);
    velocity = all(f.velocity.x[t], f.velocity.y[t], f.velocity.z[t]);
    normal =
        all(f.areaNormal.x[t] * inverse, f.areaNormal.y[t] * inverse, f.areaNormal.z[t] * inverse);
    radius = hn::Set(d, f.radius[t]);
    front = hn::Set(d, reach.ahead_m);
    back = hn::Set(d, -reach.depthScale * m.depth_m[t]);
    interval = hn::Set(d, reach.interval_s);
    slack = hn::Set(d, f.radius[t] + m.gap_m);
  }

  struct Points {
    Mask near;    // that may touch the triangle
    Mask surely;  // that do
    V square;     // of the distance to its centre
  };
  HWY_INLINE Points test(const PointLanes& lanes, std::size_t l) const {
    const D d;
    const V3 way = at(lanes.place, l) - center;
    const V height = dot(way, normal), square = dot(way, way);
    const V approach = hn::Mul(interval, dot(velocity - at(lanes.velocity, l), normal));
    const V facing = dot(at(lanes.normal, l), normal);
    const V aside = hn::NegMulAdd(height, height, square);
    const V widest = hn::MulAdd(hn::Set(d, kSteepest), hn::Abs(height), slack);
    const V farthest = hn::Add(hn::LoadU(d, lanes.nearest_m.data() + l), radius);
    const V ahead = hn::Add(front, hn::Max(approach, hn::Zero(d)));
    const Mask inRange = hn::And(hn::And(hn::Le(height, ahead), hn::Ge(height, back)),
                                 hn::And(hn::Le(aside, hn::Mul(widest, widest)),
                                         hn::Le(square, hn::Mul(farthest, farthest))));
    const V inner = hn::Mul(hn::Set(d, 0.25f), hn::Mul(radius, radius));
    const Mask near = hn::And(inRange, hn::Lt(facing, hn::Set(d, kMayFace)));
    const Mask opposite = hn::And(hn::Lt(facing, hn::Set(d, -kMayFace)), hn::Le(aside, inner));
    return {near, hn::And(near, opposite), square};
  }
};

std::size_t candidatesImpl(const SelfContactModel& m, std::size_t group, const SurfaceFrame& f,
                           const PairReach& reach, bool lower, PointLanes& lanes,
                           std::array<Candidate, kMostCandidates>& out) {
  const D d;
  std::size_t count = 0;
  forEachTriangle(m, group, f, reach, [&](std::size_t t) HWY_ATTR {
    const TriangleTest triangle(m, f, t, reach);
    for (std::size_t l = 0; l < lanes.count; l += hn::Lanes(d)) {
      const TriangleTest::Points points = triangle.test(lanes, l);
      if (hn::AllFalse(d, points.near)) continue;
      PointLanes::Lanes<float> distance;
      hn::StoreU(hn::Sqrt(points.square), d, distance.data());
      forEachLane(points.near, reach.lanes >> l, [&](std::size_t i) {
        out[count++] = {static_cast<std::uint32_t>(l + i), static_cast<std::uint32_t>(t),
                        distance[i] - f.radius[t]};
      });
      if (!lower) continue;
      forEachLane(points.surely, reach.lanes >> l, [&](std::size_t i) {
        lanes.nearest_m[l + i] = std::min(lanes.nearest_m[l + i], distance[i]);
      });
    }
  });
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
      center(model.triangleCount()),
      radius(model.triangleCount()),
      velocity(model.triangleCount()),
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
  lanes.count = block.count;
  load(block, position, lanes.place);
  load(block, velocity, lanes.velocity);
  load(block, frame.normal, lanes.normal);
  lanes.nearest_m.fill(1e15f);
  return HWY_DYNAMIC_DISPATCH(boundsOfLanesImpl)(lanes);
}

std::size_t findCandidates(const SelfContactModel& model, std::size_t group,
                           const SurfaceFrame& frame, const PairReach& reach, bool lower,
                           PointLanes& lanes, std::array<Candidate, kMostCandidates>& out) {
  return HWY_DYNAMIC_DISPATCH(candidatesImpl)(model, group, frame, reach, lower, lanes, out);
}

}  // namespace fascia
#endif
