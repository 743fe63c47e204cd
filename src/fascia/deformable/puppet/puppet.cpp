#include <fascia/deformable/puppet/puppet.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <fascia/base/error.h>
#include <fascia/base/suggest.h>

// Names, places and time. What acts on points is in puppet_controls.cpp.

namespace fascia {
namespace {

Vec3 inSpaceOf(const BodySystem& system, const Vec3& v) {
  return system.model().dimension() == 3 ? v : Vec3(v.x(), v.y(), 0);
}

}  // namespace

Puppet::Puppet(BodySystem& system, OdeState& state, std::vector<NamedPoint> points)
    : system_(system), state_(state) {
  for (const NamedPoint& point : points) addPoint(point);
}

Puppet::~Puppet() = default;

void Puppet::addPoint(const NamedPoint& point) {
  const std::string which = "puppet: point " + quotedName(point.name) + ": ";
  if (point.name.empty()) throw Error("puppet: found a point without a name, expected one");
  if (names_.contains(point.name)) throw Error(which + "found the name twice, expected it once");
  if (const auto* on = std::get_if<BodyPoint>(&point.place)) {
    if (!system_.model().contains(on->body) || !on->X_m.allFinite())
      throw Error(which + "found a point of no body, expected one of the system's " +
                  std::to_string(system_.model().bodyCount()) + " bodies");
  } else if (const auto* place = std::get_if<Vec3>(&point.place)) {
    if (!place->allFinite()) throw Error(which + "found a number that is no place");
  } else if (!std::get<PointPath>(point.place)) {
    throw Error(which + "found no path, expected one");
  }
  names_.emplace(point.name, PuppetPointId(static_cast<std::int64_t>(points_.size())));
  points_.push_back(point);
}

PuppetPointId Puppet::find(std::string_view name) const {
  const auto found = names_.find(name);
  if (found != names_.end()) return found->second;
  NearestName nearest(name);
  for (const auto& [known, id] : names_) nearest.offer(known);
  Issue issue{{}, "no point is named " + quotedName(name), nearest.hint()};
  throw Error(issue);
}

const BodyPoint& Puppet::bodyPoint(PuppetPointId point) const {
  if (!point.valid() || point.index() >= points_.size())
    throw Error("puppet: found the number of no point");
  if (const auto* on = std::get_if<BodyPoint>(&points_[point.index()].place)) return *on;
  Issue issue{{},
              quotedName(name(point)) + " is a place, expected a point of a body",
              "only points of bodies can be led, held or pushed"};
  throw Error(issue);
}

void Puppet::checkTarget(const Target& target) const {
  if (const auto* place = std::get_if<Vec3>(&target)) {
    if (!place->allFinite()) throw Error("puppet: found a place that is not finite");
  } else if (const PuppetPointId point = std::get<PuppetPointId>(target);
             !point.valid() || point.index() >= points_.size()) {
    throw Error("puppet: found the number of no point");
  }
}

const BodyPoint* Puppet::bodyPointOf(const Target& target) const {
  const auto* point = std::get_if<PuppetPointId>(&target);
  return point ? std::get_if<BodyPoint>(&points_[point->index()].place) : nullptr;
}

bool Puppet::samePoint(PuppetPointId a, PuppetPointId b) const {
  if (a == b) return true;
  const BodyPoint *onA = bodyPointOf(a), *onB = bodyPointOf(b);
  return onA && onB && onA->body == onB->body && onA->X_m == onB->X_m;
}

PointPath Puppet::pathOf(const Target& target) const {
  if (const auto* point = std::get_if<PuppetPointId>(&target)) {
    if (const auto* path = std::get_if<PointPath>(&points_[point->index()].place)) return *path;
  }
  return [place_m = position_m(target)](double) { return PathPoint{.position_m = place_m}; };
}

std::string Puppet::nameOf(const Target& target) const {
  const auto* point = std::get_if<PuppetPointId>(&target);
  return point ? name(*point) : "a place";
}

Vec3 Puppet::gravity_m_per_s2() const {
  Vec3 gravity = system_.settings().gravity_m_per_s2;
  if (system_.model().dimension() == 2) gravity.z() = 0;
  return gravity;
}

Vec3 Puppet::position_m(const Target& target) const {
  if (const auto* place = std::get_if<Vec3>(&target)) return inSpaceOf(system_, *place);
  if (const BodyPoint* on = bodyPointOf(target)) return system_.model().point(state_.r, *on);
  const NamedPoint& point = points_[std::get<PuppetPointId>(target).index()];
  if (const auto* place = std::get_if<Vec3>(&point.place)) return inSpaceOf(system_, *place);
  return inSpaceOf(system_, std::get<PointPath>(point.place)(state_.t_s).position_m);
}

Vec3 Puppet::velocity_m_per_s(const Target& target) const {
  if (std::holds_alternative<Vec3>(target)) return Vec3::Zero();
  // x = q s(X), so ẋ = q̇ s(X).
  if (const BodyPoint* on = bodyPointOf(target)) return system_.model().point(state_.v, *on);
  const NamedPoint& point = points_[std::get<PuppetPointId>(target).index()];
  if (std::holds_alternative<Vec3>(point.place)) return Vec3::Zero();
  return inSpaceOf(system_, std::get<PointPath>(point.place)(state_.t_s).velocity_m_per_s);
}

double Puppet::distance_m(const Target& a, const Target& b) const {
  return (position_m(a) - position_m(b)).norm();
}

BehaviourId Puppet::run(BehaviourPtr behaviour) {
  behaviour->check(*this);
  running_.push_back({BehaviourId(nextBehaviour_++), std::move(behaviour)});
  return running_.back().id;
}

bool Puppet::running(BehaviourId id) const {
  return std::ranges::any_of(
      running_, [&](const Running& running) { return running.id == id && !running.done; });
}

// The behaviour itself stays until the next update(): it may be the one that asks.
void Puppet::cancel(BehaviourId id) {
  for (Running& running : running_) {
    if (running.id != id || running.done) continue;
    running.done = true;
    running.behaviour->cancel(*this);
    return;
  }
}

void Puppet::update(double h_s) {
  stopSqueezing();
  // A behaviour may run others, which makes the list grow.
  for (std::size_t i = 0; i < running_.size(); ++i) {
    if (running_[i].done) continue;
    Behaviour& behaviour = *running_[i].behaviour;
    const Progress progress = behaviour.update(*this, h_s);
    if (progress != Progress::running) running_[i].done = true;
  }
  std::erase_if(running_, [](const Running& running) { return running.done; });
  updatePushes(h_s);
}

}  // namespace fascia
