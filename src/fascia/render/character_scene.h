#pragma once

#include <memory>
#include <string_view>

#include <fascia/character/character.h>
#include <fascia/render/rig_surface.h>
#include <fascia/render/scene.h>

namespace fascia {

struct Layers {
  bool skeleton = false, muscle = false, skin = true;
};

// "skin", "skeleton,muscle,skin", "all": any of the three, separated by commas. Throws Error.
Layers parseLayers(std::string_view text);

struct SceneOptions {
  Layers layers;
  std::shared_ptr<const Pixels> skin_texture;     // null: the skin's plain colour
  std::shared_ptr<const RigSurface> rig_surface;  // of an imported character; null: made each time
  bool ground = true;
  double ground_height_m = 0;  // where characters stand
  CameraSpec camera;
  Box framing;  // what the camera frames, e.g. over a whole motion; empty = this frame
  const Reach* reach = nullptr;  // instead of `framing`, more tightly; must outlive the call
  double aspect = 16.0 / 9;
  int ornament_detail = 24;  // segments around at most; more do not show
  int muscle_detail = 40;    // … of muscles, whose fibres follow the facets
};

// Whether the skin is an imported mesh.
bool hasRig(const Character& character);

// The picture of a character at one moment. `skin` is its surface in that state (skinSurface, or a
// recording's frame); it may be empty. Only skeleton, flesh and ornaments of the state are read, so
// a state whose skin was played from a file does as well. The surface of an imported character is
// in the order of its RiggedModel::vertices, with normals.
Scene buildScene(const Character& character, const CharacterState& state, const TriangleMesh& skin,
                 const SceneOptions& options);

// Its parts: a character's drawables, in its own space, for a picture of things about height_m
// tall; and the lights, which stand around the photographer, so that every view is well lit.
void addCharacter(const Character& character, const CharacterState& state, const TriangleMesh& skin,
                  const SceneOptions& options, double height_m, Scene& scene);
void standLights(Scene& scene);

// What there is to see of a character with these layers: for framing a motion, add the boxes of its
// frames.
Box visibleBounds(const CharacterState& state, const TriangleMesh& skin, const Layers& layers);

}  // namespace fascia
