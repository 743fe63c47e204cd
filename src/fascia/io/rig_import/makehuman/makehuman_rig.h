#pragma once

#include <string>
#include <utility>
#include <vector>

#include <fascia/io/rig_import/makehuman/makehuman_mesh.h>

namespace fascia {

// Part of readMakeHuman(): bones that hang on the mesh, and the weights of its points.
struct MakeHumanBone {
  std::string name;
  int parent = -1;                                // parents come first; one root
  Vec3 head = Vec3::Zero(), tail = Vec3::Zero();  // in the mesh's unit
  double roll_rad = 0;  // about the bone, from the shortest turn of +y onto it, in Blender's axes
};

struct MakeHumanRig {
  std::vector<MakeHumanBone> bones;
  // Per point of the mesh: bone and weight, as they stand in the file.
  std::vector<std::vector<std::pair<std::uint16_t, float>>> weights;
};

// Either format of rig: MakeHuman's .mhskel or MPFB's rig.NAME.json. Throws Error.
MakeHumanRig readMakeHumanRig(const std::string& path, const ObjMesh& mesh);

}  // namespace fascia
