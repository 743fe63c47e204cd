#pragma once

#include <memory>
#include <string>

#include <fascia/character/character_def.h>
#include <fascia/fitting/fit_flesh.h>
#include <fascia/io/rig_import/rig_import.h>

namespace fascia::test {

// A character of a rigged file, with the flesh that is fitted to it.
inline CharacterDef fleshOut(const std::string& file) {
  CharacterDef def;
  auto model = std::make_shared<const RiggedModel>(readRiggedModel(file));
  FleshFit fit = fitFlesh(*model);
  def.name = model->name;
  def.skeleton = std::move(fit.skeleton);
  def.flesh = std::move(fit.flesh);
  def.rig = RigDef{file, 1, model};
  def.skin.emplace();
  def.simulation.settle_s = 0.1;
  return def;
}

}  // namespace fascia::test
