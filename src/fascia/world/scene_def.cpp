#include <fascia/world/scene_def.h>

#include <fascia/character/idle_settings.h>
#include <fascia/skeleton/euler.h>

namespace fascia {
namespace {

void validateAll(const auto& list, const std::string& pointer, Diagnostics& diagnostics) {
  for (std::size_t i = 0; i < list.size(); ++i)
    validateTunables(list[i], entryOf(pointer, i), diagnostics);
}

void validatePlaces(const std::vector<NamedPlaceDef>& places, const std::string& pointer,
                    Diagnostics& diagnostics) {
  for (const NamedPlaceDef& place : places)
    for (int axis = 0; axis < 3; ++axis)
      checkNumber(kNamedPlace, place.position_m[axis],
                  entryOf(pointer + '/' + place.name, static_cast<std::size_t>(axis)), diagnostics);
}

void validateBody(const SceneBodyDef& body, const std::string& pointer, Diagnostics& diagnostics) {
  validate(body.basis, pointer + "/basis", diagnostics);
  validateTunables(body, pointer, diagnostics);
  validateTunables(body.scatter, pointer + "/scatter", diagnostics);
  validatePlaces(body.points, pointer + "/points", diagnostics);
  validateAll(body.ornaments, pointer + "/ornaments", diagnostics);
  if (body.form != SceneBodyDef::Form::outline) return;
  checkNumber(kPlateThickness, body.thickness_m, pointer + "/thickness_m", diagnostics);
  for (std::size_t i = 0; i < body.outline_m.size(); ++i)
    for (int axis = 0; axis < 2; ++axis)
      checkNumber(kNamedPlace, body.outline_m[i][axis],
                  entryOf(entryOf(pointer + "/outline_m", i), static_cast<std::size_t>(axis)),
                  diagnostics);
}

}  // namespace

Transform placeOf(const SceneCharacterDef& character) {
  return {rotationZyx({0, character.heading_rad, 0}), character.position_m};
}

void validateValues(const SceneDef& scene, Diagnostics& diagnostics) {
  validateTunables(scene.simulation, "/simulation", diagnostics);
  validateTunables(scene.view, "/view", diagnostics);
  if (scene.ground) validateTunables(*scene.ground, "/ground", diagnostics);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    validateBody(scene.bodies[i], entryOf("/bodies", i), diagnostics);
  validatePlaces(scene.places, "/places", diagnostics);
  validateAll(scene.constraints, "/constraints", diagnostics);
  validateAll(scene.paths, "/paths", diagnostics);
  for (std::size_t i = 0; i < scene.paths.size(); ++i)
    validateAll(scene.paths[i].keys, entryOf("/paths", i) + "/keys", diagnostics);
  validateAll(scene.characters, "/characters", diagnostics);
  validateAll(scene.props, "/props", diagnostics);
}

void warnOfIdleSettings(const SceneDef& scene, Diagnostics& diagnostics) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (!scene.bodies[i].collides)
      warnOfIdleRows(scene.bodies[i], entryOf("/bodies", i), {"friction"},
                     {"the body touches nothing", "set \"collides\", or leave it out"},
                     diagnostics);
  using Kind = SceneConstraintDef::Kind;
  for (std::size_t i = 0; i < scene.constraints.size(); ++i) {
    const SceneConstraintDef& def = scene.constraints[i];
    const auto rows = [&](std::initializer_list<std::string_view> keys, const char* why) {
      warnOfIdleRows(def, entryOf("/constraints", i), keys, {why, "leave it out"}, diagnostics);
    };
    if (def.kind != Kind::line && def.kind != Kind::plane)
      rows({"direction"}, "only lines and planes have a direction");
    if (def.kind != Kind::rod && def.kind != Kind::spring)
      rows({"length_m"}, "only rods and springs have a length");
    if (def.kind != Kind::spring)
      rows({"stiffness_N_per_m", "damping_Ns_per_m"}, "only springs give way");
  }
}

std::vector<std::string_view> bodySchemes() {
  return {"implicit", "explicit", "energy"};
}

}  // namespace fascia
