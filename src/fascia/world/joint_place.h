#pragma once

#include <memory>

#include <fascia/deformable/constraint/constraint.h>
#include <fascia/world/scene_def.h>

namespace fascia {

// Where a character's joint is in the scene, at any time of its motion: a place that bodies can be
// tied to. Keeps the character alive. Not for several threads at once.
PointPath jointPlace(const SceneCharacterDef& character, int motion, JointId joint);

}  // namespace fascia
