// Any text either is a character or throws Error; a character that builds can be run.
#include <algorithm>
#include <cstdint>
#include <string_view>

#include <fascia/io/documents/character_file.h>

namespace {

// Small files that describe large grids or many solids are slow, not wrong.
bool isSmall(const fascia::CharacterDef& def) {
  std::size_t cost = def.skeleton.joints.size() + 10 * def.flesh.solids.size();
  if (def.skin) cost += def.skin->brushes.size() + def.skin->regions.size();
  // Meshing a surface and summing matter up take seconds under the sanitizers.
  if (def.skin && def.skin->surface) return false;
  if (std::ranges::any_of(def.flesh.solids,
                          [](const auto& solid) { return solid.soft.has_value(); }))
    return false;
  return cost < 200 && def.simulation.settle_s <= 1 &&
         (!def.skin || !def.skin->points ||
          def.skin->points->columns * def.skin->points->rows < 1000);
}

void buildAndRun(const fascia::CharacterFile& file) {
  fascia::BuildOptions options;
  options.columns = 8;
  options.rows = 8;
  options.integrator = "auto";
  const fascia::Character character = fascia::buildCharacter(file, options);
  const fascia::ClipSource source = character.source(character.motionCount() > 0 ? 0 : -1);
  fascia::CharacterState state = fascia::initialState(character, source);
  fascia::SkinStats stats;
  for (int frame = 0; frame < 3; ++frame) {
    fascia::advance(character, source, 1.0 / 30, state, stats);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const fascia::CharacterFile file = fascia::readCharacterText(text, "fuzz");
    fascia::readCharacterText(fascia::characterText(file.def), "again");
    if (isSmall(file.def)) buildAndRun(file);
  } catch (const fascia::Error&) {
  }
  return 0;
}
