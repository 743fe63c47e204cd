#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fascia/base/random.h>
#include <fascia/character/editing.h>

namespace fascia::test {

// Edits as a person makes them, one at a time, by chance: the same for the same seed. Every edit
// leaves the definition valid. Values stay near where they were: what is tested is the editing, and
// not materials that nobody would choose.
class RandomEdits {
 public:
  explicit RandomEdits(const CharacterDef& start, std::uint64_t seed)
      : start_(start), random_(seed) {}

  // Says what it did.
  std::string apply(CharacterDef& def) {
    using Edit = std::string (RandomEdits::*)(CharacterDef&);
    static constexpr Edit kEdits[] = {
        &RandomEdits::material,   &RandomEdits::tissue,      &RandomEdits::fat,
        &RandomEdits::moveSolid,  &RandomEdits::resizeSolid, &RandomEdits::turnSolid,
        &RandomEdits::moveJoint,  &RandomEdits::brush,       &RandomEdits::region,
        &RandomEdits::gravity,    &RandomEdits::rename,      &RandomEdits::motion,
        &RandomEdits::soften,     &RandomEdits::resolution,  &RandomEdits::addOrRemoveSolid,
        &RandomEdits::endOrCling, &RandomEdits::undo};
    static constexpr Edit kRigEdits[] = {
        &RandomEdits::material,  &RandomEdits::tissue,    &RandomEdits::fat,
        &RandomEdits::moveSolid, &RandomEdits::turnSolid, &RandomEdits::resizeSolid,
        &RandomEdits::moveJoint, &RandomEdits::brush,     &RandomEdits::region,
        &RandomEdits::gravity,   &RandomEdits::motion,    &RandomEdits::addOrRemoveSolid,
        &RandomEdits::dial,      &RandomEdits::dial,      &RandomEdits::partRule,
        &RandomEdits::simulate,  &RandomEdits::undo};
    if (start_.rig) return (this->*kRigEdits[below(std::size(kRigEdits))])(def);
    return (this->*kEdits[below(std::size(kEdits))])(def);
  }

  Random& random() { return random_; }

 private:
  std::size_t below(std::size_t count) { return random_.next() % count; }
  double near(double start, double factor) {
    return start * std::exp(random_.uniform(-1, 1) * std::log(factor));
  }
  Vec3 shift(double most_m) {
    return {random_.uniform(-most_m, most_m), random_.uniform(-most_m, most_m),
            random_.uniform(-most_m, most_m)};
  }
  // A solid that was there at the start; others come and go.
  FleshSolidDef& someSolid(CharacterDef& def) {
    return def.flesh.solids[below(start_.flesh.solids.size())];
  }
  const FleshSolidDef& atStart(const CharacterDef& def, const FleshSolidDef& solid) const {
    return start_.flesh.solids[static_cast<std::size_t>(&solid - def.flesh.solids.data())];
  }

  std::string material(CharacterDef& def) {
    SkinMaterialDef& m = def.skin->material;
    const SkinMaterialDef& old = start_.skin->material;
    switch (below(6)) {
      case 0:
        m.stretch_u_N_per_m = near(old.stretch_u_N_per_m, 2);
        break;
      case 1:
        m.stretch_v_N_per_m = near(old.stretch_v_N_per_m, 2);
        break;
      case 2:
        m.shear_N_per_m = near(old.shear_N_per_m, 2);
        break;
      case 3:
        m.density_kg_per_m2 = near(old.density_kg_per_m2, 2);
        break;
      case 4:
        m.prestretch = near(old.prestretch, 1.05);
        break;
      default:
        m.bending_Nm = below(2) ? 0.01 : 0;
    }
    return "material";
  }
  std::string tissue(CharacterDef& def) {
    SkinTissueDef& t = def.skin->tissue;
    if (below(4) == 0) t.rest_length_m = below(2) ? std::optional<double>(0.005) : std::nullopt;
    t.stiffness_N_per_m3 = near(start_.skin->tissue.stiffness_N_per_m3, 2);
    t.damping_Ns_per_m3 = near(start_.skin->tissue.damping_Ns_per_m3, 2);
    return "tissue";
  }
  std::string fat(CharacterDef& def) {
    def.skin->fat.thickness_m = near(start_.skin->fat.thickness_m, 1.5);
    return "fat";
  }
  std::string moveSolid(CharacterDef& def) {
    FleshSolidDef& solid = someSolid(def);
    solid.position_m = atStart(def, solid).position_m + shift(0.02);
    return "move solid " + solid.name;
  }
  std::string turnSolid(CharacterDef& def) {
    FleshSolidDef& solid = someSolid(def);
    solid.orientation_rad = atStart(def, solid).orientation_rad + shift(0.2);
    return "turn solid " + solid.name;
  }
  std::string resizeSolid(CharacterDef& def) {
    FleshSolidDef& solid = someSolid(def);
    const FleshSolidDef& old = atStart(def, solid);
    const Shape& shape = *findShape(solid.solid.shape);
    const std::size_t p = below(shape.parameters().size());
    solid.solid.parameters = old.solid.parameters;
    for (std::size_t i = solid.solid.parameters.size(); i < shape.parameters().size(); ++i)
      solid.solid.parameters.push_back(shape.parameters()[i].standard);
    const ParameterInfo& info = shape.parameters()[p];
    solid.solid.parameters[p] =
        std::clamp(near(solid.solid.parameters[p], 1.15), info.min, info.max);
    for (std::size_t d = 0; d < solid.drivers.size(); ++d)
      solid.drivers[d].points = old.drivers[d].points;
    for (DriverDef& driver : solid.drivers)
      if (driver.parameter == info.name)
        for (DriverDef::Point& point : driver.points)
          point.parameter = std::clamp(near(point.parameter, 1.05), info.min, info.max);
    return "resize solid " + solid.name;
  }
  std::string moveJoint(CharacterDef& def) {
    const std::size_t j = below(def.skeleton.joints.size());
    def.skeleton.joints[j].offset_m = start_.skeleton.joints[j].offset_m + shift(0.02);
    return "move joint " + def.skeleton.joints[j].name;
  }
  std::string brush(CharacterDef& def) {
    if (def.skin->brushes.size() > start_.skin->brushes.size() && below(2)) {
      def.skin->brushes.pop_back();
      return "drop brush";
    }
    SkinBrushDef brush;
    brush.joint = def.skeleton.joints[below(def.skeleton.joints.size())].name;
    brush.center_m = shift(0.2);
    brush.quantity = below(2) ? SkinQuantity::fat : SkinQuantity::density;
    if (start_.rig && below(2)) brush.quantity = SkinQuantity::jiggle;
    brush.amount = brush.quantity == SkinQuantity::fat ? random_.uniform(0, 0.01) : 1;
    def.skin->brushes.push_back(brush);
    return "brush";
  }
  std::string region(CharacterDef& def) {
    if (def.skin->regions.size() > start_.skin->regions.size()) {
      def.skin->regions.pop_back();
      return "drop region";
    }
    SkinRegionDef region;
    region.name = "patch";
    if (start_.rig && below(2))
      region.joint = start_.rig->model->joints[below(start_.rig->model->joints.size())].name;
    else if (start_.rig || below(2))
      region.solid = someSolid(def).name;
    region.edits = {{SkinQuantity::tissue_stiffness, SkinRegionDef::Edit::Mode::scale, 2}};
    def.skin->regions.push_back(region);
    return "region";
  }
  std::string gravity(CharacterDef& def) {
    def.simulation.gravity_m_per_s2 = Vec3(0, -9.81, 0) + shift(2);
    return "gravity";
  }
  std::string rename(CharacterDef& def) {
    const std::string suffix = " " + std::to_string(++renames_);
    if (below(2)) {
      const std::string from = someSolid(def).name;
      renameSolid(def, from, from.substr(0, from.find(' ')) + suffix);
      return "rename solid " + from;
    }
    const std::string from = def.skeleton.joints[below(def.skeleton.joints.size())].name;
    renameJoint(def, from, from.substr(0, from.find(' ')) + suffix);
    return "rename joint " + from;
  }
  std::string motion(CharacterDef& def) {
    if (def.motions.empty()) return "nothing";
    MotionDef& motion = def.motions[below(def.motions.size())];
    if (motion.tracks.empty()) return "nothing";
    std::vector<Key>& keys = motion.tracks[below(motion.tracks.size())].keys;
    keys[below(keys.size())].tension = random_.uniform(-1, 1);
    return "motion " + motion.name;
  }
  std::string soften(CharacterDef& def) {
    for (std::size_t i = 0; i < start_.flesh.solids.size(); ++i) {
      if (!def.flesh.solids[i].soft) continue;
      def.flesh.solids[i].soft->rigidity_Pa = near(start_.flesh.solids[i].soft->rigidity_Pa, 1.5);
      return "soft solid " + def.flesh.solids[i].name;
    }
    return "nothing";
  }
  std::string resolution(CharacterDef& def) {
    def.skin->grid.columns = start_.skin->grid.columns - 2 + static_cast<int>(below(6));
    def.skin->grid.rows = start_.skin->grid.rows - 4 + static_cast<int>(below(8));
    return "resolution";
  }
  std::string addOrRemoveSolid(CharacterDef& def) {
    if (def.flesh.solids.size() > start_.flesh.solids.size()) {
      const std::string name = def.flesh.solids.back().name;
      std::erase_if(def.skin->regions, [&](const SkinRegionDef& r) { return r.solid == name; });
      def.flesh.solids.pop_back();
      return "remove solid " + name;
    }
    FleshSolidDef solid;
    solid.name = "lump";
    solid.joint = def.skeleton.joints[below(def.skeleton.joints.size())].name;
    solid.position_m = shift(0.1);
    solid.solid.parameters = {random_.uniform(0.03, 0.08)};
    def.flesh.solids.push_back(solid);
    return "add solid";
  }
  std::string endOrCling(CharacterDef& def) {
    if (below(2)) {
      def.skin->grid.cling = random_.uniform();
      return "cling";
    }
    def.skin->grid.top.radius_m = random_.uniform(0.02, 0.05);
    return "end ring";
  }
  std::string dial(CharacterDef& def) {
    static constexpr std::pair<const char*, double SkinPoseDef::*> kDials[] = {
        {"jiggle", &SkinPoseDef::jiggle},
        {"muscle", &SkinPoseDef::muscle},
        {"volume", &SkinPoseDef::volume},
        {"tightness", &SkinPoseDef::tightness}};
    const auto& [name, member] = kDials[below(std::size(kDials))];
    def.skin->mesh.pose.*member = below(4) ? random_.uniform() : 0;
    return name;
  }
  std::string partRule(CharacterDef& def) {
    if (!def.skin->mesh.parts.empty()) {
      def.skin->mesh.parts.pop_back();
      return "drop rule";
    }
    const std::vector<RigPart>& parts = start_.rig->model->parts;
    def.skin->mesh.parts.push_back({parts[below(parts.size())].name, below(2) == 0});
    return "rule";
  }
  std::string simulate(CharacterDef& def) {
    def.skin->mesh.pose.simulate = !def.skin->mesh.pose.simulate;
    return def.skin->mesh.pose.simulate ? "simulate" : "pose";
  }
  std::string undo(CharacterDef& def) {
    def = start_;
    return "undo all";
  }

  CharacterDef start_;
  Random random_;
  int renames_ = 0;
};

}  // namespace fascia::test
