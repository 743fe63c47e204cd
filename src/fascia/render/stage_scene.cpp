#include <fascia/render/stage_scene.h>

#include <algorithm>

namespace fascia {
namespace {

constexpr float kJellyScatter = 0.03f;  // of the height: light inside jelly
constexpr int kPropDetail = 48;

// Bodies look like jelly, plates like painted card.
Material bodyMaterial(const SceneBodyDef& body, double height_m) {
  Material material;
  const bool plate = body.form == SceneBodyDef::Form::outline;
  material.kind = plate ? Material::Kind::plain : Material::Kind::skin;
  material.color = rgb(body.color);
  material.roughness = plate ? 0.55f : 0.3f;
  material.wrap = plate ? 0.15f : 0;
  material.scatter_m = kJellyScatter * static_cast<float>(height_m);
  return material;
}

// Dark ornaments are eyes: they must shine to look alive.
Material ornamentMaterial(const Color& color) {
  Material material;
  material.color = rgb(color);
  material.roughness = std::max({color.r, color.g, color.b}) < 0.25f ? 0.06f : 0.36f;
  return material;
}

}  // namespace

StagePictures::StagePictures(const Stage& stage) : stage_(stage) {
  for (std::size_t b = 0; b < stage.bodies().bodyCount(); ++b) {
    const BodyId id(b);
    const BodyShape& shape = stage.bodies().shape(id);
    surfaces_.emplace_back(shape, stage.look(id));
    ornaments_.emplace_back();
    for (const TriangleMesh& mesh : stage.ornaments(id))
      ornaments_.back().emplace_back(shape, mesh);
  }
}

void StagePictures::addBodies(std::span<const double> bodies, double height_m, Scene& scene) const {
  for (std::size_t b = 0; b < surfaces_.size(); ++b) {
    const SceneBodyDef& body = stage_.body(BodyId(b));
    const std::span<const double> q = stage_.bodies().part(BodyId(b), bodies);
    Drawable drawable;
    surfaces_[b].carry(q, drawable.mesh);
    drawable.material = bodyMaterial(body, height_m);
    scene.drawables.push_back(std::move(drawable));
    for (std::size_t i = 0; i < ornaments_[b].size(); ++i) {
      Drawable ornament;
      ornaments_[b][i].carry(q, ornament.mesh);
      ornament.material = ornamentMaterial(body.ornaments[i].color);
      scene.drawables.push_back(std::move(ornament));
    }
  }
}

void StagePictures::addProps(Scene& scene) const {
  for (std::size_t i = 0; i < stage_.def().props.size(); ++i) {
    const PosedFlesh& field = stage_.prop(i);
    Drawable prop;
    prop.mesh = field.solid(SolidId(0)).tessellate(kPropDetail);
    prop.world = field.frame(SolidId(0));
    prop.material.color = rgb(stage_.def().props[i].color);
    prop.material.roughness = 0.6f;
    scene.drawables.push_back(std::move(prop));
  }
}

void StagePictures::addTo(std::span<const double> bodies, Reach& reach) const {
  TriangleMesh mesh;
  for (std::size_t b = 0; b < surfaces_.size(); ++b) {
    mesh = {};
    surfaces_[b].carry(stage_.bodies().part(BodyId(b), bodies), mesh);
    for (const Eigen::Vector3f& p : mesh.positions) reach.add(p.cast<double>());
  }
  for (std::size_t i = 0; i < stage_.def().props.size(); ++i)
    reach.add(stage_.prop(i).bounds(SolidId(0)));
}

Scene StagePictures::scene(const StageMoment& moment, const SceneOptions& options) const {
  Scene scene;
  const bool reached = options.reach && !options.reach->empty();
  const Box framing = reached ? options.reach->box() : options.framing;
  const double height_m = framing.empty() ? 1.0 : framing.size().maxCoeff();
  if (options.layers.skin) addBodies(moment.bodies, height_m, scene);
  addProps(scene);
  for (std::size_t i = 0; i < moment.actors.size(); ++i) {
    const StageMoment::Actor& actor = moment.actors[i];
    SceneOptions own = options;
    own.skin_texture = actor.skin_texture;
    own.rig_surface = actor.rig_surface;
    const std::size_t first = scene.drawables.size();
    addCharacter(*stage_.def().characters[i].character, *actor.state, *actor.skin, own, height_m,
                 scene);
    for (std::size_t d = first; d < scene.drawables.size(); ++d)
      scene.drawables[d].world = placeOf(stage_.def().characters[i]) * scene.drawables[d].world;
  }
  if (options.ground) scene.drawables.push_back(groundDisc(framing, options.ground_height_m));
  scene.camera = reached ? frameReach(options.camera, *options.reach, options.aspect)
                         : frameBox(options.camera, framing, options.aspect);
  standLights(scene);
  return scene;
}

}  // namespace fascia
