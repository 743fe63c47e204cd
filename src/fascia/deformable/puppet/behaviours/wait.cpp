#include <optional>

#include <fascia/base/error.h>
#include <fascia/base/suggest.h>
#include <fascia/deformable/puppet/puppet.h>

namespace fascia {
namespace {

class Wait final : public Behaviour {
 public:
  explicit Wait(double duration_s) : duration_s_(duration_s) {}
  Progress update(Puppet& puppet, double h_s) override {
    if (!end_s_) end_s_ = puppet.time_s() + duration_s_;
    return stepsUntil(*end_s_, puppet.time_s(), h_s) == 0 ? Progress::done : Progress::running;
  }

 private:
  double duration_s_;
  std::optional<double> end_s_;
};

}  // namespace

BehaviourPtr makeWait(double duration_s) {
  constexpr double kLongest_s = 1e9;
  if (!(duration_s >= 0 && duration_s <= kLongest_s))
    throw Error("wait: found " + shortNumber(duration_s) + " s, expected a number in [0, 1e9]");
  return std::make_unique<Wait>(duration_s);
}

}  // namespace fascia
