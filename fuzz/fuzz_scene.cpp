// Any text either is a scene or throws Error; a scene that builds can be performed, and what moves
// in it stays finite. Nothing else is read: no characters, meshes or scripts.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include <fascia/io/documents/scene_file.h>
#include <fascia/world/performance.h>

namespace fascia {
namespace {

bool needsOtherFiles(const SceneDef& def) {
  const auto isMesh = [](const SceneBodyDef& b) { return b.form == SceneBodyDef::Form::mesh; };
  return !def.characters.empty() || std::ranges::any_of(def.bodies, isMesh);
}

// Crowds and short steps are slow, not wrong.
bool isSmall(const Stage& stage) {
  return stage.bodies().size() < 400 && stage.def().simulation.step_s >= 1e-3;
}

void perform(const Stage& stage) {
  Performance performance(stage, 1);
  for (int frame = 0; frame < 3; ++frame) performance.advance(1.0 / 60);
  for (const double q : performance.bodies().r)
    if (!std::isfinite(q)) std::abort();
}

void play(std::string_view text) {
  SceneDef def = readSceneText(text, "fuzz").def;
  readSceneText(sceneText(def), "again");
  if (needsOtherFiles(def)) return;
  const Stage stage(std::move(def));
  if (isSmall(stage)) perform(stage);
}

}  // namespace
}  // namespace fascia

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    fascia::play({reinterpret_cast<const char*>(data), size});
  } catch (const fascia::Error&) {
  }
  return 0;
}
