#pragma once

#include <span>
#include <string>
#include <vector>

#include <fascia/baking/morph_basis.h>
#include <fascia/baking/skinning_decomposition.h>
#include <fascia/character/recording.h>
#include <fascia/rig/rigged_model.h>

namespace fascia {

// A simulated motion of an imported character, to be written back into the file that it came from.
struct RigClip {
  // If it came from a glTF, that must be unchanged since it was read.
  const RiggedModel& model;
  const Recording& recording;  // skin_m: model.vertices, in their order; morphs: the model's
  // Frame by frame, per joint of the model: the world frames that the skin was simulated with.
  const std::vector<std::vector<Transform>>& joints_world;
  std::string motion;  // name of the animation: an old one of this name is replaced
  double scale = 1;    // that the model was read with (RigDef::scale)
};

// How far the written file, read back and played, is from what it should play: all vertices, all
// frames.
struct BakeError {
  double rms_mm = 0, max_mm = 0;
};

struct RigBakeReport {
  struct Motion {
    std::string name;
    BakeError error;
  };
  BakeError error;                 // over all motions that were baked
  std::size_t added = 0;           // helper bones or morph targets
  std::vector<std::string> files;  // written
  std::vector<Motion> baked;       // against the simulation
  std::vector<Motion> others;      // the file's other motions, against its own skinning
  std::vector<std::string> notes;  // what was left out of the file, for a person
  bool plain = false;  // nothing moved beyond that skinning: nothing was looked for, nothing added
};

// Each writes a whole GLB or nothing, and throws Error. Everything of a source glTF that is not
// about the baked motions survives: names, joints, materials, pictures, extensions, extras, other
// meshes and other animations. Of other formats what the model holds survives, in metres. All clips
// are of one model, and have names of their own.

// What is done to the rest of the file.
struct RigFileOptions {
  // Of a VRM: swinging chains whose joints move the skin are taken out, as the bake moves that
  // already; players would swing it once more.
  bool replaceSprings = false;
};

// Helper bones below the rig's joints and new weights, the same for all motions: plays in every
// engine. In the file's other motions helpers move so that the surface stays as it was there.
RigBakeReport writeRigAsBones(std::span<const RigClip> clips, const DecompositionOptions& options,
                              const std::string& path, const RigFileOptions& file = {});

// Morph targets, the same for all motions, on top of the rig's own skinning, after those that the
// file has. Vertices at one place get one vertex' weights, as they were simulated: seams stay
// closed.
RigBakeReport writeRigAsMorphs(std::span<const RigClip> clips, const MorphOptions& options,
                               const std::string& path, const RigFileOptions& file = {});

inline RigBakeReport writeRigAsBones(const RigClip& clip, const DecompositionOptions& options,
                                     const std::string& path, const RigFileOptions& file = {}) {
  return writeRigAsBones(std::span<const RigClip>(&clip, 1), options, path, file);
}
inline RigBakeReport writeRigAsMorphs(const RigClip& clip, const MorphOptions& options,
                                      const std::string& path, const RigFileOptions& file = {}) {
  return writeRigAsMorphs(std::span<const RigClip>(&clip, 1), options, path, file);
}

// Whether the model's file is a VRM, which what is written for it stays but as a cache.
bool isVrm(const RiggedModel& model);

// The rest surface without a skeleton as a GLB, and for every mesh a point cache of all frames in
// two formats beside it: "fox.glb" gets "fox.pc2" and "fox.mdd", with the mesh' name in between if
// there are several. The first tells all names, the .glb's first.
std::vector<std::string> filesOfRigCache(const RiggedModel& model, const std::string& path);
RigBakeReport writeRigAsCache(const RigClip& clip, const std::string& path);

}  // namespace fascia
