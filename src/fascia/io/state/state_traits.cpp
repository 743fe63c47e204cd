#include <fascia/io/state/state_traits.h>

#include <array>

#include <fascia/base/hash.h>
#include <fascia/skin/grid/grid_skin.h>
#include <fascia/skin/surface/surface_rest.h>

namespace fascia {
namespace {

enum class StateKind : std::uint64_t { none, grid, simulatedMesh, posedMesh, surface };
constexpr std::array<const char*, 5> kStateKinds{"none", "a grid", "a mesh that is simulated",
                                                 "a mesh that follows its pose",
                                                 "the surface of its solids"};

// One number that has to be the same. Those that only tell things apart are hashes.
struct StateTrait {
  enum class Meaning { count, kind, names, mesh } meaning;
  const char* what;  // of counts
  std::uint64_t value;
};

void addName(StateHash& hash, const std::string& name) {
  hash.add(name.size());
  hash.add(name.data(), name.size());
}

std::uint64_t hashOfNames(const Character& character) {
  StateHash hash;
  for (const JointDef& joint : character.def().skeleton.joints) addName(hash, joint.name);
  for (const FleshSolidDef& solid : character.def().flesh.solids) addName(hash, solid.name);
  const Morphs& morphs = character.morphs();
  for (std::size_t i = 0; i < morphs.size(); ++i) addName(hash, morphs[i].name);
  return hash.value();
}

std::uint64_t hashOfMesh(const CharacterDef& def, const Skin* skin) {
  StateHash hash;
  if (skin && skin->surface()) {
    const auto& triangles = skin->surface()->triangles;
    hash.add(triangles.data(), triangles.size() * sizeof triangles.front());
  }
  if (!def.rig || !def.rig->model) return hash.value();
  const auto& triangles = def.rig->model->triangles;
  hash.add(triangles.data(), triangles.size() * sizeof triangles.front());
  return hash.value();
}

StateKind kindOf(const Skin* skin) {
  if (!skin) return StateKind::none;
  if (skin->grid()) return StateKind::grid;
  if (skin->surface()) return StateKind::surface;
  return skin->isSimulated() ? StateKind::simulatedMesh : StateKind::posedMesh;
}

auto traitsOf(const Character& character) {
  using Meaning = StateTrait::Meaning;
  const Skin* skin = character.skin();
  const GridSkin* grid = skin ? skin->grid() : nullptr;
  const auto columns = static_cast<std::uint64_t>(grid ? grid->columns() : 0);
  const auto rows = static_cast<std::uint64_t>(grid ? grid->rows() : 0);
  const std::uint64_t points = skin ? skin->pointCount() : 0;
  const std::uint64_t soft = character.softFlesh() ? character.softFlesh()->model().size() : 0;
  return std::array<StateTrait, 10>{{
      {Meaning::count, "joints", character.skeleton().jointCount()},
      {Meaning::count, "degrees of freedom", character.skeleton().valueCount()},
      {Meaning::count, "solids", character.flesh().solidCount()},
      {Meaning::count, "coordinates of soft solids", soft},
      {Meaning::names, "", hashOfNames(character)},
      {Meaning::kind, "", static_cast<std::uint64_t>(kindOf(skin))},
      {Meaning::count, "skin points", points},
      {Meaning::count, "skin points around", columns},
      {Meaning::count, "skin points along", rows},
      {Meaning::mesh, "", hashOfMesh(character.def(), skin)},
  }};
}

std::string difference(const StateTrait& ours, std::uint64_t found) {
  switch (ours.meaning) {
    case StateTrait::Meaning::count:
      return "it has " + std::to_string(found) + " " + ours.what + ", this one " +
             std::to_string(ours.value);
    case StateTrait::Meaning::names:
      return "its joints, solids or morphs have other names";
    case StateTrait::Meaning::mesh:
      return "its mesh has other triangles";
    case StateTrait::Meaning::kind:
      break;
  }
  if (found >= kStateKinds.size()) return "its skin is of no known kind";
  return std::string("its skin is ") + kStateKinds[found] + ", this one's " +
         kStateKinds[ours.value];
}

}  // namespace

void writeTraits(const Character& character, ByteWriter& out) {
  for (const StateTrait& trait : traitsOf(character)) out.value(trait.value);
}

void requireTraits(const Character& character, ByteReader& in) {
  std::string differences;
  for (const StateTrait& ours : traitsOf(character)) {
    const auto found = in.value<std::uint64_t>();
    if (found == ours.value) continue;
    differences += (differences.empty() ? "" : "; ") + difference(ours, found);
  }
  if (!differences.empty()) in.fail("is the state of another character: " + differences);
}

}  // namespace fascia
