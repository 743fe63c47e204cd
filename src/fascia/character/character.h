#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>
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

// The longest piece of a frame that is simulated at once.
inline constexpr double kLongestPiece_s = 1.0 / 12;

// What a character is made of. Each part is constant and shared with the characters that were
// edited from this one and have not changed it.
struct CharacterParts {
  std::shared_ptr<const CharacterDef> def;  // with the build options in it
  double interval_s = 0;                    // the only build option that no definition has
  std::shared_ptr<const Skeleton> skeleton;
  std::shared_ptr<const Flesh> flesh, ornaments;
  std::shared_ptr<const Morphs> morphs;
  std::shared_ptr<const SoftFlesh> softFlesh;  // nullptr: no solid is soft
  std::shared_ptr<const Skin> skin;            // nullptr: none
  std::vector<std::shared_ptr<const BoundClip>> clips;
  std::vector<Issue> warnings;
};

// A constant, validated character: skeleton, flesh, skin and motions ready to run. Copies are
// cheap: they share all parts.
class Character {
 public:
  // Throws Error with all faults of `def` (JSON pointers, no file or line).
  explicit Character(const CharacterDef& def, const BuildOptions& options = {});

  // What stops nothing but is hardly meant: keys that are never met, settings without effect. JSON
  // pointers; who reads the file adds its name and lines.
  const std::vector<Issue>& warnings() const { return parts_.warnings; }
  void setWarnings(std::vector<Issue> warnings) { parts_.warnings = std::move(warnings); }

  // The character of another definition, best one made from def(): builds the parts whose slices
  // differ, and shares the rest with this one. The rest shape of a skin follows moved joints,
  // moved and resized solids and fat; it is wrapped anew only where solids come, go or change
  // their shapes, or where the skin's ends, grid or cling do. See editing.h for a state that is to
  // go on. Throws as the constructor does, and then nothing has changed.
  Character edited(const CharacterDef& def) const;

  const CharacterParts& parts() const { return parts_; }
  const CharacterDef& def() const { return *parts_.def; }
  const Skeleton& skeleton() const { return *parts_.skeleton; }
  const Flesh& flesh() const { return *parts_.flesh; }
  const Morphs& morphs() const { return *parts_.morphs; }  // of a rig's mesh; else none
  // What sources are made for.
  Figure figure() const { return {skeleton(), flesh(), morphs()}; }
  // Rigid: seen, but not felt by the skin.
  const Flesh& ornaments() const { return *parts_.ornaments; }
  const Skin* skin() const { return parts_.skin.get(); }  // nullptr: a character without skin
  // Solids of the flesh that are deformable bodies; nullptr: none.
  const std::shared_ptr<const SoftFlesh>& softFlesh() const { return parts_.softFlesh; }
  std::size_t motionCount() const { return parts_.clips.size(); }
  const BoundClip& motion(std::size_t i) const { return *parts_.clips[i]; }
  // Index of a motion by name; empty name = the first; -1 = none of that name.
  int findMotion(std::string_view name) const;
  // Plays a motion; -1: the rest posture. A character with these parts must outlive it: one that
  // was edited needs a source of its own.
  ClipSource source(int motion) const;

 private:
  explicit Character(CharacterParts parts) : parts_(std::move(parts)) {}

  CharacterParts parts_;
};

// What changes over time: a plain value that can be copied, hashed, saved and rewound.
struct CharacterState {
  double time_s = 0;
  Posture posture;
  MorphPose morphs;
  PosedSkeleton skeleton;
  OdeState bodies;  // of the soft solids
  LayeredFlesh flesh;
  PosedFlesh ornaments;
  SkinState skin;
  // Parameters of solids that are set from outside, in every frame anew if need be: they count more
  // than the source's and the drivers'. Those that the flesh lacks are ignored.
  std::vector<Flesh::ParameterOverride> held;
  // Scratch memory, not part of the state's meaning; a copy starts with none.
  SkinWorkspace workspace;
  SoftWorkspace softWorkspace;
  PostureSample sampled;
  std::vector<double> stillBodies;  // velocities of none
};

// Over time, posture, morphs, soft solids and skin: equal exactly when the states are.
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
// The source is asked for times of this frame, in any order. Throws Error if the state is of
// another character (see requireFits in editing.h) and has then changed nothing; else never.
// Allocates nothing after the first calls.
void advance(const Character& character, const PostureSource& source, double dt_s,
             CharacterState& state, SkinStats& stats, Surroundings* surroundings = nullptr);

}  // namespace fascia
