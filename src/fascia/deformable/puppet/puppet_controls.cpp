#include <algorithm>
#include <cmath>
#include <utility>

#include <fascia/base/error.h>
#include <fascia/base/suggest.h>
#include <fascia/deformable/constraint/closing_attachment.h>
#include <fascia/deformable/contact/body_contact.h>
#include <fascia/deformable/puppet/puppet.h>

// What acts on the points of a puppet.

namespace fascia {
namespace {

// Nearer than any picture shows: no gap to close.
constexpr double kTogether_m = 1e-12;

void checkFinite(const char* what, const Vec3& v) {
  if (!v.allFinite())
    throw Error("puppet: " + std::string(what) + ": found a number that is not finite");
}

}  // namespace

ConstraintId Puppet::lead(PuppetPointId point, PointPath path) {
  const BodyPoint& on = bodyPoint(point);
  const ConstraintPtr constraint = makeTrajectory("control of " + name(point), on, path);
  endControl(point);
  controls_.push_back({point, system_.hold(constraint), std::move(path), {}});
  return controls_.back().constraint;
}

void Puppet::letGo(ConstraintId control) {
  if (std::erase_if(controls_, [&](const Control& c) { return c.constraint == control; }) > 0)
    system_.release(control);
}

void Puppet::endControl(PuppetPointId point) {
  std::erase_if(controls_, [&](const Control& control) {
    if (!samePoint(control.point, point)) return false;
    system_.release(control.constraint);
    return true;
  });
}

bool Puppet::controlled(PuppetPointId point) const {
  return std::ranges::any_of(
      controls_, [&](const Control& control) { return samePoint(control.point, point); });
}

void Puppet::hold(PuppetPointId point) {
  bodyPoint(point);
  lead(point, fixedAt(position_m(point)));
  matchVelocities();
}

void Puppet::release(PuppetPointId point) {
  bodyPoint(point);
  endControl(point);
  endPull(point);
  std::erase_if(connections_, [&](const Connection& connection) {
    if (!samePoint(connection.a, point) && !samePoint(connection.b, point)) return false;
    system_.release(connection.constraint);
    return true;
  });
}

void Puppet::connect(PuppetPointId point, const Target& target) {
  const BodyPoint& on = bodyPoint(point);
  checkTarget(target);
  const Vec3 apart_m = position_m(point) - position_m(target);
  const double now = time_s();
  const bool together = apart_m.norm() <= kTogether_m;
  const CubicSegment gap(now, apart_m, Vec3::Zero(), now + kClosing_s, Vec3::Zero(), Vec3::Zero());
  if (const BodyPoint* other = bodyPointOf(target)) {
    const PuppetPointId b = std::get<PuppetPointId>(target);
    if (samePoint(point, b)) throw Error(quotedName(name(b)) + " cannot be connected to itself");
    if (connected(point, b)) return;
    const std::string title = name(point) + " at " + name(b);
    connections_.push_back(
        {point, b,
         system_.hold(together ? makeAttachment(title, on, *other)
                               : makeClosingAttachment(title, on, *other, gap))});
  } else {
    lead(point, together ? pathOf(target) : pathBeside(pathOf(target), gap));
    if (const auto* place = std::get_if<PuppetPointId>(&target)) controls_.back().place = *place;
  }
  matchVelocities();
}

void Puppet::disconnect(PuppetPointId a, PuppetPointId b) {
  std::erase_if(connections_, [&](const Connection& connection) {
    const bool meant = (samePoint(connection.a, a) && samePoint(connection.b, b)) ||
                       (samePoint(connection.a, b) && samePoint(connection.b, a));
    if (meant) system_.release(connection.constraint);
    return meant;
  });
}

bool Puppet::connected(PuppetPointId a, PuppetPointId b) const {
  const bool tied = std::ranges::any_of(connections_, [&](const Connection& connection) {
    return (samePoint(connection.a, a) && samePoint(connection.b, b)) ||
           (samePoint(connection.a, b) && samePoint(connection.b, a));
  });
  return tied || std::ranges::any_of(controls_, [&](const Control& control) {
           return (samePoint(control.point, a) && control.place == b) ||
                  (samePoint(control.point, b) && control.place == a);
         });
}

ConstraintPtr Puppet::makeSpring(const Pull& pull) const {
  const std::string title = "pull of " + name(pull.point) + " to " + nameOf(pull.target);
  const BodyPoint& on = bodyPoint(pull.point);
  if (const BodyPoint* other = bodyPointOf(pull.target)) return makeAttachment(title, on, *other);
  if (!pull.place_m) return makeTrajectory(title, on, pathOf(pull.target));
  return makeTrajectory(
      title, on, [place_m = pull.place_m](double) { return PathPoint{.position_m = *place_m}; });
}

void Puppet::pull(PuppetPointId point, const Target& target, double stiffness_N_per_m,
                  double damping_Ns_per_m) {
  bodyPoint(point);
  checkTarget(target);
  const auto* place = std::get_if<Vec3>(&target);
  for (Pull& pull : pulls_) {
    const bool same = pull.point == point && place && pull.place_m &&
                      pull.stiffness_N_per_m == stiffness_N_per_m &&
                      pull.damping_Ns_per_m == damping_Ns_per_m;
    if (same) return void(*pull.place_m = *place);
  }
  Pull pull{point,
            target,
            stiffness_N_per_m,
            damping_Ns_per_m,
            place ? std::make_shared<Vec3>(*place) : nullptr,
            {}};
  if (bodyPointOf(target) && samePoint(point, std::get<PuppetPointId>(target)))
    throw Error(quotedName(name(point)) + " cannot be pulled to itself");
  pull.constraint = system_.pull({makeSpring(pull), stiffness_N_per_m, damping_Ns_per_m});
  endPull(point);
  pulls_.push_back(std::move(pull));
}

void Puppet::endPull(PuppetPointId point) {
  std::erase_if(pulls_, [&](const Pull& pull) {
    if (!samePoint(pull.point, point)) return false;
    system_.release(pull.constraint);
    return true;
  });
}

void Puppet::impulse(PuppetPointId point, const Vec3& impulse_Ns) {
  checkFinite("impulse", impulse_Ns);
  system_.applyImpulse(bodyPoint(point), impulse_Ns, state_);
}

// Of all that the body touches, itself included.
BodyId Puppet::squeezedBy(BodyId led) const {
  const BodyModel& model = system_.model();
  const auto squeezed = [&](BodyId body) {
    return model.shape(body).leastGrowth(model.part(body, std::span<const double>(state_.r))) <
           kLeastGrowth;
  };
  const ContactSet& set = std::as_const(*system_.contacts()).contacts();
  for (std::size_t i = 0; i < set.size(); ++i) {
    const bool pair = set[i].b.count > 0;
    if (set.load_N(i) == 0 || (set[i].a.body != led && !(pair && set[i].b.body == led))) continue;
    if (squeezed(set[i].a.body)) return set[i].a.body;
    if (pair && squeezed(set[i].b.body)) return set[i].b.body;
  }
  return {};
}

void Puppet::stopSqueezing() {
  constexpr double kStill_m_per_s = 1e-6;
  if (!system_.contacts()) return;
  std::erase_if(controls_, [&](const Control& control) {
    if (control.path(state_.t_s).velocity_m_per_s.norm() < kStill_m_per_s) return false;
    const BodyId squeezed = squeezedBy(bodyPoint(control.point).body);
    if (!squeezed.valid()) return false;
    system_.release(control.constraint);
    letGos_.push_back({state_.t_s, control.point, squeezed});
    return true;
  });
}

// By a control of a moment's duration: the impulse is the smallest that all constraints allow.
void Puppet::setVelocity(PuppetPointId point, const Vec3& velocity_m_per_s) {
  checkFinite("velocity", velocity_m_per_s);
  const PathPoint moment{.position_m = position_m(point), .velocity_m_per_s = velocity_m_per_s};
  const ConstraintId control = lead(point, [moment](double) { return moment; });
  matchVelocities();
  letGo(control);
}

void Puppet::matchVelocities() {
  system_.matchVelocities(state_);
}

void Puppet::push(PuppetPointId point, const Vec3& force_N, double duration_s) {
  checkFinite("force", force_N);
  if (!(duration_s >= 0 && std::isfinite(duration_s)))
    throw Error("puppet: push: found the duration " + shortNumber(duration_s) +
                ", expected seconds");
  pushes_.push_back({bodyPoint(point), force_N, duration_s, {}});
}

void Puppet::updatePushes(double h_s) {
  constexpr double kOver = 1e-9;  // of a step: rounding
  std::erase_if(pushes_, [&](const Push& push) {
    if (push.left_s > kOver * h_s) return false;
    system_.removePointForce(push.force);
    return true;
  });
  for (Push& push : pushes_) {
    const double part = std::min(1.0, push.left_s / h_s);
    if (!push.force.valid() || part < 1) {
      system_.removePointForce(push.force);
      push.force = system_.addPointForce(push.point, part * push.force_N);
    }
    push.left_s -= h_s;
  }
}

}  // namespace fascia
