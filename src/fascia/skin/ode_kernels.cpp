#include <fascia/skin/ode_kernels.h>

#include <cstring>

// SSSE3 and AVX3_DL add code, not speed, here.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fascia/skin/ode_kernels.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h

#include <fascia/skin/point/simd_vector-inl.h>

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {

using Wide = hn::ScalableTag<double>;
using WideV = hn::Vec<Wide>;
using Narrow = hn::Rebind<float, Wide>;
constexpr std::size_t kMostWide = HWY_MAX_BYTES / sizeof(double);

struct Wide3 {
  WideV x, y, z;
};

// Points from `from` on, of which `left` are there.
HWY_INLINE Wide3 loadWide(const double* from, std::size_t left) {
  const Wide d;
  Wide3 r;
  if (left >= hn::Lanes(d)) {
    hn::LoadInterleaved3(d, from, r.x, r.y, r.z);
    return r;
  }
  HWY_ALIGN double some[3 * kMostWide] = {};
  std::memcpy(some, from, 3 * left * sizeof(double));
  hn::LoadInterleaved3(d, some, r.x, r.y, r.z);
  return r;
}

HWY_INLINE void storeWide(const Wide3& r, double* to, std::size_t left) {
  const Wide d;
  if (left >= hn::Lanes(d)) {
    hn::StoreInterleaved3(r.x, r.y, r.z, d, to);
    return;
  }
  HWY_ALIGN double some[3 * kMostWide];
  hn::StoreInterleaved3(r.x, r.y, r.z, d, some);
  std::memcpy(to, some, 3 * left * sizeof(double));
}

HWY_INLINE Wide3 plus(const Wide3& a, const VectorArray& b, std::size_t k) {
  const Wide d;
  const Narrow n;
  const auto wide = [&](const FloatArray& axis)
                        HWY_ATTR { return hn::PromoteTo(d, hn::LoadU(n, axis.data() + k)); };
  return {hn::Add(a.x, wide(b.x)), hn::Add(a.y, wide(b.y)), hn::Add(a.z, wide(b.z))};
}

// Calls visit(coordinate, storage index, points left) for every vector of points.
template <class Visit>
HWY_INLINE void forEachWide(std::span<const SkinTopology::Range> ranges, const Visit& visit) {
  std::size_t point = 0;
  for (const SkinTopology::Range& range : ranges) {
    for (std::size_t i = 0; i < range.count; i += hn::Lanes(Wide()))
      visit(3 * (point + i), range.first + i, range.count - i);
    point += range.count;
  }
}

void loadCoordinatesImpl(std::span<const SkinTopology::Range> ranges, const double* from,
                         VectorArray& out) {
  forEachWide(ranges, [&](std::size_t c, std::size_t k, std::size_t left) HWY_ATTR {
    const Narrow n;
    const Wide3 r = loadWide(from + c, left);
    hn::StoreU(hn::DemoteTo(n, r.x), n, out.x.data() + k);
    hn::StoreU(hn::DemoteTo(n, r.y), n, out.y.data() + k);
    hn::StoreU(hn::DemoteTo(n, r.z), n, out.z.data() + k);
  });
}

void addCoordinatesImpl(std::span<const SkinTopology::Range> ranges, const VectorArray& change,
                        const double* from, double* to) {
  forEachWide(ranges, [&](std::size_t c, std::size_t k, std::size_t left) HWY_ATTR {
    storeWide(plus(loadWide(from + c, left), change, k), to + c, left);
  });
}

void takeChangesImpl(std::span<const SkinTopology::Range> ranges, const VectorArray& loaded,
                     double* values) {
  forEachWide(ranges, [&](std::size_t c, std::size_t k, std::size_t left) HWY_ATTR {
    const Wide d;
    const Narrow n;
    const Wide3 was = loadWide(values + c, left);
    const auto kept = [&](WideV before, const FloatArray& after) HWY_ATTR {
      return hn::Eq(hn::DemoteTo(n, before), hn::LoadU(n, after.data() + k));
    };
    const auto same =
        hn::And(kept(was.x, loaded.x), hn::And(kept(was.y, loaded.y), kept(was.z, loaded.z)));
    if (hn::AllTrue(n, same)) return;
    const auto taken = [&](WideV before, const FloatArray& after) HWY_ATTR {
      const auto now = hn::PromoteTo(d, hn::LoadU(n, after.data() + k));
      const auto rounded = hn::PromoteTo(d, hn::DemoteTo(n, before));
      return hn::Add(before, hn::Sub(now, rounded));
    };
    storeWide({taken(was.x, loaded.x), taken(was.y, loaded.y), taken(was.z, loaded.z)}, values + c,
              left);
  });
}

// From the anchors to a vector of points (Turner & Gobbetti 1998, eq. 3). Strands damp along
// themselves; without a rest length they hold a point from all sides, and damp so.
struct Strands {
  V3 way, along;  // along: of length 1
  V pull;         // force over way; 0 = slack
  V damping;      // N s/m; 0 where slack
  hn::Mask<D> fromAllSides;
};

HWY_INLINE V3 anchorVelocities(const StrandScene& scene, std::size_t k) {
  return pointers(scene.around->anchorVelocity).at(k);
}

HWY_INLINE Strands strandsAt(const StrandScene& scene, const VectorArray& position, std::size_t k) {
  const D d;
  const V zero = hn::Zero(d);
  const PointModel& p = *scene.points;
  const V3 anchor = mulAdd(hn::Set(d, scene.since_s), anchorVelocities(scene, k),
                           pointers(scene.around->anchor).at(k));
  const V3 way = pointers(position).at(k) - anchor;
  const V squared = dot(way, way);
  const V inverse = inverseRoot(hn::Add(squared, hn::Set(d, 1e-18f)));
  const V rest = hn::LoadU(d, p.tissueRestLength.data() + k);
  const V stiffness = hn::LoadU(d, p.tissueStiffness.data() + k);
  const auto taut = hn::And(hn::Gt(stiffness, zero), hn::And(hn::Gt(squared, hn::Set(d, 1e-18f)),
                                                             hn::Gt(squared, hn::Mul(rest, rest))));
  const V share = hn::NegMulAdd(rest, inverse, hn::Set(d, 1.f));
  return {way, scaled(inverse, way), hn::IfThenElseZero(taut, hn::Mul(stiffness, share)),
          hn::IfThenElseZero(taut, hn::LoadU(d, p.tissueDamping.data() + k)), hn::Eq(rest, zero)};
}

template <class Visit>
HWY_INLINE void forEachVector(std::span<const SkinTopology::Range> ranges, const Visit& visit) {
  for (const SkinTopology::Range& range : ranges)
    for (std::size_t k = range.first; k < range.first + range.count; k += hn::Lanes(D())) visit(k);
}

void addStrandForcesImpl(const StrandScene& scene, const VectorArray& position,
                         VectorArray& force) {
  const D d;
  const V3 gravity{hn::Set(d, scene.gravity[0]), hn::Set(d, scene.gravity[1]),
                   hn::Set(d, scene.gravity[2])};
  forEachVector(scene.ranges, [&](std::size_t k) HWY_ATTR {
    const Strands strands = strandsAt(scene, position, k);
    const V mass = hn::LoadU(d, scene.points->mass.data() + k);
    const V3 own = mulAdd(mass, gravity, pointers(force).at(k));
    pointers(force).set(k, mulAdd(hn::Neg(strands.pull), strands.way, own));
  });
}

void dampingForcesImpl(const StrandScene& scene, const VectorArray& position,
                       const VectorArray& velocity, VectorArray& force) {
  const D d;
  forEachVector(scene.ranges, [&](std::size_t k) HWY_ATTR {
    const Strands strands = strandsAt(scene, position, k);
    const V drag = hn::LoadU(d, scene.points->drag.data() + k);
    const V3 v = pointers(velocity).at(k), relative = v - anchorVelocities(scene, k);
    const V3 closing =
        select(strands.fromAllSides, relative, scaled(dot(relative, strands.along), strands.along));
    pointers(force).set(k, mulAdd(hn::Neg(strands.damping), closing, scaled(hn::Neg(drag), v)));
  });
}

// With a = h/(2M), α = 1 + a γ and C = c n nᵀ (or c, from all sides) the mean velocity q obeys
// q = v + a (f − γ q − C (q − u)), u being the anchor's. Then v⁺ − v = 2 (q − v), where
//   from all sides   q − v = a (f − γ v − c (v − u)) / (α + a c)
//   along n          q − v = a (f − γ v − c s n) / α,  s = n·(q − u) = n·(v + a f − α u)/(α + a c)
void midpointKicksImpl(const StrandScene& scene, const FloatArray& inverseMass, float h,
                       const VectorArray& position, const VectorArray& velocity,
                       const VectorArray& force, VectorArray& change) {
  const D d;
  const V one = hn::Set(d, 1.f), two = hn::Set(d, 2.f), half = hn::Set(d, 0.5f * h);
  forEachVector(scene.ranges, [&](std::size_t k) HWY_ATTR {
    const Strands strands = strandsAt(scene, position, k);
    const V a = hn::Mul(half, hn::LoadU(d, inverseMass.data() + k));
    const V drag = hn::LoadU(d, scene.points->drag.data() + k), c = strands.damping;
    const V alpha = hn::MulAdd(a, drag, one), stiff = hn::MulAdd(a, c, alpha);
    const V3 v = pointers(velocity).at(k), u = anchorVelocities(scene, k);
    const V3 f = pointers(force).at(k), dragged = mulAdd(hn::Neg(drag), v, f);
    const V s = hn::Div(dot(strands.along, mulAdd(a, f, v) - scaled(alpha, u)), stiff);
    const V3 along = mulAdd(hn::Neg(hn::Mul(c, s)), strands.along, dragged);
    const V3 around = mulAdd(hn::Neg(c), v - u, dragged);
    const V3 total = select(strands.fromAllSides, around, along);
    const V share = hn::Div(hn::Mul(two, a), hn::IfThenElse(strands.fromAllSides, stiff, alpha));
    pointers(change).set(k, scaled(share, total));
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fascia {

HWY_EXPORT(loadCoordinatesImpl);
HWY_EXPORT(addCoordinatesImpl);
HWY_EXPORT(takeChangesImpl);
HWY_EXPORT(addStrandForcesImpl);
HWY_EXPORT(dampingForcesImpl);
HWY_EXPORT(midpointKicksImpl);

void loadCoordinates(std::span<const SkinTopology::Range> ranges, std::span<const double> from,
                     VectorArray& out) {
  HWY_DYNAMIC_DISPATCH(loadCoordinatesImpl)(ranges, from.data(), out);
}

void addCoordinates(std::span<const SkinTopology::Range> ranges, const VectorArray& change,
                    std::span<const double> from, std::span<double> to) {
  HWY_DYNAMIC_DISPATCH(addCoordinatesImpl)(ranges, change, from.data(), to.data());
}

void takeChanges(std::span<const SkinTopology::Range> ranges, const VectorArray& loaded,
                 std::span<double> values) {
  HWY_DYNAMIC_DISPATCH(takeChangesImpl)(ranges, loaded, values.data());
}

void addStrandForces(const StrandScene& scene, const VectorArray& position, VectorArray& force) {
  HWY_DYNAMIC_DISPATCH(addStrandForcesImpl)(scene, position, force);
}

void dampingForces(const StrandScene& scene, const VectorArray& position,
                   const VectorArray& velocity, VectorArray& force) {
  HWY_DYNAMIC_DISPATCH(dampingForcesImpl)(scene, position, velocity, force);
}

void midpointKicks(const StrandScene& scene, const FloatArray& inverseMass, float h_s,
                   const VectorArray& position, const VectorArray& velocity,
                   const VectorArray& force, VectorArray& change) {
  HWY_DYNAMIC_DISPATCH(midpointKicksImpl)
  (scene, inverseMass, h_s, position, velocity, force, change);
}

}  // namespace fascia
#endif
