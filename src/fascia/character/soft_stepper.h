#pragma once

#include <functional>
#include <memory>
#include <vector>

#include <fascia/character/soft_flesh.h>
#include <fascia/deformable/solve/body_stepper.h>

namespace fascia {

// Takes the soft solids of a character through time while joints carry their held points. Scratch
// memory of one run: nothing here is part of the state.
class SoftStepper {
 public:
  SoftStepper(std::shared_ptr<const SoftFlesh> flesh, const Vec3& gravity_m_per_s2);
  SoftStepper(const SoftStepper&) = delete;
  SoftStepper& operator=(const SoftStepper&) = delete;

  // The skeleton at any time of the interval; read until the next call.
  using Poses = std::function<const PosedSkeleton&(double time_s)>;

  // From bodies.t_s to end_s, in equal substeps. Returns how many bodies had to be put back, since
  // their joints jumped or since they were turned inside out. Allocates nothing after the first
  // calls.
  std::size_t advance(const Poses& poses, double end_s, OdeState& bodies);
  // To where the bodies hang in a posture that stands still: without velocities. bodies.t_s stays.
  void settle(const PosedSkeleton& pose, OdeState& bodies);

  // The bodies at a time of the last interval: cubic between its substeps (Hermite). The result is
  // valid until the next call.
  const OdeState& at(double time_s);

  const BodyStepperStats& stats() const { return stepper_.stats(); }
  // Whether it steps these bodies in this gravity. They are kept alive, so that no others can be
  // where they are.
  bool isFor(const SoftFlesh& flesh, const Vec3& gravity_m_per_s2) const {
    return flesh_.get() == &flesh && gravity_m_per_s2_ == gravity_m_per_s2;
  }

 private:
  // Where a body's frame is at one end of a substep.
  struct Carrier {
    Transform frame;
    Twist twist;
  };
  PathPoint heldPoint(std::size_t part, const Vec3& held_m, double time_s) const;
  void readCarriers(const PosedSkeleton& pose, std::vector<Carrier>& carriers) const;
  std::size_t followJumps(OdeState& bodies);
  std::size_t repair(OdeState& bodies) const;
  void keep(const OdeState& bodies);

  std::shared_ptr<const SoftFlesh> flesh_;
  Vec3 gravity_m_per_s2_;
  BodySystem system_;
  BodyStepper stepper_;
  std::vector<Carrier> from_, to_;  // per part, of this substep
  double from_s_ = 0, step_s_ = 1;
  std::vector<OdeState> kept_;  // after each substep of the last interval
  std::size_t keptCount_ = 0;
  OdeState between_;
};

// One run's stepper, made on first use; copies start empty, as those of SkinWorkspace.
class SoftWorkspace {
 public:
  SoftWorkspace() = default;
  ~SoftWorkspace() = default;
  SoftWorkspace(const SoftWorkspace&) {}
  SoftWorkspace& operator=(const SoftWorkspace&) { return *this; }
  SoftStepper& stepper(const std::shared_ptr<const SoftFlesh>& flesh, const Vec3& gravity_m_per_s2);

 private:
  std::unique_ptr<SoftStepper> stepper_;
};

}  // namespace fascia
