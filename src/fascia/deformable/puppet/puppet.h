#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <fascia/deformable/puppet/behaviour.h>
#include <fascia/deformable/puppet/keyframed_path.h>
#include <fascia/deformable/solve/body_system.h>

namespace fascia {

// A name for a point of a body, a fixed place, or a place that moves by itself.
struct NamedPoint {
  std::string name;
  std::variant<BodyPoint, Vec3, PointPath> place;
};

// Strings for the bodies of a system (Witkin & Welch 1990, §4): named points that are led, held,
// tied, pulled, pushed and let go while the caller takes the system through time,
//
//     puppet.update(h);   stepper.step(h, state);
//
// and behaviours that do so by themselves. What a point is led by is its control; a newer one
// replaces the older. In two dimensions z is ignored. The system and the state belong to the
// caller, who may step them by any method and change them between steps.
//
// Functions throw Error for what makes no sense (leading a fixed place, a duration below 0);
// update() does not.
class Puppet {
 public:
  // Throws Error unless every point has a name of its own and a body that exists.
  Puppet(BodySystem& system, OdeState& state, std::vector<NamedPoint> points);
  Puppet(const Puppet&) = delete;
  Puppet& operator=(const Puppet&) = delete;
  ~Puppet();

  // Throws Error that suggests the nearest name.
  PuppetPointId find(std::string_view name) const;
  std::size_t pointCount() const { return points_.size(); }
  const std::string& name(PuppetPointId point) const { return points_[point.index()].name; }

  const BodySystem& system() const { return system_; }
  double time_s() const { return state_.t_s; }
  Vec3 gravity_m_per_s2() const;
  Vec3 position_m(const Target& target) const;
  Vec3 velocity_m_per_s(const Target& target) const;
  double distance_m(const Target& a, const Target& b) const;

  // Control of a point of a body: it follows `path`, which should start at the point's place and
  // velocity. The path is called in every step, so what it reads may change between steps.
  ConstraintId lead(PuppetPointId point, PointPath path);
  bool leads(ConstraintId control) const { return system_.holds(control); }
  void letGo(ConstraintId control);
  void hold(PuppetPointId point);     // where it is; stops it by an impulse
  void release(PuppetPointId point);  // from control, connections and pull: it flies on
  bool controlled(PuppetPointId point) const;

  // Ties a point of a body to another one, or to a place, which is a control then: an impulse
  // makes their velocities one (§3.2), and what distance there is closes within kClosing_s.
  void connect(PuppetPointId point, const Target& target);
  void disconnect(PuppetPointId a, PuppetPointId b);
  bool connected(PuppetPointId a, PuppetPointId b) const;  // also to a place, which may be either
  std::size_t connectionCount() const { return connections_.size(); }
  static constexpr double kClosing_s = 0.1;

  // A damped spring from a point to a target; again for the same point moves or changes it.
  // Moving a place costs nothing, so that it may follow a hand from frame to frame.
  void pull(PuppetPointId point, const Target& target, double stiffness_N_per_m,
            double damping_Ns_per_m);
  void endPull(PuppetPointId point);

  // Impulses act at once, and on whatever is connected.
  void impulse(PuppetPointId point, const Vec3& impulse_Ns);
  void setVelocity(PuppetPointId point, const Vec3& velocity_m_per_s);  // and ends its control
  void stop(PuppetPointId point) { setVelocity(point, Vec3::Zero()); }
  // Makes all velocities agree with all controls: for a start, and when a path's velocity jumps.
  void matchVelocities();
  // A force for a time. What does not fill a step is scaled down to give the same impulse.
  void push(PuppetPointId point, const Vec3& force_N, double duration_s);
  std::size_t pushCount() const { return pushes_.size(); }

  // Throws Error if the puppet lacks what the behaviour needs. It acts from the next update() on.
  BehaviourId run(BehaviourPtr behaviour);
  bool running(BehaviourId behaviour) const;
  void cancel(BehaviourId behaviour);

  // A control that moves lets go of its point rather than squeeze a body flat: the one it leads,
  // against something, or one that stands in the way (what is left of either is below kLeastGrowth
  // somewhere). Whose point, when, and whom it squeezed; in the order of time.
  struct LetGo {
    double time_s;
    PuppetPointId point;
    BodyId squeezed;
  };
  std::span<const LetGo> letGos() const { return letGos_; }
  static constexpr double kLeastGrowth = 0.1;

  // Before every step, from time_s() to time_s() + h_s, h_s > 0.
  void update(double h_s);

  // Throw Error if `point` is not a point of a body, or `target` neither a point nor a place.
  const BodyPoint& bodyPoint(PuppetPointId point) const;
  void checkTarget(const Target& target) const;
  bool samePoint(PuppetPointId a, PuppetPointId b) const;  // maybe by two names

 private:
  struct Control {
    PuppetPointId point;
    ConstraintId constraint;
    PointPath path;
    PuppetPointId place;  // that the point is connected to; invalid: it is led otherwise
  };
  struct Connection {
    PuppetPointId a, b;
    ConstraintId constraint;
  };
  struct Pull {
    PuppetPointId point;
    Target target;
    double stiffness_N_per_m, damping_Ns_per_m;
    std::shared_ptr<Vec3> place_m;  // read by the constraint, if the target is a place
    ConstraintId constraint;
  };
  struct Push {
    BodyPoint point;
    Vec3 force_N;
    double left_s;
    PointForceId force;
  };
  struct Running {
    BehaviourId id;
    BehaviourPtr behaviour;
    bool done = false;
  };

  void addPoint(const NamedPoint& point);
  const BodyPoint* bodyPointOf(const Target& target) const;
  PointPath pathOf(const Target& target) const;  // of a place
  std::string nameOf(const Target& target) const;
  void endControl(PuppetPointId point);
  ConstraintPtr makeSpring(const Pull& pull) const;
  void updatePushes(double h_s);
  void stopSqueezing();
  BodyId squeezedBy(BodyId led) const;  // invalid: none

  BodySystem& system_;
  OdeState& state_;
  std::vector<NamedPoint> points_;
  std::map<std::string, PuppetPointId, std::less<>> names_;
  std::vector<Control> controls_;
  std::vector<Connection> connections_;
  std::vector<Pull> pulls_;
  std::vector<Push> pushes_;
  std::vector<LetGo> letGos_;
  std::vector<Running> running_;
  int nextBehaviour_ = 0;
};

}  // namespace fascia
