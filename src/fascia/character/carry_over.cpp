#include <algorithm>

#include <fascia/character/editing.h>
#include <fascia/skin/carry_over.h>

namespace fascia {
namespace {

// Whether every joint has the degrees of freedom that it had; names may differ.
bool sameValues(const Skeleton& a, const Skeleton& b) {
  if (a.jointCount() != b.jointCount() || a.valueCount() != b.valueCount()) return false;
  for (int i = 0; i < static_cast<int>(a.valueCount()); ++i)
    if (a.valueJoint(i) != b.valueJoint(i) || a.valueDof(i).dof != b.valueDof(i).dof) return false;
  return true;
}

// Values of joints that go on; others rest.
Posture carryOver(const Skeleton& from, const Posture& posture, const Skeleton& to) {
  Posture out = to.restPosture();
  if (posture.values.size() != from.valueCount()) return out;
  if (sameValues(from, to)) {
    out = posture;
  } else {
    for (int i = 0; i < static_cast<int>(to.valueCount()); ++i) {
      const JointId joint = from.find(to.joint(to.valueJoint(i)).name);
      const int old = joint.valid() ? from.valueIndex(joint, to.valueDof(i).dof) : -1;
      if (old < 0) continue;
      out.values[static_cast<std::size_t>(i)] = posture.values[static_cast<std::size_t>(old)];
      out.rates[static_cast<std::size_t>(i)] = posture.rates[static_cast<std::size_t>(old)];
    }
  }
  to.clampToLimits(out);
  return out;
}

// Weights of morphs that go on; others rest.
MorphPose carryOver(const Morphs& from, const MorphPose& pose, const Morphs& to) {
  MorphPose out;
  to.rest(out);
  if (pose.weights.size() != from.size()) return out;
  for (std::size_t i = 0; i < to.size(); ++i) {
    const int old = from.find(to[i].name);
    if (old < 0) continue;
    out.weights[i] = pose.weights[static_cast<std::size_t>(old)];
    out.rates[i] = pose.rates[static_cast<std::size_t>(old)];
  }
  return out;
}

// What moved the character last goes on for the moment of the edit.
class AsItIs final : public PostureSource {
 public:
  explicit AsItIs(PostureSample sample) : sample_(std::move(sample)) {}
  void sample(double, PostureSample& out) const override { out = sample_; }

 private:
  PostureSample sample_;
};

// Whether a body of the one is described by the same functions as one of the other.
bool sameShapes(const Character& a, const SoftFlesh::Part& x, const Character& b,
                const SoftFlesh::Part& y) {
  const FleshSolidDef &before = a.flesh().def(x.solid), &now = b.flesh().def(y.solid);
  return before.solid == now.solid && before.soft->basis == now.soft->basis;
}

// Bodies keep their shapes, and go with their solids' frames if these were moved.
OdeState carryOverBodies(const Character& from, const CharacterState& state, const Character& to,
                         const PosedSkeleton& skeleton) {
  const SoftFlesh& soft = *to.softFlesh();
  OdeState out;
  soft.place(skeleton, out);
  out.t_s = state.time_s;
  if (!from.softFlesh() || state.bodies.r.size() != from.softFlesh()->model().size()) return out;
  for (const SoftFlesh::Part& part : soft.parts()) {
    const auto& olds = from.softFlesh()->parts();
    const auto old = std::ranges::find(olds, part.solid, &SoftFlesh::Part::solid);
    if (old == olds.end() || !sameShapes(from, *old, to, part)) continue;
    const BodyModel &before = from.softFlesh()->model(), &now = soft.model();
    for (const auto& [source, target] :
         {std::pair{&state.bodies.r, &out.r}, std::pair{&state.bodies.v, &out.v}})
      now.shape(part.body).setShapeMatrix(before.shape(old->body).shapeMatrix(before.part(
                                              old->body, std::span<const double>(*source))),
                                          now.part(part.body, std::span<double>(*target)));
    const Transform was = state.skeleton.joint_world[old->joint.index()] * old->inJoint;
    const Transform is = skeleton.joint_world[part.joint.index()] * part.inJoint;
    if (was != is) soft.carry(part, is * was.inverse(), out);
  }
  return out;
}

}  // namespace

CharacterState carryOver(const Character& from, const CharacterState& state, const Character& to) {
  CharacterState out = state;
  out.posture = carryOver(from.skeleton(), state.posture, to.skeleton());
  if (from.softFlesh() != to.softFlesh()) {
    out.flesh = {};
    out.bodies = {};
    if (to.softFlesh()) {
      to.skeleton().pose(out.posture, out.skeleton);
      out.bodies = carryOverBodies(from, state, to, out.skeleton);
    }
  }
  out.morphs = carryOver(from.morphs(), state.morphs, to.morphs());
  poseLayers(to, AsItIs({out.posture, state.sampled.parameters, out.morphs}), true, out);
  if (!to.skin()) {
    out.skin = {};
    return out;
  }
  const SkinPose pose{&out.flesh, out.skeleton.joint_world, out.morphs.weights};
  if (from.skin()) {
    out.skin = carryOver(*from.skin(), std::move(out.skin), *to.skin(), pose);
  } else {
    placeSkin(*to.skin(), pose, out.skin);
    out.skin.starting = true;
  }
  return out;
}

void requireFits(const Character& character, const CharacterState& state) {
  const auto refuse = [](const std::string& what) {
    throw Error("the state is not one of this character: its " + what + " do not fit");
  };
  if (character.skin())
    if (const char* what = misfit(*character.skin(), state.skin)) refuse(what);
  if (character.softFlesh() && state.bodies.r.size() != character.softFlesh()->model().size())
    refuse("soft solids");
}

}  // namespace fascia
