#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fascia/flesh/flesh.h>
#include <fascia/motion/motion.h>
#include <fascia/rig/rigged_model.h>
#include <fascia/skeleton/skeleton.h>
#include <fascia/skin/def/skin_def.h>

namespace fascia {

struct SimulationDef {
  double frame_rate_hz = 60;        // [1, 1000]; frames that a bake writes
  std::string integrator = "auto";  // "auto" = the default stabilised scheme; or one of
                                    // euler, implicit-euler, verlet, rk2, rk4, rosenbrock4, xpbd
  double step_s = 0;                // [0, 1/12]; fixed step or first guess; 0 = chosen
  double min_step_s = 1e-5;         // adaptive integrators
  double max_step_s = 0.02;
  double position_tolerance_m = 1e-3;    // ε_r: local error per step of the adaptive integrators
  double velocity_tolerance = 1e-3;      // ε_v: relative, leapfrog's inner iteration
  double correction_tolerance_m = 0.01;  // ε_c: a larger non-penetration correction redoes the step
  Vec3 gravity_m_per_s2{0, -9.81, 0};
  double settle_s = 0.5;  // [0, 60]; simulated before time 0 in the first posture
  bool operator==(const SimulationDef&) const = default;
};

// An imported, skinned mesh that is the character's skin instead of a grid. Its joints are found by
// name in the character's skeleton; its motions can be played by name like the character's own.
struct RigDef {
  std::string file;                          // glTF beside the character file
  double scale = 1;                          // (0, 1e6] of all its lengths
  std::shared_ptr<const RiggedModel> model;  // read from the file; not saved
  bool operator==(const RigDef&) const = default;
};

// What a *.fascia.json holds and a person edits. Plain values; y is up, metres.
struct CharacterDef {
  std::string name;
  std::string description;
  SkeletonDef skeleton;
  FleshDef flesh;
  FleshDef ornaments;  // seen, but not felt by the skin: eyes, beak, claws
  std::optional<RigDef> rig;
  std::optional<SkinDef> skin;
  std::vector<MotionDef> motions;
  SimulationDef simulation;
  std::string folder;  // where the file lies; relative paths (textures) start here. Not saved.
  bool operator==(const CharacterDef&) const = default;
};

}  // namespace fascia
