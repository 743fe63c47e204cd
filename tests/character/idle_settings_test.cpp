#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fascia/character/idle_settings.h>

#include "small_character.h"

namespace fascia {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> idlePlaces(const CharacterDef& def) {
  Diagnostics diagnostics;
  warnOfIdleSettings(def, diagnostics);
  EXPECT_TRUE(diagnostics.ok());
  std::vector<std::string> pointers;
  for (const Issue& issue : diagnostics.warnings()) {
    EXPECT_FALSE(issue.hint.empty()) << issue.message;
    pointers.push_back(issue.where.pointer);
  }
  return pointers;
}

CharacterDef rigged() {
  CharacterDef def;
  def.rig.emplace();
  def.skin.emplace();
  return def;
}

TEST(IdleSettings, AreNoneOfACharacterAsItComes) {
  EXPECT_THAT(idlePlaces(test::smallCharacter()), IsEmpty());
  EXPECT_THAT(idlePlaces(rigged()), IsEmpty());
}

TEST(IdleSettings, OfAGridAreThoseOfRigs) {
  CharacterDef def = test::smallCharacter();
  def.skin->fat.bulk_Pa = 100;
  def.skin->mesh.pose.jiggle = 1;
  def.skin->regions.emplace_back().name = "all";
  def.skin->regions[0].edits = {{SkinQuantity::fat}, {SkinQuantity::tightness}};
  def.skin->brushes.emplace_back().quantity = SkinQuantity::muscle;
  EXPECT_THAT(idlePlaces(def), ElementsAre("/skin/fat/bulk_Pa", "/skin/pose/jiggle",
                                           "/skin/regions/0/edits/1", "/skin/brushes/0"));
}

TEST(IdleSettings, OfAPosedMeshAreThoseOfGridsAndOfWhatIsSimulated) {
  CharacterDef def = rigged();
  def.skin->grid.cling = 1;
  def.skin->grid.anchors.resize(1);
  def.skin->contact.self = true;
  def.skin->material.drag_Ns_per_m3 = 1;
  def.skin->tissue.rest_length_m = 0;
  def.skin->fat.thickness_m = 0.5;  // where fat is edited, this is what is there
  def.skin->points.emplace().density = std::vector<float>{1};
  def.simulation.settle_s = 1;
  def.simulation.integrator = "verlet";
  EXPECT_THAT(idlePlaces(def),
              ElementsAre("/skin/cling", "/skin/anchors", "/skin/contact/self",
                          "/skin/material/drag_Ns_per_m3", "/skin/tissue/rest_length_m",
                          "/skin/points/density_kg_per_m2", "/simulation/settle_s",
                          "/simulation/integrator"));
}

TEST(IdleSettings, OfASimulatedMeshAreOnlyThoseOfContactWithFlesh) {
  CharacterDef def = rigged();
  def.skin->mesh.pose.simulate = true;
  def.skin->material.drag_Ns_per_m3 = 1;
  def.skin->material.restitution = 1;
  def.skin->fat.bulk_Pa = 100;
  def.simulation.max_step_s = 0.01;
  EXPECT_THAT(idlePlaces(def), ElementsAre("/skin/material/restitution", "/simulation/max_step_s"));
}

TEST(IdleSettings, OfAdaptiveSchemesIsTheFatsPressure) {
  CharacterDef def = rigged();
  def.skin->mesh.pose.simulate = true;
  def.skin->fat.bulk_Pa = 100;
  EXPECT_THAT(idlePlaces(def), ElementsAre());
  def.simulation.integrator = "verlet";
  EXPECT_THAT(idlePlaces(def), ElementsAre("/skin/fat/bulk_Pa"));
}

TEST(IdleSettings, AndKeysThatAreNeverMetAreToldByTheCharacter) {
  CharacterDef def = test::smallCharacter();
  def.skin->mesh.pose.volume = 0;
  def.motions[0].tracks[2].keys[1].value = 3;
  const Character character(def);
  ASSERT_EQ(character.warnings().size(), 2u);
  EXPECT_EQ(character.warnings()[0].where.pointer, "/motions/0/tracks/2/keys/1");
  EXPECT_EQ(character.warnings()[1].where.pointer, "/skin/pose/volume");
}

}  // namespace
}  // namespace fascia
