// One step of the stabilised leapfrog (leapfrog.h) for a vector of points, shared by grids and
// meshes. Included once per Highway target.
#if defined(FASCIA_SKIN_POINT_STEP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FASCIA_SKIN_POINT_STEP_INL_H_
#undef FASCIA_SKIN_POINT_STEP_INL_H_
#else
#define FASCIA_SKIN_POINT_STEP_INL_H_
#endif

#include <fascia/skin/point/simd_vector-inl.h>
#include <fascia/skin/point/step_inputs.h>

HWY_BEFORE_NAMESPACE();
namespace fascia {
namespace HWY_NAMESPACE {

// Everything that acts on one vector of points besides the surface's forces, and the time step.
struct PointStep {
  const StepInputs& m;
  float time_s;

  // Returns the new position.
  HWY_INLINE V3 operator()(std::size_t k, V3 force, const MutablePointers& r,
                           const MutablePointers& v, std::size_t local) const {
    const D d;
    const PointModel& p = *m.points;
    const StepCoefficients& s = *m.step;
    const PointSurroundings& around = *m.surroundings;
    const auto load = [&](const FloatArray& a) HWY_ATTR { return hn::LoadU(d, a.data() + k); };
    const V time = hn::Set(d, time_s), before = hn::Set(d, time_s - s.step_s), zero = hn::Zero(d);
    V3 position = r.at(local), velocity = v.at(local);
    if (m.extraForce) force = force + pointers(*m.extraForce).at(k);

    // Tissue (Turner & Gobbetti 1998, eq. 3): pulls only beyond its rest length, along the strand.
    // Strands without one hold a point from all sides, and damp it so.
    const V3 anchorVelocity = pointers(around.anchorVelocity).at(k);
    const V3 strand = position - mulAdd(before, anchorVelocity, pointers(around.anchor).at(k));
    const V squared = hn::Add(dot(strand, strand), hn::Set(d, 1e-16f));
    const V inverse = inverseRoot(squared);
    const V restLength = load(p.tissueRestLength);
    const V extension = hn::Sub(hn::Mul(squared, inverse), restLength);
    const auto taut = hn::Gt(extension, zero);
    const V pull =
        hn::IfThenElseZero(taut, hn::Mul(hn::Mul(load(p.tissueStiffness), extension), inverse));
    const V3 relativeVelocity = velocity - anchorVelocity;
    const V along = hn::Mul(dot(relativeVelocity, strand), hn::Mul(inverse, inverse));
    const V3 closing = select(hn::Eq(restLength, zero), relativeVelocity, scaled(along, strand));
    const V damped = hn::IfThenElseZero(taut, load(s.strandGain));

    const V weight = load(s.weight);
    const V3 gravity{hn::Set(d, m.gravity[0]), hn::Set(d, m.gravity[1]), hn::Set(d, m.gravity[2])};
    force = mulAdd(weight, gravity, mulAdd(hn::Neg(pull), strand, force));
    velocity = mulAdd(load(s.gain), force, scaled(load(s.keep), velocity));
    velocity = mulAdd(hn::Neg(damped), closing, velocity);
    position = mulAdd(hn::Set(d, s.step_s), velocity, position);

    // Flesh as a moving half space (Turner & Gobbetti 1998, eq. 13); velocities are relative to the
    // flesh.
    const V3 normal = pointers(around.normal).at(k);
    const V3 flesh = pointers(around.fleshVelocity).at(k);
    const V offset = hn::MulAdd(time, dot(normal, flesh), load(around.offset));
    const V depth = hn::Min(hn::Sub(dot(normal, position), offset), zero);
    const auto inside = hn::Lt(depth, zero);
    if (!hn::AllFalse(d, inside)) {
      position = mulAdd(hn::Neg(depth), normal, position);
      const V3 relative = velocity - flesh;
      const V outward = dot(relative, normal);
      const V bounced =
          hn::IfThenElse(hn::Lt(outward, zero), hn::Mul(hn::Set(d, -s.bounce), outward), outward);
      const V3 tangential = scaled(hn::Set(d, s.slide), mulAdd(hn::Neg(outward), normal, relative));
      const V3 after = flesh + mulAdd(bounced, normal, tangential);
      velocity = select(inside, after, velocity);
    }
    r.set(local, position);
    v.set(local, velocity);
    return position;
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace fascia
HWY_AFTER_NAMESPACE();

#endif
