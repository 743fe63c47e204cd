#include <fascia/base/error.h>
#include <fascia/base/suggest.h>
#include <fascia/deformable/puppet/puppet.h>

namespace fascia {
namespace {

class Connect final : public Behaviour {
 public:
  Connect(PuppetPointId point, const Target& target) : point_(point), target_(target) {}
  void check(const Puppet& puppet) const override {
    puppet.bodyPoint(point_);
    puppet.checkTarget(target_);
    const auto* other = std::get_if<PuppetPointId>(&target_);
    if (other && puppet.samePoint(point_, *other))
      throw Error(quotedName(puppet.name(point_)) + " cannot be connected to itself");
  }
  Progress update(Puppet& puppet, double) override {
    puppet.connect(point_, target_);
    return Progress::done;
  }

 private:
  PuppetPointId point_;
  Target target_;
};

}  // namespace

BehaviourPtr makeConnect(PuppetPointId point, const Target& target) {
  return std::make_unique<Connect>(point, target);
}

}  // namespace fascia
