#pragma once

#include <optional>
#include <span>
#include <vector>

#include <fascia/character/character.h>
#include <fascia/character/recording.h>
#include <fascia/geometry/welded_normals.h>
#include <fascia/render/blended_skin.h>
#include <fascia/render/camera.h>
#include <fascia/render/crease_normals.h>

namespace fascia {

// The frame closest to a time. Throws Error if the time lies outside of them.
std::size_t closestFrame(std::span<const double> times_s, double frameRate_hz, double time_s);

// Shows a recording again: the character's layers and its skin at any recorded moment, without
// simulating, whatever moved it. Both must outlive it.
class Player {
 public:
  Player(const Character& character, const Recording& recording);

  // Goes to the frame closest to a time. Throws Error if the time lies outside of the recording.
  void seek(double time_s);

  const CharacterState& state() const { return state_; }  // skeleton, flesh, ornaments only
  const TriangleMesh& skin() const { return skin_; }      // with normals; may be empty

 private:
  const Character& character_;
  const Recording& recording_;
  std::vector<double> times_s_;  // of the frames
  ClipSource motion_;            // what was recorded, for its parameters; rest if it is none
  CharacterState state_;
  TriangleMesh skin_;
  WeldedNormals normals_;
  // Of an imported character: its own normals, and its own skinning where nothing was simulated.
  std::optional<CreaseNormals> creases_;
  std::optional<BlendedSkin> blended_;
};

// Everything that flesh, ornaments and an imported surface reach while a source moves them; one
// without an end counts at time 0 only. It does not depend on what part of it is simulated: a
// camera that frames it shows a picture, a video and a cache from the same place.
Reach motionReach(const Character& character, const PostureSource& source);

// Where the floor belongs: at 0, or below what stands or moves deeper, or under an imported
// character whose file has its feet elsewhere.
double floorHeight(const Character& character, const Reach& reach);

}  // namespace fascia
