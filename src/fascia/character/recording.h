#pragma once

#include <functional>
#include <string>
#include <vector>

#include <fascia/character/character.h>

namespace fascia {

// A simulated motion, frame by frame: what a bake writes and a player reads.
struct Recording {
  struct Frame {
    double time_s = 0;
    std::vector<double> posture;          // Posture::values
    std::vector<Eigen::Vector3f> skin_m;  // vertices in skinSurface order; may be empty
    std::vector<double> soft_shapes;      // SoftFlesh::shapes; empty without soft solids
    std::vector<Flesh::ParameterOverride> parameters{};  // that the source animated; not in caches
    std::vector<double> morphs{};                        // weights, one per morph
  };
  std::string motion;  // PostureSource::Info::name; empty = none of the character's
  double frame_rate_hz = 60;
  bool loop = false;
  TriangleMesh skin;  // topology and uvs; positions = the first frame's
  std::vector<Frame> frames;
  SkinStats stats;
  double wall_s = 0, simulated_s = 0;
  std::uint64_t state_hash = 0;  // of the last CharacterState
};

// The parts of recording a run that somebody else takes through time: a recording of what moves the
// character, without frames; the state as its next frame, measured (and kept unless `kept` is
// false); what is known at the end.
Recording startRecording(const PostureSource& source, double frame_rate_hz);
void keepFrame(const Character& character, const CharacterState& state, bool kept, Recording& out);
void finishRecording(const Character& character, const CharacterState& last, Recording& out);

struct RecordOptions {
  double frame_rate_hz = 0;  // 0 = as in the file
  double duration_s = 0;     // 0 = the source's, or what is left of it after `from`
  double start_s = 0;        // frames before this are simulated, but not kept
  // The run goes on from this state, which is its first frame; nullptr: from the initial one.
  const CharacterState* from = nullptr;
  CharacterState* last = nullptr;  // becomes the state at the end, if given
  // Called after every frame with the fraction done; false stops (recording is then discarded).
  std::function<bool(double)> progress;
};

// Throws Error("stopped") when progress asked to stop, and if `from` is not of this character.
Recording record(const Character& character, const PostureSource& source,
                 const RecordOptions& options = {});

}  // namespace fascia
