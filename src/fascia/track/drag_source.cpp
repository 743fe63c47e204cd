#include <fascia/track/drag_source.h>

#include <algorithm>

namespace fascia {

DragSource::DragSource(const Skeleton& skeleton, const Flesh& flesh, const PostureSource& base,
                       double reach_s)
    : skeleton_(skeleton), flesh_(flesh), base_(base), offset_(skeleton, reach_s) {}

// Whatever changes, the posture goes on from where it is.
template <class Change>
void DragSource::change(double time_s, const Change& change) {
  sample(time_s, before_);
  admit(skeleton_, flesh_, {}, before_);
  change();
  sampleGoal(time_s, after_);
  offset_.start(time_s, before_.posture, after_.posture);
}

void DragSource::hold(double time_s, std::size_t value, double wanted) {
  if (value >= skeleton_.valueCount()) return;
  change(time_s, [&] {
    const auto held = std::ranges::find(values_, value, &HeldValue::value);
    if (held != values_.end())
      held->wanted = wanted;
    else
      values_.push_back({value, wanted});
  });
}

void DragSource::hold(double time_s, JointId joint, const Quat& wanted) {
  change(time_s, [&] {
    const auto held = std::ranges::find(turns_, joint, &HeldTurn::joint);
    if (held != turns_.end())
      held->wanted = wanted;
    else
      turns_.push_back({joint, wanted});
  });
}

void DragSource::release(double time_s, JointId joint) {
  change(time_s, [&] {
    std::erase_if(turns_, [&](const HeldTurn& turn) { return turn.joint == joint; });
    std::erase_if(values_, [&](const HeldValue& held) {
      return skeleton_.valueJoint(static_cast<int>(held.value)) == joint;
    });
  });
}

void DragSource::releaseAll(double time_s) {
  change(time_s, [&] { values_.clear(), turns_.clear(); });
}

void DragSource::sampleGoal(double time_s, PostureSample& out) const {
  base_.sample(time_s, out);
  Posture& posture = out.posture;
  const auto isHeld = [&](const JointRotation& turn) {
    return std::ranges::any_of(turns_, [&](const HeldTurn& h) { return h.joint == turn.joint; });
  };
  std::erase_if(posture.rotations, isHeld);
  for (const HeldTurn& held : turns_)
    posture.rotations.push_back({held.joint, held.wanted, Vec3::Zero()});
  admit(skeleton_, flesh_, {}, out);
  for (const HeldValue& held : values_) {
    // Of a joint that the base turns as a rotation: its angles as they are, but for this one.
    const JointId joint = skeleton_.valueJoint(static_cast<int>(held.value));
    if (isRotation(skeleton_.valueDof(static_cast<int>(held.value)).dof))
      std::erase_if(posture.rotations, [&](const JointRotation& t) { return t.joint == joint; });
    posture.values[held.value] = held.wanted;
    posture.rates[held.value] = 0;
  }
  skeleton_.clampToLimits(posture);
}

void DragSource::sample(double time_s, PostureSample& out) const {
  sampleGoal(time_s, out);
  offset_.apply(time_s, out.posture);
}

}  // namespace fascia
