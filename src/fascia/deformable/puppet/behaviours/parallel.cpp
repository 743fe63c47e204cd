#include <utility>

#include <fascia/deformable/puppet/behaviour.h>

namespace fascia {
namespace {

class Parallel final : public Behaviour {
 public:
  explicit Parallel(std::vector<BehaviourPtr> parts)
      : parts_(std::move(parts)), progress_(parts_.size(), Progress::running) {}
  void check(const Puppet& puppet) const override {
    for (const BehaviourPtr& part : parts_) part->check(puppet);
  }
  Progress update(Puppet& puppet, double h_s) override {
    Progress all = Progress::done;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (progress_[i] == Progress::running) progress_[i] = parts_[i]->update(puppet, h_s);
      if (progress_[i] == Progress::running) all = Progress::running;
      if (progress_[i] == Progress::failed && all == Progress::done) all = Progress::failed;
    }
    return all;
  }
  void cancel(Puppet& puppet) override {
    for (std::size_t i = 0; i < parts_.size(); ++i)
      if (progress_[i] == Progress::running) parts_[i]->cancel(puppet);
  }

 private:
  std::vector<BehaviourPtr> parts_;
  std::vector<Progress> progress_;
};

}  // namespace

BehaviourPtr makeParallel(std::vector<BehaviourPtr> behaviours) {
  return std::make_unique<Parallel>(std::move(behaviours));
}

}  // namespace fascia
