#include <fascia/character/character.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/character/idle_settings.h>
#include <fascia/field/field_list.h>
#include <fascia/flesh/bind.h>

namespace fascia {
namespace {

SkinSettings settingsOf(const SimulationDef& s, const BuildOptions& options) {
  SkinSettings out;
  out.gravity_m_per_s2 = s.gravity_m_per_s2;
  out.integrator = s.integrator;
  out.step_s = s.step_s;
  out.min_step_s = s.min_step_s;
  out.max_step_s = s.max_step_s;
  out.position_tolerance_m = s.position_tolerance_m;
  out.velocity_tolerance = s.velocity_tolerance;
  out.correction_tolerance_m = s.correction_tolerance_m;
  if (options.interval_s > 0) out.interval_s = options.interval_s;
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
    if (!surroundings_) return {&state_.flesh, state_.skeleton.joint_world};
    all_.clear();
    all_.add(state_.flesh);
    all_.add(surroundings_->at(time_s));
    return {&all_, state_.skeleton.joint_world};
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
    source_.sample(time_s, sampled);
    admit(character_.skeleton(), character_.flesh(), state_.posture, sampled);
    if (!moving_) still(sampled);
    // The former posture's memory is the next sample's.
    std::swap(state_.posture, sampled.posture);
    character_.skeleton().pose(state_.posture, state_.skeleton);
  }

  static void still(PostureSample& sampled) {
    std::ranges::fill(sampled.posture.rates, 0.0);
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

Character::Character(const CharacterDef& def, const BuildOptions& options) : def_(def) {
  if (!options.integrator.empty()) def_.simulation.integrator = options.integrator;
  if (options.step_s >= 0) def_.simulation.step_s = options.step_s;
  if (def_.skin && options.columns > 0) def_.skin->columns = options.columns;
  if (def_.skin && options.rows > 0) def_.skin->rows = options.rows;
  if (def_.skin && options.jiggle >= 0) def_.skin->pose.jiggle = options.jiggle;

  Diagnostics diagnostics;
  skeleton_ = Skeleton(def_.skeleton, "/skeleton", diagnostics);
  // Joints are referred to by name everywhere below: without them more messages would mislead.
  diagnostics.throwIfErrors();
  flesh_ = Flesh(def_.flesh, skeleton_, "/solids", diagnostics);
  ornaments_ = Flesh(def_.ornaments, skeleton_, "/ornaments", diagnostics, Flesh::Role::ornament);
  const bool hasFlesh = diagnostics.ok();
  if (hasFlesh) buildSoftFlesh(diagnostics);
  validateTunables(def_.simulation, "/simulation", diagnostics);
  if (def_.rig) validateTunables(*def_.rig, "/rig", diagnostics);
  for (std::size_t i = 0; i < def_.motions.size(); ++i) {
    const std::string pointer = "/motions/" + std::to_string(i);
    clips_.push_back(
        bindMotion(def_.motions[i], skeleton_, flesh_, ornaments_, pointer, diagnostics));
    for (std::size_t j = 0; j < i; ++j)
      if (def_.motions[j].name == def_.motions[i].name)
        diagnostics.error(pointer + "/name", "found '" + def_.motions[i].name + "' a second time",
                          "give every motion a name of its own");
  }
  if (def_.rig && def_.rig->model) bindRigMotions(diagnostics);
  if (def_.skin && hasFlesh) {
    PosedSkeleton posedSkeleton;
    PosedFlesh posedFlesh;
    const Posture rest = skeleton_.restPosture();
    skeleton_.pose(rest, posedSkeleton);
    flesh_.pose(rest, posedSkeleton, {}, posedFlesh);
    skin_ = std::make_unique<Skin>(*def_.skin, settingsOf(def_.simulation, options),
                                   SkinBase{skeleton_, flesh_, posedSkeleton, posedFlesh,
                                            def_.rig ? def_.rig->model.get() : nullptr},
                                   "/skin", diagnostics);
  }
  diagnostics.throwIfErrors();
  warnOfIdleSettings(def_, diagnostics);
  warnings_ = diagnostics.warnings();
}

void Character::buildSoftFlesh(Diagnostics& diagnostics) {
  const auto isSoft = [](const FleshSolidDef& solid) { return solid.soft.has_value(); };
  const std::vector<FleshSolidDef>&solids = def_.flesh.solids, &ornaments = def_.ornaments.solids;
  for (std::size_t i = 0; i < ornaments.size(); ++i)
    if (isSoft(ornaments[i]))
      diagnostics.error("/ornaments/" + std::to_string(i) + "/soft",
                        "an ornament is rigid: it cannot be soft", "make it one of the solids");
  for (std::size_t m = 0; m < def_.motions.size(); ++m) {
    const std::vector<TrackDef>& tracks = def_.motions[m].tracks;
    for (std::size_t t = 0; t < tracks.size(); ++t) {
      const auto solid = std::ranges::find(solids, tracks[t].name, &FleshSolidDef::name);
      if (tracks[t].target != TrackDef::Target::solid || solid == solids.end() || !isSoft(*solid))
        continue;
      diagnostics.error(
          "/motions/" + std::to_string(m) + "/tracks/" + std::to_string(t),
          "the soft solid '" + solid->name + "' takes its shape from forces: it has no keys",
          "drop its \"soft\", or the track");
    }
  }
  if (std::ranges::none_of(solids, isSoft)) return;
  softFlesh_ = std::make_shared<SoftFlesh>(def_.flesh, flesh_, "/solids", diagnostics);
}

// The rig's motions come after the character's own; one that has the name of an own one is hidden.
void Character::bindRigMotions(Diagnostics& diagnostics) {
  const std::shared_ptr<const RiggedModel>& model = def_.rig->model;
  std::vector<SampledFrame> frames;
  for (const RigJoint& j : model->joints)
    frames.push_back({j.name,
                      j.parent < 0 ? "" : model->joints[static_cast<std::size_t>(j.parent)].name,
                      j.rest_world});
  for (const SampledMotion& motion : model->motions) {
    if (findMotion(motion.name) >= 0) continue;
    // Shares the ownership of the whole model.
    clips_.push_back(bindSampled(std::shared_ptr<const SampledMotion>(model, &motion), frames,
                                 skeleton_, "/rig", diagnostics));
    if (!diagnostics.ok()) return;
  }
}

int Character::findMotion(std::string_view name) const {
  if (name.empty()) return clips_.empty() ? -1 : 0;
  for (std::size_t i = 0; i < clips_.size(); ++i)
    if (clips_[i].name == name) return static_cast<int>(i);
  return -1;
}

ClipSource Character::source(int motion) const {
  return {skeleton_, motion < 0 ? rest_ : clips_[static_cast<std::size_t>(motion)]};
}

std::uint64_t hashOf(const Character& character, const CharacterState& state) {
  StateHash hash;
  hash.add(state.time_s);
  hash.add(state.posture.values.data(), state.posture.values.size() * sizeof(double));
  hash.add(state.bodies.r.data(), state.bodies.r.size() * sizeof(double));
  hash.add(state.bodies.v.data(), state.bodies.v.size() * sizeof(double));
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
    const SkinPose pose{&state.flesh, state.skeleton.joint_world};
    carrySkin(*character.skin(), pose, state.skin);
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
  const double start = state.time_s;
  state.time_s = start + dt_s;
  LayerPoses poses(character, source, true, state, surroundings);
  const int pieces = std::max(1, static_cast<int>(std::ceil(dt_s / kLongestFrame_s - 1e-6)));
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
