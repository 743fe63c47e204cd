#pragma once

#include <span>
#include <vector>

#include <fascia/deformable/body/carried_mesh.h>
#include <fascia/render/character_scene.h>
#include <fascia/world/stage.h>

namespace fascia {

// The bodies, props and characters of a stage as they are at one moment.
struct StageMoment {
  // A character, in its own space: see buildScene().
  struct Actor {
    const CharacterState* state;
    const TriangleMesh* skin;
    std::shared_ptr<const Pixels> skin_texture;
    std::shared_ptr<const RigSurface> rig_surface;
  };
  std::span<const double> bodies;  // q of all
  std::vector<Actor> actors;       // in the order of SceneDef::characters
};

// Draws moments of one stage; holds what is prepared once.
class StagePictures {
 public:
  explicit StagePictures(const Stage& stage);

  // `options`: layers, camera, framing and ground; the rest comes with the actors.
  Scene scene(const StageMoment& moment, const SceneOptions& options) const;
  // What bodies and props reach at a moment.
  void addTo(std::span<const double> bodies, Reach& reach) const;

 private:
  void addBodies(std::span<const double> bodies, double height_m, Scene& scene) const;
  void addProps(Scene& scene) const;

  const Stage& stage_;
  std::vector<CarriedMesh> surfaces_;                // per body
  std::vector<std::vector<CarriedMesh>> ornaments_;  // per body
};

}  // namespace fascia
