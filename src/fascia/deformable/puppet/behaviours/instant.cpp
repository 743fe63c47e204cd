#include <utility>

#include <fascia/deformable/puppet/puppet.h>

// Behaviours of one point that take no time.

namespace fascia {
namespace {

class Instant final : public Behaviour {
 public:
  Instant(PuppetPointId point, std::function<void(Puppet&)> act)
      : point_(point), act_(std::move(act)) {}
  void check(const Puppet& puppet) const override { puppet.bodyPoint(point_); }
  Progress update(Puppet& puppet, double) override {
    act_(puppet);
    return Progress::done;
  }

 private:
  PuppetPointId point_;
  std::function<void(Puppet&)> act_;
};

}  // namespace

BehaviourPtr makeHold(PuppetPointId point) {
  return std::make_unique<Instant>(point, [=](Puppet& puppet) { puppet.hold(point); });
}

BehaviourPtr makeRelease(PuppetPointId point) {
  return std::make_unique<Instant>(point, [=](Puppet& puppet) { puppet.release(point); });
}

BehaviourPtr makeStop(PuppetPointId point) {
  return std::make_unique<Instant>(point, [=](Puppet& puppet) { puppet.stop(point); });
}

}  // namespace fascia
