#include <fascia/world/scene_def.h>

#include <fascia/skeleton/euler.h>

namespace fascia {

Transform placeOf(const SceneCharacterDef& character) {
  return {rotationZyx({0, character.heading_rad, 0}), character.position_m};
}

}  // namespace fascia
