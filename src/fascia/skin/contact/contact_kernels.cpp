#include <fascia/skin/contact/contact_kernels.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

// SSSE3 and AVX3_DL add code, not speed, here.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fascia/skin/contact/contact_kernels.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h

#include <fascia/skin/contact/absorb-inl.h>

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {

constexpr std::size_t kGroup = ContactGroup::kLanes;

// Of the lanes from l on, those that are points.
HWY_INLINE hn::Mask<D> usedLanes(const ContactGroup& group, std::size_t l) {
  const D d;
  return hn::Lt(hn::Iota(d, static_cast<float>(l)), hn::Set(d, static_cast<float>(group.count)));
}

// One bit per lane: a compressed store costs more where few lanes are wanted.
HWY_INLINE std::uint64_t bitsOf(hn::Mask<D> mask) {
  HWY_ALIGN std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(D(), mask, bytes);
  std::uint64_t bits;
  std::memcpy(&bits, bytes, sizeof(bits));
  return bits & ((std::uint64_t{1} << hn::Lanes(D())) - 1);
}

void loadImpl(std::span<const ContactGroup> groups, const VectorArray& position,
              const FloatArray& fat, ContactLanes& lanes, GroupBox* boxes) {
  const D d;
  const V big = hn::Set(d, 1e30f), zero = hn::Zero(d);
  const auto least = [&](V v) HWY_ATTR { return hn::GetLane(hn::MinOfLanes(d, v)); };
  const auto most = [&](V v) HWY_ATTR { return hn::GetLane(hn::MaxOfLanes(d, v)); };
  for (std::size_t g = 0; g < groups.size(); ++g) {
    V3 low{big, big, big}, high = scaled(hn::Set(d, -1.f), low);
    for (std::size_t l = 0; l < kGroup; l += hn::Lanes(d)) {
      const std::size_t k = groups[g].first + l, i = g * kGroup + l;
      if (l >= groups[g].count) break;
      const V3 r = pointers(position).at(k);
      const V thickness = hn::LoadU(d, fat.data() + k);
      pointers(lanes.place).set(i, r);
      pointers(lanes.pushNormal).set(i, {zero, zero, zero});
      hn::StoreU(thickness, d, lanes.fat.data() + i);
      const auto used = usedLanes(groups[g], l);
      const V3 around{thickness, thickness, thickness};
      const V3 forLow = select(used, r - around, low), forHigh = select(used, r + around, high);
      low = {hn::Min(low.x, forLow.x), hn::Min(low.y, forLow.y), hn::Min(low.z, forLow.z)};
      high = {hn::Max(high.x, forHigh.x), hn::Max(high.y, forHigh.y), hn::Max(high.z, forHigh.z)};
    }
    boxes[g] = {{least(low.x), least(low.y), least(low.z)},
                {most(high.x), most(high.y), most(high.z)}};
  }
}

// How a group's points went since they were last seen.
struct GroupMotion {
  float center[3], way[3];  // where the middle one was, and how far it went
  float radius_m;           // farthest that one was from there
  float spread_m;           // farthest that one's way is from that
};

HWY_INLINE GroupMotion motionOf(const ContactGroup& group, const VectorArray& position,
                                VectorArray& last) {
  const D d;
  GroupMotion out;
  const std::size_t middle = group.first + group.count / 2;
  for (int a = 0; a < 3; ++a) {
    out.center[a] = (last.*VectorArray::kAxes[a])[middle];
    out.way[a] = (position.*VectorArray::kAxes[a])[middle] - out.center[a];
  }
  const V3 center{hn::Set(d, out.center[0]), hn::Set(d, out.center[1]), hn::Set(d, out.center[2])};
  const V3 way{hn::Set(d, out.way[0]), hn::Set(d, out.way[1]), hn::Set(d, out.way[2])};
  V radius = hn::Zero(d), spread = hn::Zero(d);
  for (std::size_t l = 0; l < group.count; l += hn::Lanes(d)) {
    const std::size_t k = group.first + l;
    const V3 r = pointers(last).at(k), q = pointers(position).at(k);
    const V3 fromCenter = r - center, fromWay = (q - r) - way;
    const auto used = usedLanes(group, l);
    radius = hn::Max(radius, hn::IfThenElseZero(used, dot(fromCenter, fromCenter)));
    spread = hn::Max(spread, hn::IfThenElseZero(used, dot(fromWay, fromWay)));
    pointers(last).set(k, q);
  }
  out.radius_m = std::sqrt(hn::GetLane(hn::MaxOfLanes(d, radius)));
  out.spread_m = std::sqrt(hn::GetLane(hn::MaxOfLanes(d, spread)));
  return out;
}

void ageGapsImpl(std::span<const ContactGroup> groups, const VectorArray& position,
                 const CulledSolids& solids, VectorArray& last, float* gaps) {
  const D d;
  for (const ContactGroup& group : groups) {
    const GroupMotion moved = motionOf(group, position, last);
    for (std::size_t s = 0; s < solids.padded(); s += hn::Lanes(d)) {
      const auto load = [&](const float* list) HWY_ATTR { return hn::LoadU(d, list + s); };
      V from[3], way2 = hn::Zero(d);
      for (int a = 0; a < 3; ++a)
        from[a] = hn::Sub(hn::Set(d, moved.center[a]), load(solids.origin(a)));
      for (int a = 0; a < 3; ++a) {
        V matter = load(solids.shift(a));
        for (int b = 0; b < 3; ++b) matter = hn::MulAdd(load(solids.change(a, b)), from[b], matter);
        const V way = hn::Sub(hn::Set(d, moved.way[a]), matter);
        way2 = hn::MulAdd(way, way, way2);
      }
      const V rigid = hn::Add(hn::Sqrt(way2), hn::Set(d, moved.spread_m));
      const V turned = hn::MulAdd(load(solids.turn()), hn::Set(d, moved.radius_m), rigid);
      const V nearer = hn::Mul(load(solids.steepness()), hn::Add(turned, load(solids.extra_m())));
      // Also what is not a number makes a gap unknown.
      const auto known = hn::Lt(nearer, hn::Set(d, -kUnknownGap_m));
      hn::StoreU(hn::IfThenElse(known, hn::Sub(load(gaps), nearer), hn::Set(d, kUnknownGap_m)), d,
                 gaps + s);
    }
    gaps += solids.padded();
  }
}

void findNearImpl(std::span<const GroupBox> boxes, const CulledSolids& solids, const float* reaches,
                  const float* gaps, NearGroups& out) {
  const D d;
  for (std::size_t g = 0; g < boxes.size(); ++g) {
    const float reach = reaches[g];
    if (!(reach >= 0)) continue;
    const GroupBox& box = boxes[g];
    for (std::size_t s = 0; s < solids.padded(); s += hn::Lanes(d)) {
      const V number = hn::Iota(d, static_cast<float>(s));
      auto isNear = hn::Lt(number, hn::Set(d, static_cast<float>(solids.count())));
      if (gaps) {
        const V gap = hn::LoadU(d, gaps + g * solids.padded() + s);
        isNear = hn::And(isNear, hn::Le(gap, hn::Set(d, reach)));
        if (hn::AllFalse(d, isNear)) continue;
      }
      for (int a = 0; a < 3; ++a) {
        const V low = hn::Set(d, box.low[a] - reach), high = hn::Set(d, box.high[a] + reach);
        isNear = hn::And(isNear, hn::And(hn::Le(low, hn::LoadU(d, solids.high(a) + s)),
                                         hn::Ge(high, hn::LoadU(d, solids.low(a) + s))));
      }
      if (hn::AllFalse(d, isNear)) continue;
      for (std::uint64_t bits = bitsOf(isNear); bits != 0; bits &= bits - 1)
        out.add(s + static_cast<std::size_t>(std::countr_zero(bits)),
                static_cast<std::uint32_t>(g));
    }
  }
}

void beginVisitImpl(std::span<const std::uint32_t> groups, ContactLanes& lanes) {
  const D d;
  const V far = hn::Set(d, 1e30f), zero = hn::Zero(d);
  for (const std::uint32_t g : groups) {
    for (std::size_t i = g * kGroup; i < (g + 1) * kGroup; i += hn::Lanes(d)) {
      hn::StoreU(far, d, lanes.nearest.data() + i);
      hn::StoreU(far, d, lanes.clearance.data() + i);
      hn::StoreU(zero, d, lanes.pushed.data() + i);
    }
  }
}

HWY_INLINE void moveOut(V gap, V3 normal, std::size_t i, ContactLanes& lanes) {
  const D d;
  V3 place = pointers(lanes.place).at(i), push = pointers(lanes.pushNormal).at(i);
  V pushed = hn::LoadU(d, lanes.pushed.data() + i);
  pushOut(gap, normal, place, push, pushed);
  pointers(lanes.place).set(i, place);
  pointers(lanes.pushNormal).set(i, push);
  hn::StoreU(pushed, d, lanes.pushed.data() + i);
}

HWY_INLINE void takeUp(V gap, V3 normal, V solid, std::size_t i, ContactLanes& lanes) {
  const D d;
  const V zero = hn::Zero(d);
  const V clearance = hn::LoadU(d, lanes.clearance.data() + i);
  const auto inside = hn::Lt(gap, zero);
  const V outsideGap = hn::Min(clearance, hn::IfThenElse(inside, clearance, gap));
  const V pushed = hn::LoadU(d, lanes.pushed.data() + i);
  const auto again = hn::And(inside, hn::Gt(pushed, zero));
  hn::StoreU(hn::IfThenElse(again, zero, outsideGap), d, lanes.clearance.data() + i);
  if (!hn::AllFalse(d, inside)) moveOut(gap, normal, i, lanes);
  V nearest = hn::LoadU(d, lanes.nearest.data() + i);
  V3 nearestNormal = pointers(lanes.nearestNormal).at(i);
  V nearestSolid = hn::LoadU(d, lanes.nearestSolid.data() + i);
  keepNearest(gap, normal, solid, nearest, nearestNormal, nearestSolid);
  hn::StoreU(nearest, d, lanes.nearest.data() + i);
  pointers(lanes.nearestNormal).set(i, nearestNormal);
  hn::StoreU(nearestSolid, d, lanes.nearestSolid.data() + i);
}

void absorbImpl(const SolidAnswer& answer, std::span<const ContactGroup> groups, const float* reach,
                ContactLanes& lanes, float* smallest) {
  const D d;
  const V far = hn::Set(d, 1e30f), solid = hn::Set(d, answer.solid);
  const Pointers normals{answer.normal.x, answer.normal.y, answer.normal.z};
  for (std::size_t n = 0; n < answer.near.size(); ++n) {
    const std::size_t g = answer.near[n];
    V least = far;
    const auto gapAt = [&](std::size_t l) HWY_ATTR {
      const V fat = hn::LoadU(d, lanes.fat.data() + g * kGroup + l);
      const V distance = hn::LoadU(d, answer.distance + n * kGroup + l);
      return hn::IfThenElse(usedLanes(groups[g], l), hn::Sub(distance, fat), far);
    };
    for (std::size_t l = 0; l < kGroup; l += hn::Lanes(d)) least = hn::Min(least, gapAt(l));
    smallest[n] = hn::GetLane(hn::MinOfLanes(d, least));
    if (smallest[n] > reach[g]) continue;
    for (std::size_t l = 0; l < kGroup; l += hn::Lanes(d))
      takeUp(gapAt(l), normals.at(n * kGroup + l), solid, g * kGroup + l, lanes);
  }
}

void findPushedImpl(std::span<const ContactGroup> groups, float more, const ContactLanes& lanes,
                    char* into) {
  const D d;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    bool any = false;
    for (std::size_t l = 0; l < groups[g].count; l += hn::Lanes(d)) {
      const V pushed = hn::LoadU(d, lanes.pushed.data() + g * kGroup + l);
      const V clearance = hn::LoadU(d, lanes.clearance.data() + g * kGroup + l);
      const auto must = hn::And(hn::Gt(pushed, hn::Set(d, more)), hn::Lt(clearance, pushed));
      any = any || !hn::AllFalse(d, hn::And(must, usedLanes(groups[g], l)));
    }
    into[g] = any;
  }
}

std::size_t packImpl(float solid, std::span<const std::uint32_t> near,
                     std::span<const ContactGroup> groups, float reach, const ContactLanes& lanes,
                     Vectors place, std::int32_t* lane) {
  const D d;
  const hn::RebindToSigned<D> di;
  std::size_t packed = 0;
  for (const std::uint32_t g : near) {
    for (std::size_t l = 0; l < groups[g].count; l += hn::Lanes(d)) {
      const std::size_t i = g * kGroup + l;
      const auto own = hn::Eq(hn::LoadU(d, lanes.nearestSolid.data() + i), hn::Set(d, solid));
      const V3 push = pointers(lanes.pushNormal).at(i);
      const auto felt = hn::Or(hn::Le(hn::LoadU(d, lanes.nearest.data() + i), hn::Set(d, reach)),
                               hn::Gt(dot(push, push), hn::Zero(d)));
      const auto wanted = hn::And(usedLanes(groups[g], l), hn::And(own, felt));
      if (hn::AllFalse(d, wanted)) continue;
      const V3 from = pointers(lanes.place).at(i);
      // There is room: whole vectors are stored faster than parts.
      hn::StoreU(hn::Compress(from.x, wanted), d, place.x + packed);
      hn::StoreU(hn::Compress(from.y, wanted), d, place.y + packed);
      hn::StoreU(hn::Compress(from.z, wanted), d, place.z + packed);
      const auto numbers = hn::Iota(di, static_cast<std::int32_t>(i));
      hn::StoreU(hn::Compress(numbers, hn::RebindMask(di, wanted)), di, lane + packed);
      packed += hn::CountTrue(d, wanted);
    }
  }
  return packed;
}

// What the flesh does to one vector of points, i in the batch and k in storage. Returns their new
// velocity.
HWY_INLINE V3 respond(std::size_t i, std::size_t k, hn::Mask<D> used, float reach,
                      float restitution, const PointModel& points, const ContactLanes& lanes,
                      VectorArray& position, V3 speed, PointSurroundings& around) {
  const D d;
  const V zero = hn::Zero(d);
  const V3 zero3{zero, zero, zero};
  const MutablePointers r = pointers(position);
  const V nearest = hn::LoadU(d, lanes.nearest.data() + i);
  const auto isFree = hn::Gt(hn::LoadU(d, points.free.data() + k), zero);
  // A point that was moved out of a solid may end a little outside of it, or well outside.
  const V3 place = r.at(k), found = pointers(lanes.place).at(i), way = found - place;
  const auto candidate = hn::And(used, isFree);
  const auto moved = hn::And(candidate, hn::Gt(dot(way, way), zero));
  const auto touching = hn::Or(moved, hn::And(candidate, hn::Le(nearest, hn::Set(d, reach))));
  const auto onFlesh = hn::Or(moved, hn::And(touching, hn::Le(nearest, zero)));
  const V3 normal = select(touching, pointers(lanes.nearestNormal).at(i), zero3);
  const V3 flesh = select(touching, pointers(lanes.fleshVelocity).at(i), zero3);
  const V3 now = select(onFlesh, found, place);
  const V approach = hn::Min(dot(normal, speed - flesh), zero);
  const V offset = hn::Sub(dot(normal, now), nearest);
  r.set(k, now);
  pointers(around.normal).set(k, normal);
  pointers(around.fleshVelocity).set(k, flesh);
  hn::StoreU(hn::IfThenElseZero(touching, offset), d, around.offset.data() + k);
  return select(onFlesh, mulAdd(hn::Mul(hn::Set(d, -1.f - restitution), approach), normal, speed),
                speed);
}

float finishImpl(std::span<const ContactGroup> groups, const char* touched, float reach,
                 float restitution, const PointModel& points, const ContactLanes& lanes,
                 VectorArray& position, VectorArray& velocity, PointSurroundings& around) {
  const D d;
  const V zero = hn::Zero(d);
  const V3 zero3{zero, zero, zero};
  V fastest = zero;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (std::size_t l = 0; l < groups[g].count; l += hn::Lanes(d)) {
      const std::size_t k = groups[g].first + l;
      const auto used = usedLanes(groups[g], l);
      const MutablePointers v = pointers(velocity);
      V3 speed = select(used, v.at(k), zero3);
      if (touched[g] == 0) {
        pointers(around.normal).set(k, zero3);
        pointers(around.fleshVelocity).set(k, zero3);
        hn::StoreU(zero, d, around.offset.data() + k);
      } else {
        speed = respond(g * kGroup + l, k, used, reach, restitution, points, lanes, position, speed,
                        around);
        v.set(k, select(used, speed, v.at(k)));
      }
      const V3 relative = select(used, speed - pointers(around.anchorVelocity).at(k), zero3);
      fastest = hn::Max(fastest, dot(relative, relative));
    }
  }
  return hn::GetLane(hn::MaxOfLanes(d, fastest));
}

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fascia {

HWY_EXPORT(loadImpl);
HWY_EXPORT(ageGapsImpl);
HWY_EXPORT(findNearImpl);
HWY_EXPORT(beginVisitImpl);
HWY_EXPORT(absorbImpl);
HWY_EXPORT(findPushedImpl);
HWY_EXPORT(packImpl);
HWY_EXPORT(finishImpl);

void loadGroups(std::span<const ContactGroup> groups, const VectorArray& position,
                const FloatArray& fat, ContactLanes& lanes, GroupBox* boxes) {
  HWY_DYNAMIC_DISPATCH(loadImpl)(groups, position, fat, lanes, boxes);
}

void ageGaps(std::span<const ContactGroup> groups, const VectorArray& position,
             const CulledSolids& solids, VectorArray& last, float* gaps) {
  HWY_DYNAMIC_DISPATCH(ageGapsImpl)(groups, position, solids, last, gaps);
}

void findNearSolids(std::span<const GroupBox> boxes, const CulledSolids& solids,
                    const float* reach_m, const float* gaps, NearGroups& found) {
  HWY_DYNAMIC_DISPATCH(findNearImpl)(boxes, solids, reach_m, gaps, found);
}

void beginVisit(std::span<const std::uint32_t> groups, ContactLanes& lanes) {
  HWY_DYNAMIC_DISPATCH(beginVisitImpl)(groups, lanes);
}

void absorbSolid(const SolidAnswer& answer, std::span<const ContactGroup> groups,
                 const float* reach_m, ContactLanes& lanes, float* smallest) {
  HWY_DYNAMIC_DISPATCH(absorbImpl)(answer, groups, reach_m, lanes, smallest);
}

void findPushed(std::span<const ContactGroup> groups, float more_m, const ContactLanes& lanes,
                char* into) {
  HWY_DYNAMIC_DISPATCH(findPushedImpl)(groups, more_m, lanes, into);
}

std::size_t packNearest(float solid, std::span<const std::uint32_t> near,
                        std::span<const ContactGroup> groups, float reach_m,
                        const ContactLanes& lanes, Vectors place, std::int32_t* lane) {
  return HWY_DYNAMIC_DISPATCH(packImpl)(solid, near, groups, reach_m, lanes, place, lane);
}

float finishContact(std::span<const ContactGroup> groups, const char* touched, float reach_m,
                    float restitution, const PointModel& points, const ContactLanes& lanes,
                    VectorArray& position, VectorArray& velocity, PointSurroundings& around) {
  return HWY_DYNAMIC_DISPATCH(finishImpl)(groups, touched, reach_m, restitution, points, lanes,
                                          position, velocity, around);
}

}  // namespace fascia
#endif
