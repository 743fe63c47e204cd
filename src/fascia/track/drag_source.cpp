#include <fascia/track/drag_source.h>

#include <algorithm>

namespace fascia {

DragSource::DragSource(const Figure& figure, const PostureSource& base, double reach_s)
    : figure_(figure), base_(base), offset_(figure, reach_s) {}

// Whatever changes, the posture goes on from where it is.
template <class Change>
void DragSource::change(double time_s, const Change& change) {
  sampleFit(*this, figure_, time_s, before_);
  change();
  sampleGoal(time_s, after_);
  offset_.start(time_s, before_, after_);
}

void DragSource::hold(std::vector<HeldValue>& list, std::size_t value, double wanted) {
  const auto held = std::ranges::find(list, value, &HeldValue::value);
  if (held != list.end())
    held->wanted = wanted;
  else
    list.push_back({value, wanted});
}

void DragSource::hold(double time_s, std::size_t value, double wanted) {
  if (value >= figure_.skeleton.valueCount()) return;
  change(time_s, [&] { hold(values_, value, wanted); });
}

void DragSource::holdMorph(double time_s, std::size_t morph, double wanted) {
  if (morph >= figure_.morphs.size()) return;
  change(time_s, [&] { hold(morphs_, morph, wanted); });
}

void DragSource::releaseMorph(double time_s, std::size_t morph) {
  change(time_s, [&] {
    std::erase_if(morphs_, [&](const HeldValue& held) { return held.value == morph; });
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
      return figure_.skeleton.valueJoint(static_cast<int>(held.value)) == joint;
    });
  });
}

void DragSource::releaseAll(double time_s) {
  change(time_s, [&] { values_.clear(), turns_.clear(), morphs_.clear(); });
}

void DragSource::sampleGoal(double time_s, PostureSample& out) const {
  ask(base_, time_s, out);
  Posture& posture = out.posture;
  const auto isHeld = [&](const JointRotation& turn) {
    return std::ranges::any_of(turns_, [&](const HeldTurn& h) { return h.joint == turn.joint; });
  };
  std::erase_if(posture.rotations, isHeld);
  for (const HeldTurn& held : turns_)
    posture.rotations.push_back({held.joint, held.wanted, Vec3::Zero()});
  admit(figure_, {}, out);
  for (const HeldValue& held : morphs_) {
    out.morphs.weights[held.value] = held.wanted;
    out.morphs.rates[held.value] = 0;
  }
  figure_.morphs.admit(out.morphs);
  for (const HeldValue& held : values_) {
    // Of a joint that the base turns as a rotation: its angles as they are, but for this one.
    const JointId joint = figure_.skeleton.valueJoint(static_cast<int>(held.value));
    if (isRotation(figure_.skeleton.valueDof(static_cast<int>(held.value)).dof))
      std::erase_if(posture.rotations, [&](const JointRotation& t) { return t.joint == joint; });
    posture.values[held.value] = held.wanted;
    posture.rates[held.value] = 0;
  }
  figure_.skeleton.clampToLimits(posture);
}

void DragSource::sample(double time_s, PostureSample& out) const {
  sampleGoal(time_s, out);
  offset_.apply(time_s, out);
}

}  // namespace fascia
