#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fascia/flesh/flesh.h>
#include <fascia/motion/motion.h>
#include <fascia/rig/rigged_model.h>
#include <fascia/skeleton/skeleton.h>
#include <fascia/skin/def/skin_def.h>

namespace fascia {

// The skin's own three, and every method of the solver library.
std::vector<std::string_view> skinIntegrators();
// The longest piece of a frame that is simulated at once.
inline constexpr double kLongestFrame_s = 1.0 / 12;

struct SimulationDef {
  double frame_rate_hz = 60;
  std::string integrator = "auto";
  double step_s = 0;
  double min_step_s = 1e-5, max_step_s = 0.02;
  double position_tolerance_m = 1e-3;    // ε_r
  double velocity_tolerance = 1e-3;      // ε_v
  double correction_tolerance_m = 0.01;  // ε_c
  Vec3 gravity_m_per_s2{0, -9.81, 0};
  double settle_s = 0.5;
  bool operator==(const SimulationDef&) const = default;
};
constexpr auto tunables(const SimulationDef*) {
  using S = SimulationDef;
  return std::tuple{
      tunable(&S::frame_rate_hz, "frame_rate_hz", "Hz", {1, 1000}, "Frames that a bake writes"),
      wordTunable(
          &S::integrator, "integrator", &skinIntegrators,
          "auto: the fast scheme that never explodes; cloth: of sheets that hardly stretch"),
      tunable(&S::step_s, "step_s", "s", {0, kLongestFrame_s},
              "Fixed step or first guess; 0: chosen"),
      tunable(&S::min_step_s, "min_step_s", "s", {1e-7, kLongestFrame_s},
              "For adaptive integrators"),
      tunable(&S::max_step_s, "max_step_s", "s", {1e-7, kLongestFrame_s},
              "For adaptive integrators"),
      tunable(&S::position_tolerance_m, "position_tolerance_m", "m", {1e-9, 1},
              "Local error per step of the adaptive integrators"),
      tunable(&S::velocity_tolerance, "velocity_tolerance", "", {1e-9, 1},
              "Relative; the leapfrog's inner iteration"),
      tunable(&S::correction_tolerance_m, "correction_tolerance_m", "m", {1e-9, 1},
              "A larger correction out of the flesh redoes the step"),
      tunable(&S::gravity_m_per_s2, "gravity_m_per_s2", "m/s²", {-1e4, 1e4}, "y is up"),
      tunable(&S::settle_s, "settle_s", "s", {0, 60},
              "Simulated before time 0 in the first posture")};
}

// A joint of a rig that the character calls otherwise than the rig's file.
struct RigJointNameDef {
  std::string joint;  // in the file
  std::string name;   // in the character's skeleton
  bool operator==(const RigJointNameDef&) const = default;
};

// An imported, skinned mesh that is the character's skin instead of a grid. Its joints are found by
// name in the character's skeleton; its motions can be played by name like the character's own.
struct RigDef {
  std::string file;  // glTF beside the character file
  double scale = 1;
  std::shared_ptr<const RiggedModel> model{};  // read from the file, whose names it has; not saved
  std::vector<RigJointNameDef> joint_names{};  // of joints that were renamed
  bool operator==(const RigDef&) const = default;

  // What the character calls a joint of the file.
  const std::string& nameOf(const std::string& joint) const;
  // … and all joints of the model, which must have been read.
  std::vector<std::string> jointNames() const;
};
constexpr auto tunables(const RigDef*) {
  return std::tuple{tunable(&RigDef::scale, "scale", "", {1e-6, 1e6},
                            "Of all its lengths; 0.01 for a file in centimetres")};
}

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
