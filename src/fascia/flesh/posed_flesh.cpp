#include <algorithm>
#include <cmath>

#include <fascia/field/affine_kernels.h>
#include <fascia/field/solid.h>
#include <fascia/flesh/flesh_bound.h>
#include <fascia/math/points.h>

namespace fascia {
namespace {

// How far parameters move, relative to their size, to differentiate localFromMaterial. Smaller
// loses digits to rounding, larger to curvature; either side of 1e-4 costs less than 1e-7.
constexpr double kRelativeStep = 1e-4;
constexpr double kSmallestParameter = 0.01;  // in any unit; keeps the step away from 0

Box boxInWorld(const Box& local, const Transform& world) {
  const Vec3 center = world.point(local.center());
  const Vec3 half = world.rotation.cwiseAbs() * (0.5 * local.size());
  return {center - half, center + half};
}

Mat3 crossMatrix(const Vec3& w) {
  Mat3 m;
  m << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return m;
}

// Whether the undeformed shapes of two states of one solid differ by a stretching along its axes.
// True for every superquadric, whose points are products of half sizes and a function of direction
// and exponents (Barr 1981); a capsule keeps its ends round instead.
bool shapesDifferByStretch(const Solid& a, const Solid& b) {
  const PrimitiveKernel &p = a.kernel().primitive, &q = b.kernel().primitive;
  return p.kind != PrimitiveKernel::Kind::capsule && p.northSouthPower == q.northSouthPower &&
         p.eastWestPower == q.eastWestPower;
}
bool differByStretch(const Solid& a, const Solid& b) {
  return !a.deformed() && shapesDifferByStretch(a, b);
}

}  // namespace

void PosedFlesh::write(Posed& posed, int parameter, double value, double rate) {
  posed.parameters[static_cast<std::size_t>(parameter)] = {value, rate};
  posed.written = true;
  if (posed.ahead.parameterCount() == 0) posed.ahead = posed.behind = posed.solid;
}

void PosedFlesh::reset(Posed& posed) {
  for (std::size_t i = 0; i < posed.parameters.size(); ++i) {
    posed.parameters[i] = {posed.rest->parameter(static_cast<int>(i)), 0};
  }
  posed.written = false;
}

// Hands the wanted parameters to the solid. Returns whether any of them is changing: not one that
// is held at the edge of its range.
bool PosedFlesh::apply(Posed& posed) {
  bool changing = false;
  for (std::size_t i = 0; i < posed.parameters.size(); ++i) {
    auto& [value, rate] = posed.parameters[i];
    const ParameterInfo& info = posed.solid.parameterInfo(static_cast<int>(i));
    const bool held = !std::isfinite(value) || !std::isfinite(rate) ||
                      (value >= info.max && rate > 0) || (value <= info.min && rate < 0);
    value = std::isnan(value) ? posed.rest->parameter(static_cast<int>(i))
                              : std::clamp(value, info.min, info.max);
    rate = held ? 0 : rate;
    posed.values[i] = value;
    changing = changing || rate != 0;
  }
  posed.solid.setParameters(posed.values);
  return changing;
}

// Sets behind and ahead: the solid at parameters p ± τ ṗ, or one of the two at p where the range of
// a parameter leaves no room. Returns the time between them.
double PosedFlesh::differentiate(Posed& posed) {
  double step_s = 1e300, roomBehind_s = 1e300, roomAhead_s = 1e300;
  for (std::size_t i = 0; i < posed.parameters.size(); ++i) {
    const auto [p, rate] = posed.parameters[i];
    if (rate == 0) continue;
    const ParameterInfo& info = posed.solid.parameterInfo(static_cast<int>(i));
    const double speed = std::abs(rate);
    step_s = std::min(step_s, kRelativeStep * std::max(std::abs(p), kSmallestParameter) / speed);
    roomAhead_s = std::min(roomAhead_s, (rate > 0 ? info.max - p : p - info.min) / speed);
    roomBehind_s = std::min(roomBehind_s, (rate > 0 ? p - info.min : info.max - p) / speed);
  }
  const bool roomBoth = std::min(roomAhead_s, roomBehind_s) >= step_s;
  const double ahead_s = roomBoth || roomAhead_s >= roomBehind_s ? step_s : 0;
  const double behind_s = roomBoth || roomAhead_s < roomBehind_s ? step_s : 0;
  const auto setAt = [&](Solid& solid, double time_s) {
    for (std::size_t i = 0; i < posed.parameters.size(); ++i)
      posed.values[i] = posed.parameters[i].value + time_s * posed.parameters[i].rate;
    solid.setParameters(posed.values);
  };
  setAt(posed.ahead, ahead_s);
  setAt(posed.behind, -behind_s);
  return ahead_s + behind_s;
}

// How the matter moves inside the frame while parameters change.
void PosedFlesh::addSwelling(Posed& posed) {
  const double span_s = differentiate(posed);
  if (!differByStretch(posed.behind, posed.ahead)) {
    posed.behindToAhead_s = span_s;
    return;
  }
  const Vec3 growth_m = posed.ahead.halfExtents_m() - posed.behind.halfExtents_m();
  const Vec3 swelling_per_s = growth_m.cwiseQuotient(span_s * posed.solid.halfExtents_m());
  const Mat3& r = posed.world.rotation;
  posed.velocityGradient += r * swelling_per_s.asDiagonal() * r.transpose();
}

// After parameters, frame and twist are set: everything that follows from them.
void PosedFlesh::finish(Posed& posed) {
  posed.velocityGradient = crossMatrix(posed.twist.angular_rad_per_s);
  posed.behindToAhead_s = 0;
  if (posed.ahead.parameterCount() > 0) {  // was ever written; most solids never are
    const bool changing = apply(posed);
    const Vec3 now_m = posed.solid.halfExtents_m(), rest_m = posed.rest->halfExtents_m();
    posed.stretched = !posed.written || differByStretch(*posed.rest, posed.solid);
    posed.stretch = now_m.cwiseQuotient(rest_m);
    if (changing) addSwelling(posed);
  }
  posed.bounds = boxInWorld(posed.solid.bounds(), posed.world);
}

void PosedFlesh::evaluate(SolidId solid, ConstVectors points, float* distance_m,
                          Vectors normal) const {
  const Posed& posed = posed_[solid.index()];
  evaluatePosed(posed.solid, posed.world, points, distance_m, normal);
}

void PosedFlesh::velocity(SolidId solid, ConstVectors points, Vectors velocity) const {
  const Posed& posed = posed_[solid.index()];
  const Twist& twist = posed.twist;
  affinePoints(posed.velocityGradient, twist.origin_m, twist.linear_m_per_s, points, velocity);
  if (posed.behindToAhead_s == 0) return;
  const Transform localFromWorld = posed.world.inverse();
  for (std::size_t i = 0; i < points.count; ++i) {
    const Vec3 moved_m = movement(posed, localFromWorld.point(pointAt(points, i)));
    setPoint(velocity, i,
             pointAt(velocity, i) + posed.world.vector(moved_m / posed.behindToAhead_s));
  }
}

// How far the matter at a place goes from behind to ahead.
Vec3 PosedFlesh::movement(const Posed& posed, const Vec3& local) {
  if (!shapesDifferByStretch(posed.behind, posed.ahead)) {
    const Vec3 matter = posed.solid.materialFromLocal(local);
    return posed.ahead.localFromMaterial(matter) - posed.behind.localFromMaterial(matter);
  }
  // Material coordinates that only half sizes differ in: their gauges cancel.
  const Vec3 x = posed.solid.shapeFromDeformed(local).cwiseQuotient(posed.solid.halfExtents_m());
  return posed.ahead.deformedFromShape(x.cwiseProduct(posed.ahead.halfExtents_m())) -
         posed.behind.deformedFromShape(x.cwiseProduct(posed.behind.halfExtents_m()));
}

Vec3 PosedFlesh::materialFromWorld(SolidId solid, const Vec3& world) const {
  const Posed& posed = posed_[solid.index()];
  const Vec3 local = posed.world.inverse().point(world);
  if (posed.stretched) return local.cwiseQuotient(posed.stretch);
  return posed.rest->localFromMaterial(posed.solid.materialFromLocal(local));
}

Vec3 PosedFlesh::worldFromMaterial(SolidId solid, const Vec3& material) const {
  const Posed& posed = posed_[solid.index()];
  if (posed.stretched) return posed.world.point(material.cwiseProduct(posed.stretch));
  const Vec3 matter = posed.rest->materialFromLocal(material);
  return posed.world.point(posed.solid.localFromMaterial(matter));
}

void PosedFlesh::worldFromMaterials(SolidId solid, ConstVectors materials, Vectors world) const {
  const Posed& posed = posed_[solid.index()];
  if (!posed.stretched) return Field::worldFromMaterials(solid, materials, world);
  affinePoints(posed.world.rotation * posed.stretch.asDiagonal(), Vec3::Zero(),
               posed.world.translation_m, materials, world);
}

void Flesh::prepare(PosedFlesh& out) const {
  if (out.source_ == bound_) return;
  out.posed_.assign(solids_.size(), {});
  for (std::size_t i = 0; i < solids_.size(); ++i) {
    PosedFlesh::Posed& posed = out.posed_[i];
    posed.rest = &bound_->rest[i];
    posed.solid = *posed.rest;
    posed.parameters.resize(posed.solid.parameterCount());
    posed.values.resize(posed.solid.parameterCount());
    PosedFlesh::reset(posed);
  }
  out.source_ = bound_;
}

void Flesh::pose(const Posture& posture, const PosedSkeleton& skeleton,
                 std::span<const ParameterOverride> overrides, PosedFlesh& out) const {
  prepare(out);
  for (std::size_t i = 0; i < solids_.size(); ++i) {
    const Entry& entry = solids_[i];
    PosedFlesh::Posed& posed = out.posed_[i];
    const std::size_t joint = entry.joint.index();
    const Twist& carried = skeleton.twist_world[joint];
    posed.world = skeleton.joint_world[joint] * entry.inJoint;
    posed.twist = {carried.at(posed.world.translation_m), carried.angular_rad_per_s,
                   posed.world.translation_m};
    if (posed.written) PosedFlesh::reset(posed);
    for (std::size_t k = entry.firstDriver; k < entry.firstDriver + entry.driverCount; ++k) {
      const Driver& driver = bound_->drivers[k];
      const auto value = static_cast<std::size_t>(driver.value);
      const DriverCurve::Sample sample = driver.curve.at(posture.values[value]);
      PosedFlesh::write(posed, driver.parameter, sample.parameter,
                        sample.slope * posture.rates[value]);
    }
  }
  for (const ParameterOverride& o : overrides) {
    PosedFlesh::Posed& posed = out.posed_[o.solid.index()];
    if (o.weight == 1 && o.weightRate_per_s == 0) {
      PosedFlesh::write(posed, o.parameter, o.value, o.rate);
      continue;
    }
    const auto [value, rate] = posed.parameters[static_cast<std::size_t>(o.parameter)];
    PosedFlesh::write(posed, o.parameter, value + o.weight * (o.value - value),
                      rate + o.weight * (o.rate - rate) + o.weightRate_per_s * (o.value - value));
  }
  for (PosedFlesh::Posed& posed : out.posed_) PosedFlesh::finish(posed);
}

}  // namespace fascia
