#include <fascia/facade/rig_pictures.h>
#include <fascia/fascia.h>
#include <fascia/render/character_scene.h>
#include <fascia/render/player.h>
#include <fascia/render/renderer.h>

namespace fascia {

void seeSurface(const Character& character, const CharacterState& state, TriangleMesh& surface) {
  if (!character.skin()) {
    surface = {};
    return;
  }
  skinSurface(*character.skin(), state.flesh, state.skin, surface);
}

struct Painter::Impl {
  Renderer renderer;
  const Character* character = nullptr;  // that the rest was made ready for
  std::shared_ptr<const RigSurface> rig;
  std::shared_ptr<const Pixels> skin;
  TriangleMesh surface;

  void prepare(const Character& next) {
    if (character == &next) return;
    character = nullptr;  // until it is ready
    surface = {};
    rig = rigSurface(next);
    skin = toPixels(loadTexture(next.def()));
    character = &next;
  }
};

Painter::Painter() : impl_(std::make_unique<Impl>()) {}
Painter::~Painter() = default;

Pixels Painter::draw(const Character& character, const CharacterState& state,
                     const PictureOptions& options) {
  SceneOptions scene;
  scene.layers = parseLayers(options.layers);
  if (!options.camera.empty()) scene.camera = parseCamera(options.camera);
  scene.ground = options.ground;
  if (options.width > 0 && options.height > 0)
    scene.aspect = static_cast<double>(options.width) / options.height;
  impl_->prepare(character);
  scene.skin_texture = impl_->skin;
  scene.rig_surface = impl_->rig;
  seeSurface(character, state, impl_->surface);
  Reach reach;
  reach.add(visibleBounds(state, impl_->surface, scene.layers));
  scene.ground_height_m = floorHeight(character, reach);
  return impl_->renderer.render(buildScene(character, state, impl_->surface, scene), options.width,
                                options.height);
}

}  // namespace fascia
