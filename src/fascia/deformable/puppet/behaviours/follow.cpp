#include <cmath>
#include <memory>
#include <utility>

#include <fascia/base/error.h>
#include <fascia/base/suggest.h>
#include <fascia/deformable/constraint/closing_attachment.h>
#include <fascia/deformable/puppet/puppet.h>

namespace fascia {
namespace {

// What the control reads: the preroll until the onset, then the keys. A path that is joined without
// preroll has a gap beside it, which closes.
struct Course {
  explicit Course(KeyframedPath path) : keys(std::move(path)) {}

  PathPoint at(double t_s) const {
    if (prerolls && t_s < onset_s) return preroll.at(t_s);
    return keys.at(t_s - onset_s + keys.start_s());
  }

  KeyframedPath keys;
  CubicSegment preroll;
  double onset_s = 0;
  bool prerolls = false;
};

class Follow final : public Behaviour {
 public:
  Follow(PuppetPointId point, KeyframedPath path, const FollowOptions& options)
      : point_(point), options_(options), course_(std::make_shared<Course>(std::move(path))) {}

  void check(const Puppet& puppet) const override { puppet.bodyPoint(point_); }

  Progress update(Puppet& puppet, double h_s) override {
    const double now_s = puppet.time_s();
    if (!scheduled_) schedule(now_s);
    if (!control_.valid()) {
      if (stepsUntil(course_->onset_s - options_.preroll_s, now_s, h_s) > 0)
        return Progress::running;
      begin(puppet, h_s);
    } else if (!puppet.leads(control_)) {
      return Progress::failed;
    }
    const double path_s = now_s - course_->onset_s + course_->keys.start_s(),
                 rounding_s = 1e-6 * h_s;
    if (course_->keys.jumpsWithin(checked_s_, path_s + rounding_s)) puppet.matchVelocities();
    checked_s_ = path_s + rounding_s;
    return path_s + rounding_s < course_->keys.end_s() ? Progress::running : finish(puppet);
  }

  void cancel(Puppet& puppet) override { puppet.letGo(control_); }

 private:
  void schedule(double now_s) {
    course_->onset_s = options_.onset_s.value_or(now_s + options_.preroll_s);
    scheduled_ = true;
  }

  void begin(Puppet& puppet, double h_s) {
    const double now_s = puppet.time_s();
    const PathKey& first = course_->keys.keys().front();
    const Vec3 place = puppet.position_m(point_);
    checked_s_ = course_->keys.start_s() - 1;
    course_->prerolls = stepsUntil(course_->onset_s, now_s, h_s) > 0;
    if (course_->prerolls) {
      course_->preroll =
          CubicSegment(now_s, place, puppet.velocity_m_per_s(point_), course_->onset_s,
                       first.position_m, *first.velocityIn_m_per_s);
      control_ = puppet.lead(point_, [course = course_](double t_s) { return course->at(t_s); });
      return;
    }
    const CubicSegment gap(now_s, place - course_->at(now_s).position_m, Vec3::Zero(),
                           now_s + Puppet::kClosing_s, Vec3::Zero(), Vec3::Zero());
    control_ = puppet.lead(
        point_, pathBeside([course = course_](double t_s) { return course->at(t_s); }, gap));
    puppet.matchVelocities();
  }

  Progress finish(Puppet& puppet) {
    puppet.matchVelocities();
    const bool rests = course_->keys.keys().back().velocityOut_m_per_s->isZero(0);
    if (!rests) puppet.letGo(control_);
    return Progress::done;
  }

  PuppetPointId point_;
  FollowOptions options_;
  std::shared_ptr<Course> course_;
  ConstraintId control_;
  bool scheduled_ = false;
  double checked_s_ = 0;  // in the path's time: jumps until here are done
};

}  // namespace

BehaviourPtr makeFollow(PuppetPointId point, KeyframedPath path, const FollowOptions& options) {
  constexpr double kLongest_s = 1e6;
  if (!(options.preroll_s >= 0 && options.preroll_s <= kLongest_s))
    throw Error("follow: preroll_s: found " + shortNumber(options.preroll_s) +
                ", expected a number in [0, 1e6]");
  if (options.onset_s && !std::isfinite(*options.onset_s))
    throw Error("follow: onset_s: found a number that is not finite");
  return std::make_unique<Follow>(point, std::move(path), options);
}

}  // namespace fascia
