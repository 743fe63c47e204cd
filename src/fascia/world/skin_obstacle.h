#pragma once

#include <memory>
#include <vector>

#include <fascia/character/character.h>
#include <fascia/field/surface_field.h>
#include <fascia/world/scene_def.h>

namespace fascia {

// A character's skin as the bodies of a scene meet it: where the flesh carries it, without the
// dents that those bodies make, which are what pushes back. Below it the matter gives way as far as
// the flesh's solids.
class SkinObstacle {
 public:
  // `state` is posed at the start. The character must have a skin, and outlive it.
  SkinObstacle(const SceneCharacterDef& def, CharacterState& state);

  // The frame that comes, from where the last one ended; `state` is posed at its end.
  void setFrame(double start_s, double end_s, CharacterState& state);
  // Within that frame, linear between its ends.
  void moveTo(double time_s);

  const SurfaceField& field() const { return *field_; }

 private:
  void place(const CharacterState& state, std::vector<Eigen::Vector3f>& points);
  std::vector<float> depths(const CharacterState& state) const;

  const Character& character_;
  Transform place_;
  std::unique_ptr<PointPlacer> placer_;
  VectorArray skin_;
  TriangleMesh mesh_;
  double start_s_ = 0, end_s_ = 1;
  std::vector<Eigen::Vector3f> from_, to_, now_;  // in the scene
  std::unique_ptr<SurfaceField> field_;
};

}  // namespace fascia
