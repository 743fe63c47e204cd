#include <fascia/world/performance.h>

#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/base/hash.h>
#include <fascia/deformable/contact/body_contact.h>
#include <fascia/deformable/solve/body_stepper.h>
#include <fascia/math/nearest_rotation.h>
#include <fascia/world/joint_place.h>
#include <fascia/world/placed_field.h>
#include <fascia/world/skin_obstacle.h>
#include <fascia/world/stage_surroundings.h>

namespace fascia {
namespace {

// What bodies of a scene correct each other to, relative to their sizes: far below what is seen.
constexpr double kTolerance = 1e-8;
constexpr int kMostIterations = 40;
// Of what is between a character's skin and its solids: fat and slack muscle.
constexpr double kFleshModulus_Pa = 2e4;

BodyStepperOptions stepperOptions(const SceneSimulationDef& def) {
  BodyStepperOptions options;
  options.scheme = def.scheme == "explicit" ? BodyScheme::explicitEuler
                   : def.scheme == "energy" ? BodyScheme::energyConserving
                                            : BodyScheme::implicitEuler;
  options.tolerance = kTolerance;
  options.max_iterations = kMostIterations;
  return options;
}

KeyframedPath pathOf(const ScenePathDef& def) {
  std::vector<PathKey> keys;
  for (const ScenePathDef::Key& key : def.keys)
    keys.push_back({key.time_s, key.position_m, key.velocity_m_per_s, key.leaving_m_per_s});
  return KeyframedPath(std::move(keys));
}

}  // namespace

// A character among the bodies.
struct Performance::Actor {
  // What moves it, whatever that is just now.
  struct Role final : PostureSource {
    explicit Role(const ClipSource& motion) : own(motion) {}
    void sample(double time_s, PostureSample& out) const override { now().sample(time_s, out); }
    Info info() const override { return now().info(); }
    const PostureSource& now() const { return given ? *given : own; }

    ClipSource own;                        // as the scene says
    const PostureSource* given = nullptr;  // nullptr: none
  };

  explicit Actor(const SceneCharacterDef& scene)
      : def(&scene),
        role(scene.character->source(scene.character->findMotion(scene.motion))),
        state(initialState(*scene.character, role)),
        ahead(state) {}

  const SceneCharacterDef* def;
  Role role;
  CharacterState state;
  CharacterState ahead;  // its flesh as bodies meet it, step by step
  std::unique_ptr<PlacedField> field;
  std::unique_ptr<SkinObstacle> skin;  // likewise; nullptr: it has none, or nobody meets it
  std::unique_ptr<StageSurroundings> surroundings;  // as its skin meets bodies and props
  SkinStats stats;
};

Performance::Performance(const Stage& stage, std::uint64_t seed)
    : stage_(stage),
      state_(stage.startState(seed)),
      system_(stage.bodies(), BodySettings{stage.def().simulation.gravity_m_per_s2}) {
  const SceneDef& def = stage.def();
  for (const SceneCharacterDef& character : def.characters) addActor(character);
  addTies();
  if (def.simulation.scheme == "implicit") addContacts();
  stepper_ = std::make_unique<BodyStepper>(system_, stepperOptions(def.simulation));
  addPuppet();
  addPaths();
  if (!def.script_text.empty())
    script_ = std::make_unique<Script>(def.script_text, def.script, seed);
  lookForTroubles();
}

Performance::~Performance() = default;

void Performance::addActor(const SceneCharacterDef& def) {
  FASCIA_ASSERT(def.character, "the character was built");
  auto actor = std::make_unique<Actor>(def);
  actor->field = std::make_unique<PlacedField>(actor->ahead.flesh, placeOf(def));
  actor->surroundings = std::make_unique<StageSurroundings>(stage_, placeOf(def));
  actors_.push_back(std::move(actor));
}

// The bodies' start is made legal first: velocities and places agree with what holds them.
void Performance::addTies() {
  for (Stage::Tie& tie : stage_.ties(state_)) {
    if (tie.soft)
      system_.pull({std::move(tie.constraint), tie.stiffness_N_per_m, tie.damping_Ns_per_m});
    else
      system_.hold(std::move(tie.constraint));
  }
  redundancies_ = system_.redundancies(state_);
  system_.satisfyConstraints(state_);
  system_.matchVelocities(state_);
}

void Performance::addContacts() {
  const SceneDef& def = stage_.def();
  ContactSettings settings;
  if (def.ground) settings.ground_m = def.ground->height_m;
  if (def.ground) settings.friction = def.ground->friction;
  BodyContacts& contacts = system_.setContacts(settings);
  for (std::size_t b = 0; b < def.bodies.size(); ++b)
    if (def.bodies[b].collides)
      contacts.setSurface(BodyId(b), stage_.surface(BodyId(b)), def.bodies[b].friction);
  for (std::size_t i = 0; i < def.props.size(); ++i) {
    contacts.addObstacle(stage_.prop(i), def.props[i].friction);
    obstacles_.push_back(def.props[i].name);
  }
  for (const auto& actor : actors_) {
    contacts.addObstacle(*actor->field, actor->def->friction);
    obstacles_.push_back(actor->def->name);
    if (!actor->def->character->skin() || def.bodies.empty()) continue;
    actor->skin = std::make_unique<SkinObstacle>(*actor->def, actor->ahead);
    contacts.addPadding(actor->skin->field(), kFleshModulus_Pa, actor->def->friction);
    obstacles_.push_back(actor->def->name);
  }
}

// Points of bodies, places, and the joints of characters.
void Performance::addPuppet() {
  std::vector<NamedPoint> points;
  for (const Stage::NamedBodyPoint& point : stage_.points())
    points.push_back({point.name, point.point});
  for (const NamedPlaceDef& place : stage_.def().places)
    points.push_back({place.name, place.position_m});
  for (const auto& actor : actors_) {
    const Skeleton& skeleton = actor->def->character->skeleton();
    for (std::size_t j = 0; j < skeleton.jointCount(); ++j) {
      const JointId joint(j);
      points.push_back({actor->def->name + "." + skeleton.joint(joint).name,
                        jointPlace(*actor->def, actor->role, joint)});
    }
  }
  puppet_ = std::make_unique<Puppet>(system_, state_, std::move(points));
}

void Performance::addPaths() {
  for (const ScenePathDef& path : stage_.def().paths) {
    KeyframedPath keyframed = pathOf(path);
    const double onset_s = keyframed.start_s();
    puppet_->run(makeFollow(puppet_->find(path.point), std::move(keyframed),
                            {.preroll_s = path.preroll_s, .onset_s = onset_s}));
  }
}

void Performance::advance(double dt_s) {
  FASCIA_ASSERT(dt_s > 0 && state_.r.size() == stage_.bodies().size(), "time goes on");
  const std::size_t steps = stage_.stepsPerFrame(1 / dt_s);
  const double start_s = state_.t_s;
  if (!actors_.empty()) before_ = state_;
  for (const auto& actor : actors_) {
    if (!actor->skin) continue;
    poseAhead(*actor, start_s + dt_s);
    actor->skin->setFrame(start_s, start_s + dt_s, actor->ahead);
  }
  for (std::size_t i = 0; i < steps; ++i) {
    const double end_s = start_s + dt_s * static_cast<double>(i + 1) / static_cast<double>(steps);
    step(end_s - state_.t_s);
    state_.t_s = end_s;
  }
  lookForTroubles();
  for (const auto& actor : actors_) {
    actor->surroundings->setFrame(before_, state_);
    fascia::advance(*actor->def->character, actor->role, dt_s, actor->state, actor->stats,
                    actor->surroundings.get());
  }
}

void Performance::poseAhead(Actor& actor, double time_s) {
  actor.ahead.time_s = time_s;
  poseLayers(*actor.def->character, actor.role, true, actor.ahead);
}

void Performance::step(double h_s) {
  FASCIA_ASSERT(h_s > 0, "time goes on");
  if (script_) script_->update(*puppet_, h_s);
  puppet_->update(h_s);
  for (const auto& actor : actors_) {
    poseAhead(*actor, state_.t_s + h_s);
    if (actor->skin) actor->skin->moveTo(state_.t_s + h_s);
  }
  stepper_->step(h_s, state_);
}

void Performance::lookForTroubles() {
  for (const Puppet::LetGo& letGo : puppet_->letGos().subspan(letGos_))
    troubles_.noteLetGo(letGo.time_s, puppet_->bodyPoint(letGo.point).body,
                        stage_.body(letGo.squeezed).name);
  letGos_ = puppet_->letGos().size();
  troubles_.look(stage_, state_, system_.contacts(), obstacles_);
  restoreCollapsed();
}

// What has no volume left has no force left that could give it back: after a moment it starts anew,
// undeformed, with the momentum that it has.
void Performance::restoreCollapsed() {
  constexpr double kCollapsed = 0.02;  // of its volume
  constexpr int kMoment = 6;           // frames
  const BodyModel& model = stage_.bodies();
  collapsedFrames_.resize(model.bodyCount(), 0);
  for (std::size_t b = 0; b < model.bodyCount(); ++b) {
    const BodyId id(b);
    const BodyShape& shape = model.shape(id);
    const auto q = model.part(id, std::span<const double>(state_.r));
    int& frames = collapsedFrames_[b];
    frames = shape.meanGrowth(q) < kCollapsed ? frames + 1 : 0;
    if (frames < kMoment) continue;
    frames = 0;
    const Vec3 center = shape.point(q, shape.center_m());
    const Vec3 velocity =
        shape.point(model.part(id, std::span<const double>(state_.v)), shape.center_m());
    const Mat3 turn = nearestRotation(shape.deformationGradient(q, shape.center_m()));
    model.place(id, {turn, center - turn * shape.center_m()}, state_);
    shape.setRigidVelocity(q, {velocity, Vec3::Zero(), center},
                           model.part(id, std::span<double>(state_.v)));
    troubles_.noteRestored(state_.t_s, id);
  }
}

void Performance::setSource(std::size_t i, const PostureSource* source) {
  FASCIA_ASSERT(i < actors_.size(), "the character performs");
  actors_[i]->role.given = source;
}

const PostureSource& Performance::source(std::size_t i) const {
  FASCIA_ASSERT(i < actors_.size(), "the character performs");
  return actors_[i]->role.now();
}

const CharacterState& Performance::character(std::size_t i) const {
  FASCIA_ASSERT(i < actors_.size(), "the character performs");
  return actors_[i]->state;
}

std::uint64_t Performance::hash() const {
  StateHash hash;
  hash.add(state_.t_s);
  hash.add(state_.r.data(), state_.r.size() * sizeof(double));
  hash.add(state_.v.data(), state_.v.size() * sizeof(double));
  for (const auto& actor : actors_) {
    const std::uint64_t own = hashOf(*actor->def->character, actor->state);
    hash.add(&own, sizeof own);
  }
  return hash.value();
}

}  // namespace fascia
