#include <fascia/skin/self_contact/self_contact_kernels.h>

#include <algorithm>
#include <bit>
#include <cmath>

// SSSE3 and AVX3_DL add code, not speed, here.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fascia/skin/self_contact/self_contact_kernels.cpp"
#include <hwy/foreach_target.h>

#include <fascia/skin/point/simd_vector-inl.h>

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {

// Cosine of the normals of a point and of the surface above which they do not face each other:
// beside a crease or on an edge of a limb, not opposite.
constexpr float kFacing = 0.2f;
// The deepest points must face the surface that they came through this clearly: what came out at
// the other side of a limb must not be pulled through its flanks.
constexpr float kFacingDeep = -0.5f;
// A point that is farther beside a triangle than this many times its height over it or depth below
// it has nothing to do with it, …
constexpr float kSteepest = 1.2f;
// … unless it is nearer than this share of the gap, where directions mean little.
constexpr float kAnySlope = 0.25f;
// Where a triangle's own normal and the smoothed one differ by more than this cosine the surface is
// crumpled: its sides are not told apart there.
constexpr float kCrumpled = 0.5f;
// Corners' unit normals that cancel each other say nothing about the surface between them.
constexpr float kLeastNormal = 0.5f;

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

HWY_INLINE void set(PointLanes::Lanes3& a, std::size_t l, V3 v) {
  MutablePointers{a.x.data(), a.y.data(), a.z.data()}.set(static_cast<std::ptrdiff_t>(l), v);
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

MotionBounds loadImpl(const SelfContactModel& m, std::size_t patch, const VectorArray& position,
                      const VectorArray& velocity, const SurfaceFrame& frame, PointLanes& lanes) {
  const D d;
  const DI di;
  Extent places, speeds;
  for (std::size_t l = 0; l < SelfContactModel::Patch::kCapacity; l += hn::Lanes(d)) {
    const VI k = hn::LoadU(di, m.patches[patch].points.data() + l);
    const V3 r = gather(position, k), v = gather(velocity, k);
    set(lanes.place, l, r), set(lanes.velocity, l, v);
    set(lanes.normal, l, gather(frame.normal, k));
    hn::StoreU(hn::Set(d, 1e15f), d, lanes.nearest_m.data() + l);
    places.add(r, r), speeds.add(v, v);
  }
  MotionBounds out;
  places.write(out.low, out.high);
  speeds.write(out.slowest, out.fastest);
  out.normals = coneOf(SelfContactModel::Patch::kCapacity,
                       [&](std::size_t l) HWY_ATTR { return at(lanes.normal, l); });
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
  const V3 middle = scaled(hn::Set(d, 0.5f), low + high), half = high - middle;
  const V ahead = hn::Set(d, reach.ahead_m), depthScale = hn::Set(d, reach.depthScale);
  const auto meets = [](V lowest, V highest, V center, V radius) HWY_ATTR {
    return hn::And(hn::Le(hn::Sub(center, radius), highest),
                   hn::Ge(hn::Add(center, radius), lowest));
  };
  for (std::size_t t = g.first; t < g.first + g.count; t += hn::Lanes(d)) {
    const auto at = static_cast<std::ptrdiff_t>(t);
    const V3 c = pointers(f.center).at(at);
    const V3 normal =
        scaled(hn::LoadU(d, f.inverseLength.data() + t), pointers(f.areaNormal).at(at));
    const V behind = hn::Mul(depthScale, hn::LoadU(d, m.depth_m.data() + t));
    const V r = hn::Add(hn::LoadU(d, f.radius.data() + t), hn::Max(ahead, behind));
    // The box above and below the triangle's plane.
    const V height = dot(middle - c, normal);
    const V extent = dot(half, {hn::Abs(normal.x), hn::Abs(normal.y), hn::Abs(normal.z)});
    const Mask inSlab = hn::And(hn::Le(hn::Sub(height, extent), ahead),
                                hn::Ge(hn::Add(height, extent), hn::Neg(behind)));
    const Mask inBox = hn::And(hn::And(meets(low.x, high.x, c.x, r), meets(low.y, high.y, c.y, r)),
                               meets(low.z, high.z, c.z, r));
    const Mask mayFace = hn::Le(dot(normal, axis), hn::Set(d, reach.cosineNever));
    forEachLane(hn::And(inBox, hn::And(inSlab, mayFace)), ~0u,
                [&](std::size_t i) HWY_ATTR { visit(t + i); });
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

  // Which points may touch it, by its plane and the sphere around it.
  HWY_INLINE Mask mayTouch(const PointLanes& lanes, std::size_t l) const {
    const D d;
    const V3 way = at(lanes.place, l) - center;
    const V height = dot(way, normal), square = dot(way, way);
    const V approach = hn::Mul(interval, dot(velocity - at(lanes.velocity, l), normal));
    const V facing = dot(at(lanes.normal, l), normal);
    const V aside = hn::NegMulAdd(height, height, square);
    const V widest = hn::MulAdd(hn::Set(d, kSteepest), hn::Abs(height), slack);
    const V farthest = hn::Add(hn::LoadU(d, lanes.nearest_m.data() + l), radius);
    const V ahead = hn::Add(front, hn::Max(approach, hn::Zero(d)));
    return hn::And(hn::And(hn::And(hn::Le(height, ahead), hn::Ge(height, back)),
                           hn::Lt(facing, hn::Set(d, kMayFace))),
                   hn::And(hn::Le(aside, hn::Mul(widest, widest)),
                           hn::Le(square, hn::Mul(farthest, farthest))));
  }
};

HWY_INLINE V clamp01(V a) {
  const D d;
  return hn::Min(hn::Max(a, hn::Zero(d)), hn::Set(d, 1.f));
}

// The nearest point of a triangle: its projection onto the plane where that lies inside (the
// barycentric weights of Ericson 2005, §3.4), else the nearest point of the three edges. Relative
// to the first corner.
struct NearestPoint {
  V weightB, weightC;

  HWY_INLINE NearestPoint(V3 way, V3 toB, V3 toC) {
    const D d;
    const V zero = hn::Zero(d), one = hn::Set(d, 1.f), tiny = hn::Set(d, 1e-30f);
    const V bb = dot(toB, toB), bc = dot(toB, toC), cc = dot(toC, toC);
    const V b = dot(way, toB), c = dot(way, toC);
    const V area = hn::Max(hn::MulSub(bb, cc, hn::Mul(bc, bc)), tiny);
    weightB = hn::Div(hn::MulSub(cc, b, hn::Mul(bc, c)), area);
    weightC = hn::Div(hn::MulSub(bb, c, hn::Mul(bc, b)), area);
    const Mask inside = hn::And(hn::And(hn::Ge(weightB, zero), hn::Ge(weightC, zero)),
                                hn::Le(hn::Add(weightB, weightC), one));
    if (hn::AllTrue(d, inside)) return;
    const V onB = clamp01(hn::Div(b, hn::Max(bb, tiny)));
    const V onC = clamp01(hn::Div(c, hn::Max(cc, tiny)));
    const V opposite = hn::Max(hn::Sub(hn::Add(bb, cc), hn::Add(bc, bc)), tiny);
    const V fromB = clamp01(hn::Div(hn::Sub(hn::Add(c, bb), hn::Add(b, bc)), opposite));
    V edgeB = onB, edgeC = zero;
    V least = squareTo(way, toB, toC, onB, zero);
    const auto take = [&](V wB, V wC) HWY_ATTR {
      const V square = squareTo(way, toB, toC, wB, wC);
      const Mask nearer = hn::Lt(square, least);
      edgeB = hn::IfThenElse(nearer, wB, edgeB);
      edgeC = hn::IfThenElse(nearer, wC, edgeC);
      least = hn::Min(square, least);
    };
    take(zero, onC);
    take(hn::Sub(one, fromB), fromB);
    weightB = hn::IfThenElse(inside, weightB, edgeB);
    weightC = hn::IfThenElse(inside, weightC, edgeC);
  }
  static HWY_INLINE V squareTo(V3 way, V3 toB, V3 toC, V wB, V wC) {
    const V3 rest = way - mulAdd(wB, toB, scaled(wC, toC));
    return dot(rest, rest);
  }
};

// A triangle's corners and their normals, for a closer look.
struct Corners {
  V3 a, toB, toC, own, normal, normalToB, normalToC;

  HWY_INLINE Corners(const SelfContactModel& m, const VectorArray& position, const SurfaceFrame& f,
                     std::size_t t) {
    const auto [kA, kB, kC] = m.triangle(t);
    const auto get = [](const VectorArray& v, std::size_t k)
                         HWY_ATTR { return all(v.x[k], v.y[k], v.z[k]); };
    a = get(position, kA), toB = get(position, kB) - a, toC = get(position, kC) - a;
    own = scaled(hn::Set(D(), f.inverseLength[t]), get(f.areaNormal, t));
    normal = get(f.normal, kA);
    normalToB = get(f.normal, kB) - normal, normalToC = get(f.normal, kC) - normal;
  }
};

// How a vector of points touches one triangle.
struct TouchLanes {
  V weightB, weightC, distance, nearest, facing;
  V3 normal;
  Mask touching;

  HWY_INLINE TouchLanes(const Corners& t, V3 place, V3 pointNormal, float gap, float deepest) {
    const D d;
    const V3 way = place - t.a;
    const NearestPoint point(way, t.toB, t.toC);
    weightB = point.weightB, weightC = point.weightC;
    const V3 rest = way - mulAdd(weightB, t.toB, scaled(weightC, t.toC));
    const V3 sum = mulAdd(weightB, t.normalToB, mulAdd(weightC, t.normalToC, t.normal));
    const V square = dot(sum, sum), zero = hn::Zero(d), one = hn::Set(d, 1.f);
    const Mask hasNormal = hn::Gt(square, hn::Set(d, kLeastNormal * kLeastNormal));
    normal = scaled(inverseRoot(hn::IfThenElse(hasNormal, square, one)), sum);
    distance = dot(rest, normal);
    const V restSquare = dot(rest, rest);
    nearest = hn::Sqrt(restSquare);
    const V steepest = hn::Mul(hn::Set(d, kSteepest), distance);
    const Mask above =
        hn::Or(hn::Le(hn::NegMulAdd(distance, distance, restSquare), hn::Mul(steepest, steepest)),
               hn::Le(nearest, hn::Set(d, kAnySlope * gap)));
    const V depth =
        hn::IfThenElse(hn::Lt(distance, zero), hn::Mul(nearest, hn::Set(d, 1 / deepest)), zero);
    const V limit = hn::MulAdd(depth, hn::Set(d, kFacingDeep - kFacing), hn::Set(d, kFacing));
    facing = hn::Sub(dot(pointNormal, normal), limit);
    const Mask smooth = hn::Ge(dot(normal, t.own), hn::Set(d, kCrumpled));
    touching = hn::And(hn::And(hn::And(hasNormal, smooth), above),
                       hn::And(hn::Le(depth, one), hn::Lt(facing, zero)));
  }

  // Calls visit(lane, touch) for the lanes in `allowed`.
  template <class Visit>
  HWY_INLINE void forEach(std::uint32_t allowed, const Visit& visit) const {
    const D d;
    if (hn::AllFalse(d, touching)) return;
    alignas(64) float stored[8][SelfContactModel::kLanes];
    const V values[8] = {weightB, weightC, normal.x, normal.y, normal.z, distance, nearest, facing};
    for (std::size_t i = 0; i < 8; ++i) hn::Store(values[i], d, stored[i]);
    forEachLane(touching, allowed, [&](std::size_t i) {
      Touch touch;
      touch.weightB = stored[0][i], touch.weightC = stored[1][i];
      for (std::size_t c = 0; c < 3; ++c) touch.normal[c] = stored[2 + c][i];
      touch.distance_m = stored[5][i], touch.nearest_m = stored[6][i];
      touch.facing = stored[7][i];
      visit(i, touch);
    });
  }
};

bool nearOnSurface(const SelfContactModel& m, std::size_t point, std::size_t triangle) {
  const std::span<const std::uint32_t> near = m.nearPoints[point];
  for (const std::uint32_t corner : m.triangle(triangle))
    if (std::find(near.begin(), near.end(), corner) != near.end()) return true;
  return false;
}

void findTouchesImpl(const SelfContactModel& m, std::size_t patch, std::size_t group,
                     const VectorArray& position, const SurfaceFrame& f, const PairReach& reach,
                     const PointLanes& lanes, const TouchVisit& visit) {
  const D d;
  const auto& points = m.patches[patch].points;
  forEachTriangle(m, group, f, reach, [&](std::size_t t) HWY_ATTR {
    const TriangleTest test(m, f, t, reach);
    for (std::size_t l = 0; l < points.size(); l += hn::Lanes(d)) {
      if (hn::AllFalse(d, test.mayTouch(lanes, l))) continue;
      const Corners corners(m, position, f, t);
      const TouchLanes touches(corners, at(lanes.place, l), at(lanes.normal, l), m.gap_m,
                               reach.depthScale * m.depth_m[t]);
      touches.forEach(reach.lanes >> l, [&](std::size_t i, Touch& touch) {
        touch.lane = static_cast<std::uint32_t>(l + i);
        touch.triangle = static_cast<std::uint32_t>(t);
        if (touch.nearest_m > lanes.nearest_m[l + i]) return;
        if (!nearOnSurface(m, static_cast<std::size_t>(points[l + i]), t)) visit(touch);
      });
    }
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fascia {

HWY_EXPORT(updateGroupImpl);
HWY_EXPORT(updateNormalsImpl);
HWY_EXPORT(loadImpl);
HWY_EXPORT(findTouchesImpl);

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

MotionBounds loadLanes(const SelfContactModel& model, std::size_t patch,
                       const VectorArray& position, const VectorArray& velocity,
                       const SurfaceFrame& frame, PointLanes& lanes) {
  return HWY_DYNAMIC_DISPATCH(loadImpl)(model, patch, position, velocity, frame, lanes);
}

void findTouches(const SelfContactModel& model, std::size_t patch, std::size_t group,
                 const VectorArray& position, const SurfaceFrame& frame, const PairReach& reach,
                 const PointLanes& lanes, const TouchVisit& visit) {
  HWY_DYNAMIC_DISPATCH(findTouchesImpl)
  (model, patch, group, position, frame, reach, lanes, visit);
}

}  // namespace fascia
#endif
