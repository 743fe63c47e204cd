#include <fascia/character/character.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/character/character_builder.h>
#include <fascia/character/editing.h>
#include <fascia/field/field_list.h>
#include <fascia/flesh/bind.h>

namespace fascia {
namespace {

std::shared_ptr<const CharacterDef> withOptions(const CharacterDef& def,
                                                const BuildOptions& options) {
  auto out = std::make_shared<CharacterDef>(def);
  if (!options.integrator.empty()) out->simulation.integrator = options.integrator;
  if (options.step_s >= 0) out->simulation.step_s = options.step_s;
  if (out->skin && options.columns > 0) out->skin->grid.columns = options.columns;
  if (out->skin && options.rows > 0) out->skin->grid.rows = options.rows;
  if (out->skin && options.jiggle >= 0) out->skin->mesh.pose.jiggle = options.jiggle;
  return out;
}

// The bodies' shapes at one moment, or where they would stand still, to the flesh.
void showBodies(const OdeState& bodies, bool moving, CharacterState& state) {
  if (moving) {
    state.flesh.soft().update(bodies.r, bodies.v);
    return;
  }
  state.stillBodies.assign(bodies.v.size(), 0.0);
  state.flesh.soft().update(bodies.r, state.stillBodies);
}

SkinPose skinPose(const CharacterState& state) {
  return {&state.flesh, state.skeleton.joint_world, state.morphs.weights};
}

// Poses the layers below the skin at any time, in the state's own memory. Soft solids
// are taken from the interval that was stepped last, or as the state has them.
class LayerPoses final : public SkinPoseSource {
 public:
  LayerPoses(const Character& character, const PostureSource& source, bool moving,
             CharacterState& state, Surroundings* surroundings = nullptr)
      : character_(character),
        source_(source),
        moving_(moving),
        state_(state),
        surroundings_(surroundings) {}

  // The soft solids' steps to end_s, which at() then shows; how many were put back.
  std::size_t stepBodies(double end_s) {
    if (!character_.softFlesh()) return 0;
    stepper_ = &state_.softWorkspace.stepper(character_.softFlesh(),
                                             character_.def().simulation.gravity_m_per_s2);
    return stepper_->advance(
        [this](double time_s) -> const PosedSkeleton& {
          poseJoints(time_s);
          return state_.skeleton;
        },
        end_s, state_.bodies);
  }

  SkinPose at(double time_s) override {
    poseJoints(time_s);
    character_.flesh().pose(state_.posture, state_.skeleton, state_.sampled.parameters,
                            state_.flesh.rigid());
    if (character_.softFlesh()) showSoft(time_s);
    if (!surroundings_) return skinPose(state_);
    all_.clear();
    all_.add(state_.flesh);
    all_.add(surroundings_->at(time_s));
    return {&all_, state_.skeleton.joint_world, state_.morphs.weights};
  }

 private:
  void showSoft(double time_s) {
    character_.softFlesh()->prepare(state_.flesh);
    if (stepper_) {
      showBodies(stepper_->at(time_s), moving_, state_);
      return;
    }
    OdeState& bodies = state_.bodies;
    if (bodies.r.size() != character_.softFlesh()->model().size() || bodies.t_s != time_s) {
      character_.softFlesh()->place(state_.skeleton, bodies);
      bodies.t_s = time_s;
    }
    showBodies(bodies, moving_, state_);
  }

  void poseJoints(double time_s) {
    PostureSample& sampled = state_.sampled;
    ask(source_, time_s, sampled);
    sampled.parameters.insert(sampled.parameters.end(), state_.held.begin(), state_.held.end());
    admit(character_.figure(), state_.posture, sampled);
    if (!moving_) still(sampled);
    // The former posture's memory is the next sample's.
    std::swap(state_.posture, sampled.posture);
    std::swap(state_.morphs, sampled.morphs);
    character_.skeleton().pose(state_.posture, state_.skeleton);
  }

  static void still(PostureSample& sampled) {
    std::ranges::fill(sampled.posture.rates, 0.0);
    std::ranges::fill(sampled.morphs.rates, 0.0);
    for (JointRotation& turn : sampled.posture.rotations) turn.angular_rad_per_s.setZero();
    for (Flesh::ParameterOverride& p : sampled.parameters) p.rate = p.weightRate_per_s = 0;
  }

  const Character& character_;
  const PostureSource& source_;
  bool moving_;
  CharacterState& state_;
  Surroundings* surroundings_;
  FieldList all_;                   // of both
  SoftStepper* stepper_ = nullptr;  // once it has stepped
};

// A posture that stands still: time goes on, the pose does not.
class FrozenPoses final : public SkinPoseSource {
 public:
  explicit FrozenPoses(SkinPose pose) : pose_(pose) {}
  SkinPose at(double) override { return pose_; }

 private:
  SkinPose pose_;
};

}  // namespace

Character::Character(const CharacterDef& def, const BuildOptions& options)
    : parts_(CharacterBuilder(withOptions(def, options), options.interval_s, nullptr).build()) {}

Character Character::edited(const CharacterDef& def) const {
  return Character(
      CharacterBuilder(std::make_shared<CharacterDef>(def), parts_.interval_s, &parts_).build());
}

int Character::findMotion(std::string_view name) const {
  if (name.empty()) return motionCount() == 0 ? -1 : 0;
  for (std::size_t i = 0; i < motionCount(); ++i)
    if (motion(i).name == name) return static_cast<int>(i);
  return -1;
}

ClipSource Character::source(int motion) const {
  static const BoundClip kRest;  // without tracks
  return {skeleton(), morphs(),
          motion < 0 ? kRest : this->motion(static_cast<std::size_t>(motion))};
}

std::uint64_t hashOf(const Character& character, const CharacterState& state) {
  StateHash hash;
  hash.add(state.time_s);
  hash.add(state.posture.values.data(), state.posture.values.size() * sizeof(double));
  hash.add(state.morphs.weights.data(), state.morphs.weights.size() * sizeof(double));
  hash.add(state.bodies.r.data(), state.bodies.r.size() * sizeof(double));
  hash.add(state.bodies.v.data(), state.bodies.v.size() * sizeof(double));
  for (const Flesh::ParameterOverride& p : state.held) {
    hash.add(p.solid.value);
    hash.add(p.parameter);
    hash.add(p.value);
    hash.add(p.rate);
  }
  if (character.skin()) state.skin.addTo(hash, character.skin()->topology());
  return hash.value();
}

void poseLayers(const Character& character, const PostureSource& source, bool moving,
                CharacterState& state) {
  LayerPoses(character, source, moving, state).at(state.time_s);
  character.ornaments().pose(state.posture, state.skeleton, {}, state.ornaments);
}

namespace {

// The soft solids hang as they would after any time, and move with their joints.
void settleBodies(const Character& character, const PostureSource& source, CharacterState& state) {
  const SimulationDef& simulation = character.def().simulation;
  if (simulation.settle_s > 0)
    state.softWorkspace.stepper(character.softFlesh(), simulation.gravity_m_per_s2)
        .settle(state.skeleton, state.bodies);
  poseLayers(character, source, true, state);
  character.softFlesh()->setRigidVelocities(state.skeleton, state.bodies);
  poseLayers(character, source, false, state);
}

}  // namespace

CharacterState initialState(const Character& character, const PostureSource& source) {
  CharacterState state;
  poseLayers(character, source, false, state);
  if (character.softFlesh()) settleBodies(character, source, state);
  if (character.skin()) {
    const SkinPose pose = skinPose(state);
    placeSkin(*character.skin(), pose, state.skin);
    FrozenPoses frozen(pose);
    SkinStats ignored;
    const double frame = 1.0 / 60;
    const double settle_s =
        character.skin()->isSimulated() ? character.def().simulation.settle_s : 0;
    const int frames = static_cast<int>(std::ceil(settle_s / frame));
    for (int i = 0; i < frames; ++i)
      advanceSkin(*character.skin(), frozen, i * frame, (i + 1) * frame, state.skin,
                  state.workspace, ignored);
    state.skin.starting = true;
  }
  poseLayers(character, source, true, state);
  return state;
}

void advance(const Character& character, const PostureSource& source, double dt_s,
             CharacterState& state, SkinStats& stats, Surroundings* surroundings) {
  FASCIA_ASSERT(dt_s > 0, "time goes on");
  requireFits(character, state);
  const double start = state.time_s;
  state.time_s = start + dt_s;
  LayerPoses poses(character, source, true, state, surroundings);
  const int pieces = std::max(1, static_cast<int>(std::ceil(dt_s / kLongestPiece_s - 1e-6)));
  for (int i = 0; i < pieces; ++i) {
    const double from = start + dt_s * i / pieces;
    const double to = i + 1 == pieces ? state.time_s : start + dt_s * (i + 1) / pieces;
    stats.repaired_points += poses.stepBodies(to);
    if (character.skin())
      advanceSkin(*character.skin(), poses, from, to, state.skin, state.workspace, stats);
  }
  if (!character.skin()) poses.at(state.time_s);
  character.ornaments().pose(state.posture, state.skeleton, {}, state.ornaments);
}

}  // namespace fascia
