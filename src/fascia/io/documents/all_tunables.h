#pragma once

#include <type_traits>

#include <fascia/world/scene_def.h>

namespace fascia {

// Every table of tunables and where files have its rows: visit(std::type_identity<Def>(), place).
// A place is a JSON pointer; "*" stands for any index.
template <class Visit>
void forEachCharacterTable(const Visit& visit) {
  visit(std::type_identity<JointDef>(), "/skeleton/*");
  visit(std::type_identity<FleshSolidDef>(), "/solids/*");
  visit(std::type_identity<SoftSolidDef>(), "/solids/*/soft");
  visit(std::type_identity<RigDef>(), "/rig");
  visit(std::type_identity<SkinGridDef>(), "/skin");
  visit(std::type_identity<SkinEndDef>(), "/skin/bottom");
  visit(std::type_identity<SkinMaterialDef>(), "/skin/material");
  visit(std::type_identity<SkinFatDef>(), "/skin/fat");
  visit(std::type_identity<SkinTissueDef>(), "/skin/tissue");
  visit(std::type_identity<SkinPoseDef>(), "/skin/pose");
  visit(std::type_identity<SkinRegionDef>(), "/skin/regions/*");
  visit(std::type_identity<SkinRegionDef::Edit>(), "/skin/regions/*/edits/*");
  visit(std::type_identity<SkinBrushDef>(), "/skin/brushes/*");
  visit(std::type_identity<SkinAnchorDef>(), "/skin/anchors/*");
  visit(std::type_identity<SkinContactDef>(), "/skin/contact");
  visit(std::type_identity<SkinPartDef>(), "/skin/parts/*");
  visit(std::type_identity<MotionDef>(), "/motions/*");
  visit(std::type_identity<Key>(), "/motions/*/tracks/*/keys/*");
  visit(std::type_identity<SimulationDef>(), "/simulation");
}

template <class Visit>
void forEachSceneTable(const Visit& visit) {
  visit(std::type_identity<SceneBodyDef>(), "/bodies/*");
  visit(std::type_identity<ScatterDef>(), "/bodies/*/scatter");
  visit(std::type_identity<SceneConstraintDef>(), "/constraints/*");
  visit(std::type_identity<ScenePathDef>(), "/paths/*");
  visit(std::type_identity<ScenePathDef::Key>(), "/paths/*/keys/*");
  visit(std::type_identity<SceneCharacterDef>(), "/characters/*");
  visit(std::type_identity<PlacedSolidDef>(), "/props/*");
  visit(std::type_identity<GroundDef>(), "/ground");
  visit(std::type_identity<ViewDef>(), "/view");
  visit(std::type_identity<SceneSimulationDef>(), "/simulation");
}

}  // namespace fascia
