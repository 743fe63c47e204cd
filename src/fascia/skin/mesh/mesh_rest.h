#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/base/ids.h>
#include <fascia/field/solid.h>
#include <fascia/math/types.h>
#include <fascia/skin/def/skin_def.h>

namespace fascia {

// What the rest of an imported mesh depends on besides the mesh itself: joints and solids in the
// rest posture, and which of it is simulated.
struct MeshRestKey {
  std::vector<std::size_t> joints;      // of the skeleton, per joint of the rig
  std::vector<Transform> joints_world;  // at rest
  std::vector<SolidDef> solids;         // of the flesh, as they are written
  std::vector<JointId> solidJoints;
  std::vector<Transform> solidFrames;
  std::vector<std::vector<double>> solidParameters;  // as they are driven at rest
  std::vector<SkinPartDef> parts;
  bool simulated = false;
  bool operator==(const MeshRestKey&) const = default;
};

// An imported mesh on its flesh in the rest posture: what no material, fat or dial changes. Made
// once, shared by the skins that are edited from each other. Constant.
struct MeshRest {
  MeshRestKey key;
  // Per point of the model:
  std::vector<Vec3> normals;    // unit
  std::vector<double> edges_m;  // mean length of the edges around; 0 without any
  std::vector<float> gap_m;     // from the nearest solid beneath
  std::vector<SolidId> solid;   // that one
  std::vector<char> covered;    // whether it counts as flesh beneath
  std::vector<char> fixed;      // never simulated
  std::vector<char> rigid;      // carried by its joints as it is
  std::vector<std::uint32_t> storageOf;

  std::vector<std::uint32_t> order;  // model point per storage index
  std::size_t elasticCount = 0;      // the first so many in storage are simulated
};

}  // namespace fascia
