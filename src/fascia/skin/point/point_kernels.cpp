#include <fascia/skin/point/point_kernels.h>

#include <cmath>
#include <utility>

// SSSE3 and AVX3_DL add code, not speed, here.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fascia/skin/point/point_kernels.cpp"
#include <hwy/foreach_target.h>

#include <fascia/skin/point/absorb-inl.h>

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {

inline MutablePointers pointers(ContactLanes::Lanes3& a) {
  return {a.x.data(), a.y.data(), a.z.data()};
}
inline Pointers pointers(const ContactLanes::Lanes3& a) {
  return {a.x.data(), a.y.data(), a.z.data()};
}

BlockBox loadImpl(const PointBlock& block, const VectorArray& position, const FloatArray& fat,
                  ContactLanes& lanes) {
  const D d;
  const V big = hn::Set(d, 1e30f);
  V3 low{big, big, big}, high = scaled(hn::Set(d, -1.f), low);
  for (std::size_t l = 0; l < block.count; l += hn::Lanes(d)) {
    const std::size_t k = block.first + l;
    const V3 r = pointers(position).at(k);
    const V thickness = hn::LoadU(d, fat.data() + k);
    pointers(lanes.place).set(l, r);
    pointers(lanes.pushNormal).set(l, {hn::Zero(d), hn::Zero(d), hn::Zero(d)});
    hn::StoreU(thickness, d, lanes.fat.data() + l);
    const auto used =
        hn::Lt(hn::Iota(d, static_cast<float>(l)), hn::Set(d, static_cast<float>(block.count)));
    const V3 around{thickness, thickness, thickness};
    const V3 forLow = select(used, r - around, low), forHigh = select(used, r + around, high);
    low = {hn::Min(low.x, forLow.x), hn::Min(low.y, forLow.y), hn::Min(low.z, forLow.z)};
    high = {hn::Max(high.x, forHigh.x), hn::Max(high.y, forHigh.y), hn::Max(high.z, forHigh.z)};
  }
  const auto least = [&](V v) { return hn::GetLane(hn::MinOfLanes(d, v)); };
  const auto most = [&](V v) { return hn::GetLane(hn::MaxOfLanes(d, v)); };
  return {{least(low.x), least(low.y), least(low.z)}, {most(high.x), most(high.y), most(high.z)}};
}

void motionImpl(const PointBlock& block, const VectorArray& position, VectorArray& last,
                BlockMotion& out) {
  const D d;
  const V zero = hn::Zero(d);
  const auto used = [&](std::size_t l) HWY_ATTR {
    return hn::Lt(hn::Iota(d, static_cast<float>(l)), hn::Set(d, static_cast<float>(block.count)));
  };
  const Pointers now = pointers(static_cast<const VectorArray&>(position));
  const MutablePointers before = pointers(last);
  const std::size_t middle = block.first + block.count / 2;
  const auto axes = [&](int a) { return VectorArray::kAxes[a]; };
  for (int a = 0; a < 3; ++a) {
    out.center[a] = (last.*axes(a))[middle];
    out.way[a] = (position.*axes(a))[middle] - out.center[a];
  }
  const V3 center{hn::Set(d, out.center[0]), hn::Set(d, out.center[1]), hn::Set(d, out.center[2])};
  const V3 way{hn::Set(d, out.way[0]), hn::Set(d, out.way[1]), hn::Set(d, out.way[2])};
  V radius = zero, spread = zero;
  for (std::size_t l = 0; l < block.count; l += hn::Lanes(d)) {
    const V3 r = before.at(block.first + l), q = now.at(block.first + l);
    const V3 fromCenter = r - center, fromWay = (q - r) - way;
    radius = hn::Max(radius, hn::IfThenElseZero(used(l), dot(fromCenter, fromCenter)));
    spread = hn::Max(spread, hn::IfThenElseZero(used(l), dot(fromWay, fromWay)));
    before.set(block.first + l, q);
  }
  out.radius_m = std::sqrt(hn::GetLane(hn::MaxOfLanes(d, radius)));
  out.spread_m = std::sqrt(hn::GetLane(hn::MaxOfLanes(d, spread)));
}

float absorbImpl(float solid, bool move, std::uint32_t count, ContactLanes& lanes) {
  const D d;
  V smallest = hn::Set(d, 1e30f);
  for (std::size_t l = 0; l < count; l += hn::Lanes(d)) {
    const auto used =
        hn::Lt(hn::Iota(d, static_cast<float>(l)), hn::Set(d, static_cast<float>(count)));
    const V gap = hn::IfThenElse(
        used, hn::Sub(hn::LoadU(d, lanes.distance.data() + l), hn::LoadU(d, lanes.fat.data() + l)),
        hn::Set(d, 1e30f));
    smallest = hn::Min(smallest, gap);
    const V3 normal = pointers(lanes.normal).at(l);
    if (move) {
      V3 place = pointers(lanes.place).at(l), push = pointers(lanes.pushNormal).at(l);
      V pushed = hn::LoadU(d, lanes.pushed.data() + l);
      const V clearance = hn::LoadU(d, lanes.clearance.data() + l);
      const auto inside = hn::Lt(gap, hn::Zero(d));
      const auto again = hn::And(inside, hn::Gt(pushed, hn::Zero(d)));
      const V outsideGap = hn::Min(clearance, hn::IfThenElse(inside, clearance, gap));
      hn::StoreU(hn::IfThenElse(again, hn::Zero(d), outsideGap), d, lanes.clearance.data() + l);
      pushOut(gap, normal, place, push, pushed);
      pointers(lanes.place).set(l, place);
      pointers(lanes.pushNormal).set(l, push);
      hn::StoreU(pushed, d, lanes.pushed.data() + l);
    }
    V nearest = hn::LoadU(d, lanes.nearest.data() + l);
    V3 nearestNormal = pointers(lanes.nearestNormal).at(l);
    V nearestSolid = hn::LoadU(d, lanes.nearestSolid.data() + l);
    keepNearest(gap, normal, hn::Set(d, solid), nearest, nearestNormal, nearestSolid);
    hn::StoreU(nearest, d, lanes.nearest.data() + l);
    pointers(lanes.nearestNormal).set(l, nearestNormal);
    hn::StoreU(nearestSolid, d, lanes.nearestSolid.data() + l);
  }
  return hn::GetLane(hn::MinOfLanes(d, smallest));
}

std::uint32_t packImpl(float solid, float reach, std::uint32_t count, const ContactLanes& lanes,
                       ContactLanes::Lanes3& place, ContactLanes::Lanes<std::int32_t>& lane) {
  const D d;
  const hn::RebindToSigned<D> di;
  const auto pointersOf = [](const ContactLanes::Lanes3& a) HWY_ATTR {
    return Pointers{a.x.data(), a.y.data(), a.z.data()};
  };
  std::size_t packed = 0;
  for (std::size_t l = 0; l < count; l += hn::Lanes(d)) {
    const auto used =
        hn::Lt(hn::Iota(d, static_cast<float>(l)), hn::Set(d, static_cast<float>(count)));
    const auto own = hn::Eq(hn::LoadU(d, lanes.nearestSolid.data() + l), hn::Set(d, solid));
    const V3 push = pointersOf(lanes.pushNormal).at(l);
    const auto felt = hn::Or(hn::Le(hn::LoadU(d, lanes.nearest.data() + l), hn::Set(d, reach)),
                             hn::Gt(dot(push, push), hn::Zero(d)));
    const auto wanted = hn::And(used, hn::And(own, felt));
    if (hn::AllFalse(d, wanted)) continue;
    const V3 from = pointersOf(lanes.place).at(l);
    hn::CompressStore(from.x, wanted, d, place.x.data() + packed);
    hn::CompressStore(from.y, wanted, d, place.y.data() + packed);
    hn::CompressStore(from.z, wanted, d, place.z.data() + packed);
    packed += hn::CompressStore(hn::Iota(di, static_cast<std::int32_t>(l)),
                                hn::RebindMask(di, wanted), di, lane.data() + packed);
  }
  return static_cast<std::uint32_t>(packed);
}

inline Pointers pointers(const ConstVectors& a) {
  return {a.x, a.y, a.z};
}

float finishImpl(const PointBlock& block, bool any, float reach, float restitution,
                 const PointModel& points, const ContactFindings& found, VectorArray& position,
                 VectorArray& velocity, PointSurroundings& around) {
  const D d;
  const V zero = hn::Zero(d);
  const V3 zero3{zero, zero, zero};
  V fastest = zero;
  for (std::size_t l = 0; l < block.count; l += hn::Lanes(d)) {
    const std::size_t k = block.first + l;
    const auto used =
        hn::Lt(hn::Iota(d, static_cast<float>(l)), hn::Set(d, static_cast<float>(block.count)));
    const MutablePointers r = pointers(position), v = pointers(velocity);
    V3 speed = select(used, v.at(k), zero3);
    if (!any) {
      pointers(around.normal).set(k, zero3);
      pointers(around.fleshVelocity).set(k, zero3);
      hn::StoreU(zero, d, around.offset.data() + k);
    } else {
      const V nearest = hn::LoadU(d, found.nearest + l);
      const auto isFree = hn::Gt(hn::LoadU(d, points.free.data() + k), zero);
      // A point that was moved out of a solid may end a little outside of it, or well outside.
      const V3 place = r.at(k), way = pointers(found.place).at(l) - place;
      const auto candidate = hn::And(used, isFree);
      const auto moved = hn::And(candidate, hn::Gt(dot(way, way), zero));
      const auto touching = hn::Or(moved, hn::And(candidate, hn::Le(nearest, hn::Set(d, reach))));
      const auto onFlesh = hn::Or(moved, hn::And(touching, hn::Le(nearest, zero)));
      const V3 normal = select(touching, pointers(found.normal).at(l), zero3);
      const V3 flesh = select(touching, pointers(found.fleshVelocity).at(l), zero3);
      const V3 now = select(onFlesh, pointers(found.place).at(l), place);
      const V approach = hn::Min(dot(normal, speed - flesh), zero);
      speed = select(
          onFlesh, mulAdd(hn::Mul(hn::Set(d, -1.f - restitution), approach), normal, speed), speed);
      const V offset = hn::Sub(dot(normal, now), nearest);
      r.set(k, now);
      v.set(k, select(used, speed, v.at(k)));
      pointers(around.normal).set(k, normal);
      pointers(around.fleshVelocity).set(k, flesh);
      hn::StoreU(hn::IfThenElseZero(touching, offset), d, around.offset.data() + k);
    }
    const V3 relative = select(used, speed - pointers(around.anchorVelocity).at(k), zero3);
    fastest = hn::Max(fastest, dot(relative, relative));
  }
  return hn::GetLane(hn::MaxOfLanes(d, fastest));
}

float followImpl(const VectorArray& nextAnchor, float rate, const FloatArray* carry,
                 PointSurroundings& around, VectorArray& velocity) {
  const D d;
  const std::size_t n = nextAnchor.size() / hn::Lanes(d) * hn::Lanes(d);
  const Pointers anchor = pointers(std::as_const(around.anchor));
  const MutablePointers anchorVelocity = pointers(around.anchorVelocity);
  const MutablePointers flesh = pointers(around.fleshVelocity), v = pointers(velocity);
  V farthest = hn::Zero(d);
  for (std::size_t k = 0; k < n; k += hn::Lanes(d)) {
    const V3 way = pointers(nextAnchor).at(k) - anchor.at(k);
    farthest = hn::Max(farthest, dot(way, way));
    const V3 next = scaled(hn::Set(d, rate), way);
    const V3 change = next - anchorVelocity.at(k);
    if (carry) v.set(k, mulAdd(hn::LoadU(d, carry->data() + k), change, v.at(k)));
    flesh.set(k, flesh.at(k) + change);
    anchorVelocity.set(k, next);
  }
  return hn::GetLane(hn::MaxOfLanes(d, farthest));
}

void followCoarseImpl(const VectorArray& next, const FloatArray& carry, VectorArray& coarseVelocity,
                      VectorArray& velocity) {
  const D d;
  const std::size_t n = carry.size() / hn::Lanes(d) * hn::Lanes(d);
  const MutablePointers v = pointers(velocity), coarse = pointers(coarseVelocity);
  for (std::size_t k = 0; k < n; k += hn::Lanes(d)) {
    const V3 now = pointers(next).at(k);
    v.set(k, mulAdd(hn::LoadU(d, carry.data() + k), now - coarse.at(k), v.at(k)));
    coarse.set(k, now);
  }
}

bool brokenImpl(const VectorArray& position, const VectorArray& velocity,
                const VectorArray& anchorVelocity, float fastest, std::size_t first,
                std::size_t last) {
  const D d;
  const V speedLimit = hn::Set(d, fastest * fastest), placeLimit = hn::Set(d, 1e18f);
  auto sound = hn::Eq(speedLimit, speedLimit);
  for (std::size_t k = first; k < last; k += hn::Lanes(d)) {
    const V3 v = pointers(velocity).at(k) - pointers(anchorVelocity).at(k);
    const V3 r = pointers(position).at(k);
    // Comparisons with NaN are false.
    sound = hn::And(sound, hn::And(hn::Lt(dot(v, v), speedLimit), hn::Lt(dot(r, r), placeLimit)));
  }
  return !hn::AllTrue(d, sound);
}

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fascia {

HWY_EXPORT(loadImpl);
HWY_EXPORT(motionImpl);
HWY_EXPORT(absorbImpl);
HWY_EXPORT(packImpl);
HWY_EXPORT(finishImpl);
HWY_EXPORT(followImpl);
HWY_EXPORT(followCoarseImpl);
HWY_EXPORT(brokenImpl);

BlockBox loadContactLanes(const PointBlock& block, const VectorArray& position,
                          const FloatArray& fat, ContactLanes& lanes, VectorArray* last,
                          BlockMotion* motion) {
  if (last) HWY_DYNAMIC_DISPATCH(motionImpl)(block, position, *last, *motion);
  return HWY_DYNAMIC_DISPATCH(loadImpl)(block, position, fat, lanes);
}

float absorbSolid(float solid, bool move, std::uint32_t count, ContactLanes& lanes) {
  return HWY_DYNAMIC_DISPATCH(absorbImpl)(solid, move, count, lanes);
}

std::uint32_t packNearest(float solid, float reach_m, std::uint32_t count,
                          const ContactLanes& lanes, ContactLanes::Lanes3& place,
                          ContactLanes::Lanes<std::int32_t>& lane) {
  return HWY_DYNAMIC_DISPATCH(packImpl)(solid, reach_m, count, lanes, place, lane);
}

float finishContact(const PointBlock& block, bool any, float reach_m, float restitution,
                    const PointModel& points, const ContactFindings& found, VectorArray& position,
                    VectorArray& velocity, PointSurroundings& around) {
  return HWY_DYNAMIC_DISPATCH(finishImpl)(block, any, reach_m, restitution, points, found, position,
                                          velocity, around);
}

float followAnchors(const VectorArray& nextAnchor, float rate_per_s, const FloatArray* carry,
                    PointSurroundings& around, VectorArray& velocity) {
  return HWY_DYNAMIC_DISPATCH(followImpl)(nextAnchor, rate_per_s, carry, around, velocity);
}

void followCoarse(const VectorArray& next, const FloatArray& carry, VectorArray& coarseVelocity,
                  VectorArray& velocity) {
  HWY_DYNAMIC_DISPATCH(followCoarseImpl)(next, carry, coarseVelocity, velocity);
}

bool anyBroken(const VectorArray& position, const VectorArray& velocity,
               const VectorArray& anchorVelocity, float fastest_m_per_s, std::size_t first,
               std::size_t last) {
  return HWY_DYNAMIC_DISPATCH(brokenImpl)(position, velocity, anchorVelocity, fastest_m_per_s,
                                          first, last);
}

}  // namespace fascia
#endif
