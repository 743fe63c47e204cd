#include <fascia/world/stage.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>

#include <fascia/base/random.h>
#include <fascia/base/suggest.h>
#include <fascia/deformable/matter/matter.h>
#include <fascia/skeleton/euler.h>
#include <fascia/world/inflate.h>
#include <fascia/world/outline_curve.h>

namespace fascia {
namespace {

constexpr int kSurfaceDetail = 64;  // segments around a solid
constexpr int kOrnamentDetail = 24;
constexpr const char* kWorld = "world";  // the joint that things stand on
constexpr double kCellsAcross =
    16;  // the thinnest side of a solid or mesh, where its mass is summed
constexpr std::size_t kMostCells = 4'000'000;
// Every body has a square matrix of its coordinates: numbers of all of them together.
constexpr std::size_t kMostMatrixNumbers = 50'000'000;

Transform placeOf(const Vec3& position_m, const Vec3& orientation_rad) {
  return {rotationZyx(orientation_rad), position_m};
}

double cellSize(const Vec3& size_m) {
  const double volume = std::max(size_m.prod(), 1e-18);
  return std::max(size_m.minCoeff() / kCellsAcross, std::cbrt(volume / kMostCells));
}

Vec3 randomIn(const Vec3& reach, Random& random) {
  Vec3 out;
  for (int a = 0; a < 3; ++a) out[a] = random.uniform(-reach[a], reach[a]);
  return out;
}

// What a body is made of, as far as it has to be made anew for another kind of body.
struct Form {
  BodySurfacePtr surface;
  BasisPtr basis;
  std::function<Matter(MatterDetail)> matter;  // costs most: not before all else is checked
};

Form solidForm(const SceneBodyDef& def, const std::string& pointer, Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.errors().size();
  const Solid solid(def.solid, pointer, diagnostics);
  if (diagnostics.errors().size() > before) return {};
  const Box& box = solid.bounds();
  return {makeSolidSurface(solid, kSurfaceDetail), makeBasis(def.basis, 3, box),
          [&def, solid, box](MatterDetail detail) {
            return solidMatter(solid, def.density_kg_per_m3, cellSize(box.size()), detail);
          }};
}

Form outlineForm(const SceneBodyDef& def) {
  const std::vector<Vec2> outline = def.smooth_outline ? closedCurve(def.outline_m) : def.outline_m;
  const BodySurfacePtr surface = makeOutlineSurface(outline, def.thickness_m);
  return {surface, makeBasis(def.basis, 2, surface->bounds_m()),
          [&def, outline](MatterDetail detail) {
            return outlineMatter(outline, def.density_kg_per_m3 * def.thickness_m, detail);
          }};
}

Form meshForm(const SceneBodyDef& def) {
  const BodySurfacePtr surface = makeMeshSurface(*def.mesh);
  const Box box = surface->bounds_m();
  return {surface, makeBasis(def.basis, 3, box), [&def, box](MatterDetail detail) {
            return meshMatter(*def.mesh, def.density_kg_per_m3, cellSize(box.size()), detail);
          }};
}

Form formOf(const SceneBodyDef& def, const std::string& pointer, Diagnostics& diagnostics) {
  if (def.form == SceneBodyDef::Form::outline) return outlineForm(def);
  if (def.form == SceneBodyDef::Form::mesh) return meshForm(def);
  return solidForm(def, pointer, diagnostics);
}

// A solid's surface in the space it is placed in.
TriangleMesh placedMesh(const PlacedSolidDef& def, const Solid& solid) {
  TriangleMesh mesh = solid.tessellate(kOrnamentDetail);
  const Transform place = placeOf(def.position_m, def.orientation_rad);
  for (Eigen::Vector3f& p : mesh.positions) p = place.point(p.cast<double>()).cast<float>();
  for (Eigen::Vector3f& n : mesh.normals) n = place.vector(n.cast<double>()).cast<float>();
  return mesh;
}

void raise(double z_m, TriangleMesh& mesh) {
  for (Eigen::Vector3f& p : mesh.positions) p.z() += static_cast<float>(z_m);
}

// Plates lie in layers, which their z says; it means nothing to their motion.
TriangleMesh lookOf(const SceneBodyDef& def, const BodySurface& surface) {
  TriangleMesh mesh = surface.mesh();
  if (def.form != SceneBodyDef::Form::outline) return mesh;
  if (def.inflated) inflate(surface, mesh);
  raise(def.position_m.z(), mesh);
  return mesh;
}

bool sameSolid(const SolidDef& a, const SolidDef& b) {
  const auto sameStep = [](const SolidDef::Step& x, const SolidDef::Step& y) {
    return x.type == y.type && x.parameters == y.parameters;
  };
  return a.shape == b.shape && a.parameters == b.parameters &&
         std::ranges::equal(a.deformations, b.deformations, sameStep);
}

// Whether one shape, surface and look does for both.
bool sameKind(const SceneBodyDef& a, const SceneBodyDef& b) {
  const auto numbersOf = [](const SceneBodyDef& d) {
    return std::array{d.density_kg_per_m3,
                      d.rigidity_Pa,
                      d.volume_Pa,
                      d.relaxation_s,
                      d.power_damping_s_per_J,
                      d.drag_per_s,
                      d.thickness_m,
                      d.form == SceneBodyDef::Form::outline ? d.position_m.z() : 0};
  };
  if (a.form != b.form || !(a.basis == b.basis) || numbersOf(a) != numbersOf(b)) return false;
  switch (a.form) {
    case SceneBodyDef::Form::outline:
      return a.outline_m == b.outline_m && a.smooth_outline == b.smooth_outline &&
             a.inflated == b.inflated;
    case SceneBodyDef::Form::mesh:
      return a.mesh_file == b.mesh_file;
    case SceneBodyDef::Form::solid:
      break;
  }
  return sameSolid(a.solid, b.solid);
}

void repeatedNames(const auto& list, const std::string& pointer, Diagnostics& diagnostics) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < list.size(); ++i)
    if (!names.insert(list[i].name).second)
      diagnostics.error(entryOf(pointer, i) + "/name",
                        "found " + quotedName(list[i].name) + " a second time",
                        "give each a name of its own");
}

}  // namespace

Stage::Stage(SceneDef def) : def_(std::move(def)) {
  Diagnostics diagnostics;
  if (def_.dimension != 2 && def_.dimension != 3)
    diagnostics.error("/dimension",
                      "found " + std::to_string(def_.dimension) + ", expected 2 or 3");
  validateValues(def_, diagnostics);
  checkScheme(diagnostics);
  repeatedNames(def_.bodies, "/bodies", diagnostics);
  repeatedNames(def_.places, "/places", diagnostics);
  // Parts of what is wrong would only make more faults below.
  diagnostics.throwIfErrors();
  for (std::size_t i = 0; i < def_.bodies.size(); ++i) addBody(i, diagnostics);
  addProps(diagnostics);
  diagnostics.throwIfErrors();
  addNames(diagnostics);
  checkConstraints(diagnostics);
  checkPaths(diagnostics);
  diagnostics.throwIfErrors();
  warnOfIdleSettings(def_, diagnostics);
  warnings_ = diagnostics.warnings();
  for (const SceneCharacterDef& character : def_.characters)
    if (character.character)
      warnings_.insert(warnings_.end(), character.character->warnings().begin(),
                       character.character->warnings().end());
}

void Stage::addBody(std::size_t index, Diagnostics& diagnostics) {
  const SceneBodyDef& body = def_.bodies[index];
  const std::string pointer = entryOf("/bodies", index);
  const bool flat = body.form == SceneBodyDef::Form::outline;
  if (flat != (def_.dimension == 2)) {
    diagnostics.error(pointer,
                      flat ? "an outline is a body in two dimensions, the scene has three"
                           : "found a solid, but the scene's bodies have two dimensions",
                      flat ? "set \"dimension\": 2" : "give it an \"outline_m\"");
    return;
  }
  try {
    addKind(body, pointer, diagnostics);
  } catch (const Error& error) {
    for (const Issue& issue : error.issues())
      diagnostics.error(pointer + issue.where.pointer, issue.message, issue.hint);
    return;
  }
  std::vector<TriangleMesh> meshes;
  for (std::size_t i = 0; i < body.ornaments.size(); ++i) {
    const Solid solid(body.ornaments[i].solid, entryOf(pointer + "/ornaments", i), diagnostics);
    if (!diagnostics.ok()) continue;
    meshes.push_back(placedMesh(body.ornaments[i], solid));
    if (flat) raise(body.position_m.z(), meshes.back());
  }
  ornaments_.push_back(std::move(meshes));
}

// The shape, surface and look of a body: those of an earlier one where the two differ in nothing
// that matters to them.
void Stage::addKind(const SceneBodyDef& body, const std::string& pointer,
                    Diagnostics& diagnostics) {
  const auto known = std::ranges::find_if(
      kinds_, [&](std::size_t kind) { return sameKind(def_.bodies[kind], body); });
  if (known != kinds_.end()) {
    countNumbers(shapes_[*known]->coordinateCount());
    shapes_.push_back(shapes_[*known]);
    surfaces_.push_back(surfaces_[*known]);
    looks_.push_back(looks_[*known]);
  } else {
    kinds_.push_back(shapes_.size());
    Form form = formOf(body, pointer, diagnostics);
    if (!form.basis) return;
    countNumbers(form.basis->size() * form.basis->dimension());
    const MatterDetail detail = MatterDetail::of(*form.basis);
    const bool implicit = def_.simulation.scheme == "implicit";
    const Crushing crushing = implicit ? Crushing::resisted : Crushing::free;
    shapes_.push_back(std::make_shared<const BodyShape>(
        BodyDef{form.basis, form.matter(detail), body, crushing}));
    looks_.push_back(lookOf(body, *form.surface));
    surfaces_.push_back(std::move(form.surface));
  }
  model_.add(shapes_.back());
}

void Stage::countNumbers(int coordinates) {
  const auto n = static_cast<std::size_t>(coordinates);
  matrixNumbers_ += n * n;
  if (matrixNumbers_ <= kMostMatrixNumbers) return;
  Issue issue{{},
              "the bodies up to this one have too many coordinates to simulate",
              "use fewer bodies, or bases with fewer functions"};
  throw Error(issue);
}

// A thing that stands is flesh on a joint that never moves: what collides with characters collides
// with it.
void Stage::addProps(Diagnostics& diagnostics) {
  SkeletonDef def;
  def.joints.emplace_back().name = kWorld;
  const Skeleton skeleton(def, "", diagnostics);
  PosedSkeleton posed;
  const Posture rest = skeleton.restPosture();
  skeleton.pose(rest, posed);
  for (std::size_t i = 0; i < def_.props.size(); ++i) {
    const PlacedSolidDef& prop = def_.props[i];
    Diagnostics own;
    FleshDef flesh;
    FleshSolidDef& solid = flesh.solids.emplace_back();
    solid.name = prop.name;
    solid.joint = kWorld;
    solid.position_m = prop.position_m;
    solid.orientation_rad = prop.orientation_rad;
    solid.solid = prop.solid;
    props_.push_back({Flesh(flesh, skeleton, "", own), {}});
    for (const Issue& issue : own.errors())  // "/0/radius_m": the solid is the only one of its kind
      diagnostics.error(entryOf("/props", i) + issue.where.pointer.substr(2), issue.message,
                        issue.hint);
    if (own.ok()) props_.back().flesh.pose(rest, posed, {}, props_.back().posed);
  }
}

std::size_t Stage::stepsPerFrame(double frameRate_hz) const {
  const double steps = 1 / (frameRate_hz * def_.simulation.step_s);
  return static_cast<std::size_t>(std::max(1.0, std::ceil(steps - 1e-9)));
}

OdeState Stage::startState(std::uint64_t seed) const {
  OdeState state = model_.restState();
  Random random(seed);
  for (std::size_t b = 0; b < def_.bodies.size(); ++b) {
    const SceneBodyDef& body = def_.bodies[b];
    ScatterDef scatter;
    if (seed != 0) {
      scatter.position_m = randomIn(body.scatter.position_m, random);
      scatter.orientation_rad = randomIn(body.scatter.orientation_rad, random);
      scatter.velocity_m_per_s = randomIn(body.scatter.velocity_m_per_s, random);
    }
    const BodyId id(b);
    const Transform place = placeOf(body.position_m + scatter.position_m,
                                    body.orientation_rad + scatter.orientation_rad);
    model_.place(id, place, state);
    const Twist twist{body.velocity_m_per_s + scatter.velocity_m_per_s, body.spin_rad_per_s,
                      place.point(model_.shape(id).center_m())};
    const std::span<const double> q = model_.part(id, std::span<const double>(state.r));
    model_.shape(id).setRigidVelocity(q, twist, model_.part(id, std::span<double>(state.v)));
  }
  return state;
}

}  // namespace fascia
