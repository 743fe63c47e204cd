#include "scene_facts.h"

#include <fmt/format.h>

namespace fascia {
namespace {

void addBodies(const Stage& stage, Facts& facts) {
  Json::List bodies;
  std::vector<std::string> texts;
  for (std::size_t b = 0; b < stage.bodies().bodyCount(); ++b) {
    const BodyShape& shape = stage.bodies().shape(BodyId(b));
    const std::string& name = stage.body(BodyId(b)).name;
    bodies.push_back(Json::Object{{"name", name},
                                  {"mass_kg", shape.mass_kg()},
                                  {"coordinates", shape.coordinateCount()},
                                  {"basis", std::string(shape.basis().name())}});
    texts.push_back(fmt::format("{}, {:.4g} kg, {}, {} coordinates", name, shape.mass_kg(),
                                shape.basis().name(), shape.coordinateCount()));
  }
  facts.add("bodies", std::move(bodies), texts);
}

void addPlaces(const SceneDef& def, Facts& facts) {
  Json::List places;
  std::vector<std::string> texts;
  for (const NamedPlaceDef& place : def.places) {
    const Vec3& p = place.position_m;
    places.push_back(
        Json::Object{{"name", place.name}, {"position_m", Json::List{p.x(), p.y(), p.z()}}});
    texts.push_back(fmt::format("{} at {:g}, {:g}, {:g} m", place.name, p.x(), p.y(), p.z()));
  }
  facts.add("places", std::move(places), texts);
}

void addActors(const SceneDef& def, Facts& facts) {
  Json::List characters;
  std::vector<std::string> texts;
  for (const SceneCharacterDef& actor : def.characters) {
    const int motion = actor.character->findMotion(actor.motion);
    const std::string does =
        motion < 0 ? "" : actor.character->motion(static_cast<std::size_t>(motion)).name;
    characters.push_back(
        Json::Object{{"name", actor.name}, {"file", actor.file}, {"motion", does}});
    texts.push_back(
        fmt::format("{}, {}{}{}", actor.name, actor.file, does.empty() ? "" : ", does ", does));
  }
  facts.add("characters", std::move(characters), texts);
}

}  // namespace

void addScene(const Stage& stage, Facts& facts) {
  const SceneDef& def = stage.def();
  facts.add("name", def.name);
  if (!def.description.empty()) facts.add("description", def.description);
  facts.add("dimension", def.dimension);
  addBodies(stage, facts);
  facts.add("coordinates", count(stage.bodies().size()));
  facts.add("constraints", count(def.constraints.size()));
  facts.add("paths", count(def.paths.size()));
  addPlaces(def, facts);
  addActors(def, facts);
  facts.add("props", count(def.props.size()));
  if (def.ground) facts.add("ground_m", def.ground->height_m);
  if (!def.script.empty()) facts.add("script", def.script);
  facts.add("scheme", def.simulation.scheme);
  facts.add("duration_s", def.simulation.duration_s);
  facts.add("frame_rate_hz", def.simulation.frame_rate_hz);
}

void addPerformance(const Stage& stage, const StageRecording& recording, Facts& facts) {
  constexpr const char* kOutcomes[] = {"none", "succeeded", "failed"};
  facts.add("frames", count(recording.frames.size()));
  facts.add("recorded_hz", recording.frame_rate_hz);
  facts.add("simulated_s", recording.simulated_s);
  facts.add("outcome", std::string(kOutcomes[static_cast<std::size_t>(recording.outcome)]));
  if (!recording.reason.empty()) facts.add("reason", recording.reason);
  std::vector<std::string> troubles;
  Json::List texts;
  for (const BodyTrouble& trouble : recording.troubles) {
    troubles.push_back(textOf(stage, trouble));
    texts.push_back(troubles.back());
  }
  const bool sound = !anyFault(recording.troubles);
  facts.add("sound", sound, std::string(sound ? "yes" : "no"));
  facts.add("troubles", std::move(texts), troubles);
  facts.add("state_hash", fmt::format("{:016x}", recording.state_hash));
}

}  // namespace fascia
