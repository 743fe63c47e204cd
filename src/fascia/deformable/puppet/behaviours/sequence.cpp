#include <utility>

#include <fascia/deformable/puppet/behaviour.h>

namespace fascia {
namespace {

class Sequence final : public Behaviour {
 public:
  explicit Sequence(std::vector<BehaviourPtr> parts) : parts_(std::move(parts)) {}
  void check(const Puppet& puppet) const override {
    for (const BehaviourPtr& part : parts_) part->check(puppet);
  }
  Progress update(Puppet& puppet, double h_s) override {
    for (; current_ < parts_.size(); ++current_) {
      const Progress progress = parts_[current_]->update(puppet, h_s);
      if (progress != Progress::done) return progress;
    }
    return Progress::done;
  }
  void cancel(Puppet& puppet) override {
    if (current_ < parts_.size()) parts_[current_]->cancel(puppet);
  }

 private:
  std::vector<BehaviourPtr> parts_;
  std::size_t current_ = 0;
};

}  // namespace

BehaviourPtr makeSequence(std::vector<BehaviourPtr> behaviours) {
  return std::make_unique<Sequence>(std::move(behaviours));
}

}  // namespace fascia
