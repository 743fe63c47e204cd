// All that a program outside of this tree needs: describe, read or edit a character, move it by a
// source of its own, see its surface, record it, write files and pictures. See docs/library.md.
//
// Everything else is behind it: what this header does not reach is not installed.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <fascia/character/editing.h>
#include <fascia/character/recording.h>
#include <fascia/io/state/state_file.h>
#include <fascia/render/pixels.h>
#include <fascia/track/blend_source.h>
#include <fascia/track/drag_source.h>
#include <fascia/track/reach_source.h>
#include <fascia/track/stream_source.h>

namespace fascia {

// A *.fascia.json and the rig that it names. Throws Error with every fault of the file.
CharacterDef readCharacter(const std::string& path);
// Whole or not at all. Throws Error.
void writeCharacter(const CharacterDef& def, const std::string& path);
// A character of a rigged mesh (.glb, .gltf, .fbx, …), with flesh fitted into it. Throws Error.
CharacterDef fleshRig(const std::string& path);

// What there is to see of the skin in a state, with normals; empty without a skin. Reuses the
// memory of `surface`.
void seeSurface(const Character& character, const CharacterState& state, TriangleMesh& surface);

// A binary glTF of one recording: the skin with a baked animation, skeleton, ornaments. Whole or
// not at all. Throws Error.
void writeAnimation(const Character& character, const Recording& recording,
                    const std::string& path);

struct PictureOptions {
  int width = 1280, height = 720;  // [1, 8192] each
  std::string layers = "skin";     // any of skin, muscle, skeleton, by commas; or all
  std::string camera;              // "front", "side", "az=30,el=15", …; empty: the usual
  bool ground = true;
};

// Draws characters without a window. Keeps what it has made ready: draw many pictures with one. For
// one thread at a time.
class Painter {
 public:
  Painter();  // throws Error with what to install when there is no OpenGL
  ~Painter();
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  // Frames what there is to see. The character must outlive the painter or the next picture of
  // another. Throws Error with every fault of the options.
  Pixels draw(const Character& character, const CharacterState& state,
              const PictureOptions& options = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// PNG, whole or not at all. Throws Error.
void writePicture(const Pixels& picture, const std::string& path);

}  // namespace fascia
