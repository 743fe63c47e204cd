#pragma once

#include <memory>

#include <fascia/deformable/constraint/constraint.h>
#include <fascia/world/scene_def.h>

namespace fascia {

// Where a character's joint is in the scene, at any time of what moves it: a place that bodies can
// be tied to. Keeps the character alive; the source must outlive it. Not for several threads at
// once.
PointPath jointPlace(const SceneCharacterDef& character, const PostureSource& source,
                     JointId joint);

}  // namespace fascia
