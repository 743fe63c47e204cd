#include <fascia/character/character_builder.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

#include <fascia/base/suggest.h>
#include <fascia/character/idle_settings.h>
#include <fascia/flesh/bind.h>
#include <fascia/skin/ode_skin.h>
#include <fascia/skin/skin_fit.h>

namespace fascia {
namespace {

SkinSettings settingsOf(const SimulationDef& s, double interval_s) {
  SkinSettings out;
  out.gravity_m_per_s2 = s.gravity_m_per_s2;
  out.integrator = s.integrator;
  out.step_s = s.step_s;
  out.min_step_s = s.min_step_s;
  out.max_step_s = s.max_step_s;
  out.position_tolerance_m = s.position_tolerance_m;
  out.velocity_tolerance = s.velocity_tolerance;
  out.correction_tolerance_m = s.correction_tolerance_m;
  if (interval_s > 0) out.interval_s = interval_s;
  return out;
}

std::string inMicroseconds(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g µs", 1e6 * seconds);
  return text;
}

bool isSoft(const FleshSolidDef& solid) {
  return solid.soft.has_value();
}

// What ids, indices of values and names depend on.
bool sameStructure(const SkeletonDef& a, const SkeletonDef& b) {
  const auto sameDof = [](const DofDef& x, const DofDef& y) { return x.dof == y.dof; };
  return std::ranges::equal(a.joints, b.joints, [&](const JointDef& x, const JointDef& y) {
    return x.name == y.name && x.parent == y.parent && std::ranges::equal(x.dofs, y.dofs, sameDof);
  });
}

// What ids and indices of parameters depend on.
bool sameStructure(const FleshDef& a, const FleshDef& b) {
  return std::ranges::equal(a.solids, b.solids, [](const FleshSolidDef& x, const FleshSolidDef& y) {
    return x.name == y.name && x.solid.shape == y.solid.shape &&
           std::ranges::equal(x.solid.deformations, y.solid.deformations, {}, &SolidDef::Step::type,
                              &SolidDef::Step::type);
  });
}

// Names aside.
bool sameMesh(const std::optional<RigDef>& a, const std::optional<RigDef>& b) {
  if (!a || !b) return !a && !b;
  return a->file == b->file && a->scale == b->scale && a->model == b->model;
}

}  // namespace

CharacterBuilder::CharacterBuilder(std::shared_ptr<const CharacterDef> def, double interval_s,
                                   const CharacterParts* before)
    : before_(before) {
  parts_.def = std::move(def);
  parts_.interval_s = interval_s;
}

CharacterParts CharacterBuilder::build() {
  makeSkeleton();
  // Joints are referred to by name everywhere below: without them more messages would mislead.
  diagnostics_.throwIfErrors();
  makeFlesh();
  makeMorphs();
  checkRigNames();
  const bool hasFlesh = diagnostics_.ok();
  if (hasFlesh) makeSoftFlesh();
  validateTunables(def().simulation, "/simulation", diagnostics_);
  if (def().rig) validateTunables(*def().rig, "/rig", diagnostics_);
  bindMotions();
  if (hasFlesh) makeSkin();
  diagnostics_.throwIfErrors();
  warnOfIdleSettings(def(), diagnostics_);
  if (parts_.skin && parts_.skin->fit())
    warnOfSkinFit(*parts_.skin->fit(), *parts_.flesh, parts_.skin->grid() != nullptr, "/skin",
                  diagnostics_);
  parts_.warnings = diagnostics_.warnings();
  return std::move(parts_);
}

void CharacterBuilder::makeSkeleton() {
  if (before_ && before_->def->skeleton == def().skeleton)
    parts_.skeleton = before_->skeleton;
  else
    parts_.skeleton = std::make_shared<Skeleton>(def().skeleton, "/skeleton", diagnostics_);
}

// Solids know their joints by number: a joint may move without a change of the flesh.
void CharacterBuilder::makeFlesh() {
  const bool keepsJoints = before_ && (before_->skeleton == parts_.skeleton ||
                                       sameStructure(before_->def->skeleton, def().skeleton));
  if (keepsJoints && before_->def->flesh == def().flesh)
    parts_.flesh = before_->flesh;
  else
    parts_.flesh = std::make_shared<Flesh>(def().flesh, *parts_.skeleton, "/solids", diagnostics_);
  if (keepsJoints && before_->def->ornaments == def().ornaments)
    parts_.ornaments = before_->ornaments;
  else
    parts_.ornaments = std::make_shared<Flesh>(def().ornaments, *parts_.skeleton, "/ornaments",
                                               diagnostics_, Flesh::Role::ornament);
}

void CharacterBuilder::makeMorphs() {
  std::vector<MorphDef> list;
  if (def().rig && def().rig->model)
    for (const RigMorph& morph : def().rig->model->morphs)
      list.push_back({morph.name, double{morph.rest}});
  auto morphs = std::make_shared<Morphs>(std::move(list));
  const bool keeps = before_ && *before_->morphs == *morphs;
  parts_.morphs = keeps ? before_->morphs : std::move(morphs);
}

void CharacterBuilder::checkRigNames() {
  if (!def().rig || !def().rig->model) return;
  const std::vector<RigJoint>& joints = def().rig->model->joints;
  const std::vector<RigJointNameDef>& names = def().rig->joint_names;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string pointer = "/rig/joint_names/" + std::to_string(i);
    if (std::ranges::find(joints, names[i].joint, &RigJoint::name) == joints.end())
      diagnostics_.error(pointer + "/joint", "the rig has no joint " + quotedName(names[i].joint));
    const auto same = [&](const RigJointNameDef& other) {
      return other.joint == names[i].joint || other.name == names[i].name;
    };
    const auto before = names.begin() + static_cast<std::ptrdiff_t>(i);
    if (std::find_if(names.begin(), before, same) != before)
      diagnostics_.error(pointer, "the joint or its name stands before already");
  }
}

void CharacterBuilder::checkSoftness() {
  const std::vector<FleshSolidDef>&solids = def().flesh.solids, &ornaments = def().ornaments.solids;
  for (std::size_t i = 0; i < ornaments.size(); ++i)
    if (isSoft(ornaments[i]))
      diagnostics_.error("/ornaments/" + std::to_string(i) + "/soft",
                         "an ornament is rigid: it cannot be soft", "make it one of the solids");
  for (std::size_t m = 0; m < def().motions.size(); ++m) {
    const std::vector<TrackDef>& tracks = def().motions[m].tracks;
    for (std::size_t t = 0; t < tracks.size(); ++t) {
      if (tracks[t].target != TrackDef::Target::solid) continue;
      const auto solid = std::ranges::find(solids, tracks[t].name, &FleshSolidDef::name);
      if (solid == solids.end() || !isSoft(*solid)) continue;
      diagnostics_.error(
          "/motions/" + std::to_string(m) + "/tracks/" + std::to_string(t),
          "the soft solid '" + solid->name + "' takes its shape from forces: it has no keys",
          "drop its \"soft\", or the track");
    }
  }
}

// Bodies are made of soft solids alone, and of where these are in their joints.
bool CharacterBuilder::keepsSoftFlesh() const {
  if (!before_ || !before_->softFlesh) return false;
  if (before_->flesh == parts_.flesh) return true;
  const std::vector<FleshSolidDef>&old = before_->def->flesh.solids, &now = def().flesh.solids;
  if (old.size() != now.size()) return false;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const SolidId id(static_cast<std::int64_t>(i));
    if (!isSoft(old[i]) && !isSoft(now[i])) continue;
    if (old[i] != now[i] || before_->flesh->joint(id) != parts_.flesh->joint(id)) return false;
  }
  return true;
}

void CharacterBuilder::makeSoftFlesh() {
  checkSoftness();
  if (std::ranges::none_of(def().flesh.solids, isSoft)) return;
  parts_.softFlesh = keepsSoftFlesh() ? before_->softFlesh
                                      : std::make_shared<SoftFlesh>(def().flesh, *parts_.flesh,
                                                                    "/solids", diagnostics_);
}

// Whether motions find joints, solids and parameters under the numbers that they had.
bool CharacterBuilder::keepsBindings() const {
  return before_ && before_->morphs == parts_.morphs &&
         (before_->skeleton == parts_.skeleton ||
          sameStructure(before_->def->skeleton, def().skeleton)) &&
         (before_->flesh == parts_.flesh || sameStructure(before_->def->flesh, def().flesh)) &&
         (before_->ornaments == parts_.ornaments ||
          sameStructure(before_->def->ornaments, def().ornaments));
}

void CharacterBuilder::bindMotions() {
  const std::vector<MotionDef>& motions = def().motions;
  const bool keeps = keepsBindings();
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const std::string pointer = "/motions/" + std::to_string(i);
    if (keeps && i < before_->def->motions.size() && before_->def->motions[i] == motions[i])
      parts_.clips.push_back(before_->clips[i]);
    else
      parts_.clips.push_back(std::make_shared<BoundClip>(
          bindMotion(motions[i], {*parts_.skeleton, *parts_.flesh, *parts_.morphs},
                     *parts_.ornaments, pointer, diagnostics_)));
    const auto before = motions.begin() + static_cast<std::ptrdiff_t>(i);
    if (std::find_if(motions.begin(), before,
                     [&](const MotionDef& m) { return m.name == motions[i].name; }) != before)
      diagnostics_.error(pointer + "/name", "found '" + motions[i].name + "' a second time",
                         "give every motion a name of its own");
  }
  if (def().rig && def().rig->model) bindRigMotions();
}

// The rig's motions come after the character's own; one that has the name of an own one is hidden.
void CharacterBuilder::bindRigMotions() {
  const std::shared_ptr<const RiggedModel>& model = def().rig->model;
  const bool keeps =
      before_ && before_->skeleton == parts_.skeleton && before_->def->rig == def().rig;
  std::vector<SampledFrame> frames;
  const std::vector<std::string> names = def().rig->jointNames();
  for (std::size_t j = 0; j < names.size(); ++j) {
    const int parent = model->joints[j].parent;
    frames.push_back({names[j], parent < 0 ? "" : names[static_cast<std::size_t>(parent)],
                      model->joints[j].rest_world});
  }
  for (const SampledMotion& motion : model->motions) {
    if (std::ranges::any_of(parts_.clips, [&](const auto& c) { return c->name == motion.name; }))
      continue;
    const auto before = [&](const auto& c) { return c->sampled.get() == &motion; };
    if (keeps) {
      if (const auto clip = std::ranges::find_if(before_->clips, before);
          clip != before_->clips.end()) {
        parts_.clips.push_back(*clip);
        continue;
      }
    }
    // Shares the ownership of the whole model.
    parts_.clips.push_back(std::make_shared<BoundClip>(
        bindSampled(std::shared_ptr<const SampledMotion>(model, &motion), frames,
                    {*parts_.skeleton, *parts_.flesh, *parts_.morphs}, "/rig", diagnostics_)));
    if (!diagnostics_.ok()) return;
  }
}

void CharacterBuilder::makeSkin() {
  if (!def().skin) return;
  const RiggedModel* rig = def().rig ? def().rig->model.get() : nullptr;
  const bool sameRig = before_ && before_->skin && sameMesh(before_->def->rig, def().rig);
  const bool sameBelow = sameRig && before_->def->rig == def().rig &&
                         before_->skeleton == parts_.skeleton && before_->flesh == parts_.flesh &&
                         before_->def->simulation == def().simulation;
  if (sameBelow && before_->def->skin == def().skin) {
    parts_.skin = before_->skin;
    return;
  }
  PosedSkeleton posedSkeleton;
  PosedFlesh posedFlesh;
  const Posture rest = parts_.skeleton->restPosture();
  parts_.skeleton->pose(rest, posedSkeleton);
  parts_.flesh->pose(rest, posedSkeleton, {}, posedFlesh);
  const std::vector<std::string> rigJoints =
      rig ? def().rig->jointNames() : std::vector<std::string>();
  parts_.skin = std::make_shared<Skin>(
      *def().skin, settingsOf(def().simulation, parts_.interval_s),
      SkinBase{*parts_.skeleton, *parts_.flesh, posedSkeleton, posedFlesh, rig, rigJoints}, "/skin",
      diagnostics_, sameRig ? before_->skin.get() : nullptr);
  checkIntegrator();
}

// What cannot keep this skin calm with steps of the length that is allowed is refused: its error
// control would let it swing up.
void CharacterBuilder::checkIntegrator() {
  const SimulationDef& simulation = def().simulation;
  const std::string& name = simulation.integrator;
  if (!diagnostics_.ok() || !parts_.skin->isSimulated() || name == "auto" || name == "leapfrog")
    return;
  if (name == "cloth") {
    if (!parts_.skin->isCloth())
      diagnostics_.error("/simulation/integrator",
                         "found cloth, which steps grids, expected one that steps meshes",
                         "choose auto");
    return;
  }
  const double longest_s = longestOdeStep_s(*parts_.skin);
  if (longest_s >= simulation.min_step_s) return;
  diagnostics_.error(
      "/simulation/integrator",
      "found " + name + ", which keeps this skin from swinging up only with steps of " +
          inMicroseconds(longest_s) + ", expected one that does with min_step_s (" +
          inMicroseconds(simulation.min_step_s) + ")",
      "choose auto, or an implicit one; or make the skin softer, heavier or its drag larger");
}

}  // namespace fascia
