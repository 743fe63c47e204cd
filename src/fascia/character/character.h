#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include <fascia/character/character_def.h>
#include <fascia/character/soft_stepper.h>
#include <fascia/flesh/clip_source.h>
#include <fascia/skin/skin.h>

namespace fascia {

// What the command line may override without touching the file.
struct BuildOptions {
  int columns = 0, rows = 0;  // 0 = as in the file
  std::string integrator;     // empty = as in the file
  double step_s = -1;         // negative = as in the file
  double interval_s = 0;      // see SkinSettings; 0 = the usual one (references want it short)
  double jiggle = -1;         // of an imported mesh, in [0, 1]; negative = as in the file
};

// A constant, validated character: skeleton, flesh, skin and motions ready to run.
class Character {
 public:
  // Throws Error with all faults of `def` (JSON pointers, no file or line).
  explicit Character(const CharacterDef& def, const BuildOptions& options = {});

  const CharacterDef& def() const { return def_; }
  const Skeleton& skeleton() const { return skeleton_; }
  const Flesh& flesh() const { return flesh_; }
  const Flesh& ornaments() const { return ornaments_; }  // rigid: seen, but not felt by the skin
  const Skin* skin() const { return skin_.get(); }       // nullptr: a character without skin
  // Solids of the flesh that are deformable bodies; nullptr: none.
  const std::shared_ptr<const SoftFlesh>& softFlesh() const { return softFlesh_; }
  std::size_t motionCount() const { return clips_.size(); }
  const BoundClip& motion(std::size_t i) const { return clips_[i]; }
  // Index of a motion by name; empty name = the first; -1 = none of that name.
  int findMotion(std::string_view name) const;
  // Plays a motion; -1: the rest posture. The character must outlive it and stay where it is.
  ClipSource source(int motion) const;

 private:
  void bindRigMotions(Diagnostics& diagnostics);
  void buildSoftFlesh(Diagnostics& diagnostics);

  CharacterDef def_;
  Skeleton skeleton_;
  Flesh flesh_, ornaments_;
  std::shared_ptr<const SoftFlesh> softFlesh_;
  std::unique_ptr<const Skin> skin_;
  std::vector<BoundClip> clips_;
  BoundClip rest_;  // without tracks
};

// What changes over time: a plain value that can be copied, hashed, saved and rewound.
struct CharacterState {
  double time_s = 0;
  Posture posture;
  PosedSkeleton skeleton;
  OdeState bodies;  // of the soft solids
  LayeredFlesh flesh;
  PosedFlesh ornaments;
  SkinState skin;
  // Scratch memory, not part of the state's meaning; a copy starts with none.
  SkinWorkspace workspace;
  SoftWorkspace softWorkspace;
  PostureSample sampled;
  std::vector<double> stillBodies;  // velocities of none
};

// Over time, posture, soft solids and skin: equal exactly when the states are.
std::uint64_t hashOf(const Character& character, const CharacterState& state);

// The state at time 0 of what moves the character, settled for simulation.settle_s.
CharacterState initialState(const Character& character, const PostureSource& source);

// The layers below the skin at state.time_s; `moving` = false: velocities 0. Soft solids as
// state.bodies has them if those are of this very time; otherwise undeformed, where joints are.
void poseLayers(const Character& character, const PostureSource& source, bool moving,
                CharacterState& state);

// What stands or moves about a character, in its own space, while it is advanced: its skin must not
// enter it. Skins on rigs are dented by it.
class Surroundings {
 public:
  virtual ~Surroundings() = default;
  // Posed at any time of the frame; valid until the next call.
  virtual const Field& at(double time_s) = 0;
};

// One frame: source → skeleton → flesh → soft solids → skin. dt_s > 0; long frames are divided.
// The source is asked for times of this frame, in any order. Never throws, allocates nothing after
// the first calls.
void advance(const Character& character, const PostureSource& source, double dt_s,
             CharacterState& state, SkinStats& stats, Surroundings* surroundings = nullptr);

}  // namespace fascia
