#include <utility>

#include <fascia/base/error.h>
#include <fascia/base/suggest.h>
#include <fascia/deformable/puppet/puppet.h>

namespace fascia {
namespace {

class WaitFor final : public Behaviour {
 public:
  WaitFor(Predicate predicate, std::optional<double> timeout_s)
      : predicate_(std::move(predicate)), timeout_s_(timeout_s) {}
  Progress update(Puppet& puppet, double h_s) override {
    if (predicate_(puppet)) return Progress::done;
    if (!timeout_s_) return Progress::running;
    if (!end_s_) end_s_ = puppet.time_s() + *timeout_s_;
    return stepsUntil(*end_s_, puppet.time_s(), h_s) == 0 ? Progress::failed : Progress::running;
  }

 private:
  Predicate predicate_;
  std::optional<double> timeout_s_, end_s_;
};

}  // namespace

BehaviourPtr makeWaitFor(Predicate predicate, std::optional<double> timeout_s) {
  if (!predicate) throw Error("wait for: found no predicate, expected one");
  if (timeout_s && !(*timeout_s >= 0))
    throw Error("wait for: timeout_s: found " + shortNumber(*timeout_s) +
                ", expected a number that is not negative");
  return std::make_unique<WaitFor>(std::move(predicate), timeout_s);
}

}  // namespace fascia
