#include <algorithm>
#include <cmath>
#include <utility>

#include <fascia/base/error.h>
#include <fascia/base/suggest.h>
#include <fascia/deformable/puppet/puppet.h>

namespace fascia {
namespace {

class Chase final : public Behaviour {
 public:
  Chase(PuppetPointId point, const Target& target, const ChaseOptions& options)
      : point_(point), target_(target), options_(options) {}

  void check(const Puppet& puppet) const override {
    puppet.bodyPoint(point_);
    puppet.checkTarget(target_);
  }

  Progress update(Puppet& puppet, double h_s) override {
    const double now_s = puppet.time_s();
    PathPoint from{puppet.position_m(point_), puppet.velocity_m_per_s(point_), Vec3::Zero()};
    int steps = 1;
    if (control_.valid()) {
      if (!puppet.leads(control_)) return Progress::failed;
      steps = stepsUntil(end_s_, now_s, h_s);
      if (steps == 0) return arrive(puppet);
      // From the last plan, not from the state: steps of first order lag behind in velocity.
      from = segment_->at(now_s);
    } else {
      end_s_ = now_s + options_.duration_s;
      steps = std::max(1, stepsUntil(end_s_, now_s, h_s));
    }
    plan(puppet, from, steps * h_s);
    if (!control_.valid())
      control_ = puppet.lead(point_, [way = segment_](double t_s) { return way->at(t_s); });
    return Progress::running;
  }

  void cancel(Puppet& puppet) override { puppet.letGo(control_); }

 private:
  void plan(const Puppet& puppet, const PathPoint& from, double left_s) {
    const Vec3 target = puppet.position_m(target_), drift = puppet.velocity_m_per_s(target_);
    const Vec3 relative = from.velocity_m_per_s - drift;
    const Vec3 final = options_.finalVelocity_m_per_s.value_or(
        drift + 1.5 / left_s * (target - from.position_m) - 0.5 * relative);
    const double now_s = puppet.time_s();
    *segment_ = CubicSegment(now_s, from.position_m, from.velocity_m_per_s, now_s + left_s,
                             target + left_s * drift, final);
  }

  Progress arrive(Puppet& puppet) {
    // Steps leave the mean velocity of the last one; the one planned is wanted.
    puppet.matchVelocities();
    if (!options_.keepControl) puppet.letGo(control_);
    return Progress::done;
  }

  PuppetPointId point_;
  Target target_;
  ChaseOptions options_;
  ConstraintId control_;
  double end_s_ = 0;
  std::shared_ptr<CubicSegment> segment_ = std::make_shared<CubicSegment>();
};

void checkOptions(const ChaseOptions& options) {
  constexpr double kLongest_s = 1e6;
  if (!(options.duration_s > 0 && options.duration_s <= kLongest_s))
    throw Error(std::string("chase: duration_s: found ") + shortNumber(options.duration_s) +
                ", expected a number in (0, 1e6]");
  if (options.finalVelocity_m_per_s && !options.finalVelocity_m_per_s->allFinite())
    throw Error("chase: final velocity: found a number that is not finite");
}

}  // namespace

int stepsUntil(double end_s, double now_s, double h_s) {
  constexpr double kRounding = 1e-6;  // of a step
  return static_cast<int>(std::clamp(std::ceil((end_s - now_s) / h_s - kRounding), 0.0, 1e9));
}

BehaviourPtr makeChase(PuppetPointId point, const Target& target, const ChaseOptions& options) {
  checkOptions(options);
  return std::make_unique<Chase>(point, target, options);
}

}  // namespace fascia
