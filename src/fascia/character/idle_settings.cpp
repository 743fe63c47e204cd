#include <fascia/character/idle_settings.h>

#include <algorithm>

#include <fascia/skin/point/quantities.h>

namespace fascia {
namespace {

constexpr IdleReason kNoFatModel = {"no skin presses its fat together", "leave it out"};
constexpr IdleReason kGridFat = {"the fat of a grid has no pressure", "leave it out"};
constexpr IdleReason kGridPose = {"only a rig's skin is a function of its joints", "leave it out"};
constexpr IdleReason kMeshWrap = {"a rig's mesh is not wrapped around the flesh", "leave it out"};
constexpr IdleReason kMeshAnchors = {"a rig's mesh hangs on its own pose, not on solids",
                                     "leave them out"};
constexpr IdleReason kMeshContact = {"limbs of a rig's skin press on each other by themselves",
                                     "leave it out"};
constexpr IdleReason kMeshFriction = {"a rig's skin does not slide on its flesh", "leave it out"};
constexpr IdleReason kSurfaceWrap = {"a skin on its solids' surface is no tube",
                                     "leave it out, or leave out \"surface\""};
constexpr IdleReason kPosedSkin = {"this rig's skin is posed, not simulated",
                                   "set \"pose\": {\"simulate\": true}, or leave it out"};
constexpr IdleReason kFixedScheme = {"the fast schemes choose their own steps",
                                     "choose an adaptive integrator, or leave it out"};
constexpr IdleReason kSchemeWithoutFat = {"only the fast schemes step fat with a pressure",
                                          "set \"integrator\": \"auto\", or leave it out"};
constexpr IdleReason kNothingSteps = {"nothing of this character is simulated", "leave it out"};

class Idle {
 public:
  Idle(const CharacterDef& def, Diagnostics& diagnostics)
      : def_(def),
        diagnostics_(diagnostics),
        onRig_(def.rig.has_value()),
        onSurface_(!onRig_ && def.skin && def.skin->surface),
        simulated_(def.skin && (!onRig_ || def.skin->mesh.pose.simulate)) {}

  void warn() const {
    if (def_.skin) warnOfSkin(*def_.skin);
    warnOfSimulation();
  }

 private:
  template <class T>
  void rows(const T& part, const std::string& pointer, std::initializer_list<std::string_view> keys,
            const IdleReason& reason) const {
    warnOfIdleRows(part, pointer, keys, reason, diagnostics_);
  }
  void one(const std::string& pointer, const IdleReason& reason) const {
    diagnostics_.warning(pointer, std::string("has no effect: ") + reason.why, reason.hint);
  }

  void warnOfSkin(const SkinDef& skin) const {
    rows(skin.fat, "/skin/fat", {"compressible"}, kNoFatModel);
    if (onRig_) {
      warnOfMesh(skin);
    } else {
      if (!onSurface_) rows(skin.fat, "/skin/fat", {"bulk_Pa"}, kGridFat);
      rows(skin.mesh.pose, "/skin/pose", {}, kGridPose);
    }
    if (onSurface_) warnOfSurface(skin);
    const std::string& integrator = def_.simulation.integrator;
    if (simulated_ && (onRig_ || onSurface_) && integrator != "auto" && integrator != "leapfrog")
      rows(skin.fat, "/skin/fat", {"bulk_Pa"}, kSchemeWithoutFat);
    warnOfQuantities(skin);
  }

  void warnOfSurface(const SkinDef& skin) const {
    const SkinGridDef standard;
    if (skin.grid.columns != standard.columns || skin.grid.rows != standard.rows)
      one("/skin/grid", kSurfaceWrap);
    rows(skin.grid, "/skin", {"cling"}, kSurfaceWrap);
    if (!skin.grid.anchors.empty()) one("/skin/anchors", kSurfaceWrap);
  }

  void warnOfMesh(const SkinDef& skin) const {
    rows(skin.grid, "/skin", {"cling"}, kMeshWrap);
    if (!skin.grid.anchors.empty()) one("/skin/anchors", kMeshAnchors);
    rows(skin.contact, "/skin/contact", {}, kMeshContact);
    if (simulated_) {
      rows(skin.material, "/skin/material", {"friction_per_s", "restitution"}, kMeshFriction);
      return;
    }
    rows(skin.material, "/skin/material", {}, kPosedSkin);
    rows(skin.tissue, "/skin/tissue", {}, kPosedSkin);
    rows(skin.fat, "/skin/fat", {"bulk_Pa"}, kPosedSkin);
  }

  // Whether a skin of this kind does not read a quantity of its points.
  const IdleReason* idle(SkinQuantity quantity) const {
    const bool ofPose = quantity >= SkinQuantity::jiggle;
    if (!onRig_) return ofPose ? &kGridPose : nullptr;
    return ofPose || quantity == SkinQuantity::fat || simulated_ ? nullptr : &kPosedSkin;
  }

  void warnOfQuantities(const SkinDef& skin) const {
    for (std::size_t i = 0; i < skin.regions.size(); ++i)
      for (std::size_t k = 0; k < skin.regions[i].edits.size(); ++k)
        if (const IdleReason* reason = idle(skin.regions[i].edits[k].quantity))
          one(entryOf(entryOf("/skin/regions", i) + "/edits", k), *reason);
    for (std::size_t i = 0; i < skin.brushes.size(); ++i)
      if (const IdleReason* reason = idle(skin.brushes[i].quantity))
        one(entryOf("/skin/brushes", i), *reason);
    if (!skin.points) return;
    for (const QuantityInfo& info : quantityInfos())
      if (const IdleReason* reason = idle(info.quantity);
          reason && !pointValues(*skin.points, info.quantity).empty())
        one("/skin/points/" + std::string(info.listKey), *reason);
  }

  void warnOfSimulation() const {
    const SimulationDef& simulation = def_.simulation;
    const bool soft = std::ranges::any_of(
        def_.flesh.solids, [](const FleshSolidDef& solid) { return solid.soft.has_value(); });
    if (!simulated_ && !soft)
      rows(simulation, "/simulation", {"gravity_m_per_s2", "settle_s"}, kNothingSteps);
    if (!simulated_) {
      rows(simulation, "/simulation",
           {"integrator", "step_s", "min_step_s", "max_step_s", "position_tolerance_m",
            "velocity_tolerance", "correction_tolerance_m"},
           soft ? kSoftOnly : kNothingSteps);
    } else if (simulation.integrator == "auto" || simulation.integrator == "leapfrog" ||
               simulation.integrator == "cloth") {
      rows(simulation, "/simulation",
           {"min_step_s", "max_step_s", "position_tolerance_m", "velocity_tolerance",
            "correction_tolerance_m"},
           kFixedScheme);
    }
  }

  static constexpr IdleReason kSoftOnly = {"soft solids have their own scheme", "leave it out"};

  const CharacterDef& def_;
  Diagnostics& diagnostics_;
  bool onRig_, onSurface_, simulated_;
};

}  // namespace

void warnOfIdleSettings(const CharacterDef& def, Diagnostics& diagnostics) {
  Idle(def, diagnostics).warn();
}

}  // namespace fascia
