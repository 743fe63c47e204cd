#include <fascia/render/character_scene.h>

#include <algorithm>
#include <cmath>
#include <string>

#include <fascia/base/error.h>
#include <fascia/render/bone_mesh.h>
#include <fascia/render/smooth_mesh.h>

namespace fascia {
namespace {

constexpr float kSkinScatter = 0.045f;         // of the height: light inside skin; larger: wax
constexpr float kVeilOpacity = 0.24f;          // of skin that shows the layers below
constexpr std::size_t kSkinTriangles = 5'000;  // fewer: corners show in the outline
constexpr float kTendonAspect = 1.25f;         // rounder solids are drawn without tendons

bool isVeil(const Layers& layers) {
  return layers.skeleton || layers.muscle;
}

Material skinMaterial(const Character& character, const SceneOptions& options, double height_m) {
  Material material;
  material.kind = Material::Kind::skin;
  material.texture = options.skin_texture;
  if (!material.texture && character.def().skin) {
    const auto& color = character.def().skin->color;
    material.color = Rgb(color[0], color[1], color[2]);
  } else {
    material.color = Rgb::Ones();
  }
  material.roughness = 0.5f;
  material.scatter_m = kSkinScatter * static_cast<float>(height_m);
  if (isVeil(options.layers)) {
    material.opacity = kVeilOpacity;
    material.texture = nullptr;  // a pattern would compete with what it is to show
    material.color = Rgb(0.88f, 0.72f, 0.63f);
  }
  return material;
}

TriangleMesh pictureMesh(const TriangleMesh& skin) {
  if (skin.normals.size() == skin.positions.size()) return smoothed(skin, kSkinTriangles);
  TriangleMesh mesh = skin;
  computeNormals(mesh.positions, mesh.triangles, mesh.normals);
  return smoothed(mesh, kSkinTriangles);
}

void addGridSkin(const Character& character, const TriangleMesh& skin, const SceneOptions& options,
                 double height_m, Scene& scene) {
  Drawable surface;
  surface.mesh = pictureMesh(skin);
  surface.material = skinMaterial(character, options, height_m);
  scene.drawables.push_back(std::move(surface));
}

void addRigSkin(const Character& character, const TriangleMesh& skin, const SceneOptions& options,
                double height_m, Scene& scene) {
  RigSurface::Look look;
  if (const auto& def = character.def().skin) look.color = Rgb(def->color.data());
  look.scatter_m = kSkinScatter * static_cast<float>(height_m);
  if (isVeil(options.layers)) look.veil = kVeilOpacity;
  if (options.rig_surface)
    options.rig_surface->addTo(scene, skin, look);
  else
    RigSurface(character.def().rig->model).addTo(scene, skin, look);
}

// Coordinates in [-1, 1]³ with the longest side of the solid along z, where fibres run. A solid
// that is nearly round stays inside the range that the shader draws as tendon.
std::vector<Eigen::Vector3f> fibreCoordinates(const TriangleMesh& mesh) {
  Box box;
  for (const auto& p : mesh.positions) box.add(p.cast<double>());
  if (box.empty()) return {};
  const Eigen::Vector3f center = box.center().cast<float>();
  const Eigen::Vector3f half = (0.5 * box.size()).cwiseMax(1e-9).cast<float>();
  // Round solids take y, up in most joints' frames; a pole that faces the viewer looks odd.
  Eigen::Index longest = 1;
  for (const Eigen::Index axis : {0, 2})
    if (half[axis] > 1.05f * half[longest]) longest = axis;
  const Eigen::Index side = (longest + 1) % 3, other = (longest + 2) % 3;
  const bool slender = half[longest] > kTendonAspect * std::max(half[side], half[other]);
  const float reach = slender ? 1.f : 0.55f;
  std::vector<Eigen::Vector3f> result;
  result.reserve(mesh.positions.size());
  for (const auto& p : mesh.positions) {
    const Eigen::Vector3f q = (p - center).cwiseQuotient(half);
    result.emplace_back(q[side], q[other], reach * q[longest]);
  }
  return result;
}

void addMuscles(const Character& character, const CharacterState& state,
                const SceneOptions& options, double height_m, Scene& scene) {
  for (std::size_t i = 0; i < state.flesh.solidCount(); ++i) {
    const SolidId id(static_cast<std::int64_t>(i));
    Drawable muscle;
    // Fibres run through the undeformed matter and bend with it.
    muscle.mesh = state.flesh.rigid().solid(id).tessellate(options.muscle_detail);
    muscle.fibre_coordinates = fibreCoordinates(muscle.mesh);
    const SolidId soft = state.flesh.softOf(id);
    if (soft.valid())
      deform(state.flesh.soft().map(soft), muscle.mesh);
    else
      muscle.world = state.flesh.frame(id);
    muscle.material.kind = Material::Kind::muscle;
    muscle.material.color = rgb(character.flesh().def(id).color);
    muscle.material.roughness = 0.36f;
    muscle.material.scatter_m = kSkinScatter * static_cast<float>(height_m);
    scene.drawables.push_back(std::move(muscle));
  }
}

// Eyes must shine to look alive; beaks and claws are horn. Files give a colour only, so the name
// and the darkness decide.
float ornamentRoughness(const FleshSolidDef& def) {
  const bool eye =
      def.name.find("eye") != std::string::npos || def.name.find("pupil") != std::string::npos;
  const bool dark = std::max({def.color.r, def.color.g, def.color.b}) < 0.25f;
  return eye || dark ? 0.06f : 0.36f;
}

// Segments around a solid, so that its outline is round in a picture as high as height_m: flat
// pieces of a circle dip by radius · (1 − cos(π / segments)).
int segmentsFor(const Solid& solid, double height_m, int most) {
  constexpr double kDip = 3e-4;  // of the height: a quarter of a pixel of 720
  constexpr double kFewest = 10;
  const double radius_m = 0.5 * solid.bounds().size().maxCoeff();
  const double segments = kPi * std::sqrt(radius_m / (2 * kDip * height_m));
  return static_cast<int>(
      std::ceil(std::clamp(segments, kFewest, std::max<double>(kFewest, most))));
}

void addOrnaments(const Character& character, const CharacterState& state,
                  const SceneOptions& options, double height_m, Scene& scene) {
  for (std::size_t i = 0; i < state.ornaments.solidCount(); ++i) {
    const SolidId id(static_cast<std::int64_t>(i));
    const FleshSolidDef& def = character.ornaments().def(id);
    Drawable ornament;
    const Solid& solid = state.ornaments.solid(id);
    ornament.mesh = solid.tessellate(segmentsFor(solid, height_m, options.ornament_detail));
    ornament.world = state.ornaments.frame(id);
    ornament.material.color = rgb(def.color);
    ornament.material.roughness = ornamentRoughness(def);
    scene.drawables.push_back(std::move(ornament));
  }
}

void addBones(const Character& character, const CharacterState& state, bool insideMuscle,
              Scene& scene) {
  Drawable bones;
  const Skeleton& skeleton = character.skeleton();
  bones.mesh = boneMesh(skeleton, state.skeleton,
                        hasRig(character) ? boneSizes(skeleton, *character.def().rig->model,
                                                      character.def().rig->jointNames())
                                          : boneSizes(skeleton));
  bones.material.kind = Material::Kind::bone;
  bones.material.color = Rgb(0.93f, 0.89f, 0.79f);
  bones.material.roughness = 0.42f;
  bones.material.xray = insideMuscle ? 0.62f : 0.f;
  scene.drawables.push_back(std::move(bones));
}

}  // namespace

bool hasRig(const Character& character) {
  return character.def().rig && character.def().rig->model;
}

Layers parseLayers(std::string_view text) {
  Layers layers{false, false, false};
  std::string_view rest = text;
  while (true) {
    const auto end = std::min(rest.find(','), rest.size());
    const std::string_view name = rest.substr(0, end);
    if (name == "skeleton" || name == "all") layers.skeleton = true;
    if (name == "muscle" || name == "all") layers.muscle = true;
    if (name == "skin" || name == "all") layers.skin = true;
    if (name != "skeleton" && name != "muscle" && name != "skin" && name != "all") {
      Issue issue;
      issue.message = "layers: unknown layer \"" + std::string(name) + "\"";
      issue.hint = "use skeleton, muscle, skin or all, separated by commas";
      throw Error(issue);
    }
    if (end == rest.size()) return layers;
    rest.remove_prefix(end + 1);
  }
}

Box visibleBounds(const CharacterState& state, const TriangleMesh& skin, const Layers& layers) {
  Box box;
  const auto addSolids = [&box](const DistanceField& flesh) {
    for (std::size_t i = 0; i < flesh.solidCount(); ++i)
      box.add(flesh.bounds(SolidId(static_cast<std::int64_t>(i))));
  };
  if (layers.skin) {
    for (const auto& p : skin.positions)
      if (p.allFinite()) box.add(p.cast<double>());
    addSolids(state.ornaments);
  }
  if (layers.muscle) addSolids(state.flesh);
  if (layers.skeleton)
    for (const Transform& joint : state.skeleton.joint_world) box.add(joint.translation_m);
  return box;
}

void addCharacter(const Character& character, const CharacterState& state, const TriangleMesh& skin,
                  const SceneOptions& options, double height_m, Scene& scene) {
  const Layers& layers = options.layers;
  if (layers.skeleton) addBones(character, state, layers.muscle, scene);
  if (layers.muscle) addMuscles(character, state, options, height_m, scene);
  if (!layers.skin) return;
  addOrnaments(character, state, options, height_m, scene);
  if (!skin.positions.empty())
    (hasRig(character) ? addRigSkin : addGridSkin)(character, skin, options, height_m, scene);
}

void standLights(Scene& scene) {
  const Vec3 back = scene.camera.eye_m - scene.camera.target_m;
  // Straight from above, atan2(0, 0) = 0: as from the front.
  scene.studio.azimuth_rad = static_cast<float>(std::atan2(back.x(), back.z()));
}

Scene buildScene(const Character& character, const CharacterState& state, const TriangleMesh& skin,
                 const SceneOptions& options) {
  Scene scene;
  const Box visible = visibleBounds(state, skin, options.layers);
  const bool reached = options.reach && !options.reach->empty();
  const Box framing = reached                   ? options.reach->box()
                      : options.framing.empty() ? visible
                                                : options.framing;
  const double height_m = framing.empty() ? 1.0 : framing.size().maxCoeff();

  addCharacter(character, state, skin, options, height_m, scene);
  if (options.ground) scene.drawables.push_back(groundDisc(framing, options.ground_height_m));
  scene.camera = reached ? frameReach(options.camera, *options.reach, options.aspect)
                         : frameBox(options.camera, framing, options.aspect);
  standLights(scene);
  return scene;
}

}  // namespace fascia
