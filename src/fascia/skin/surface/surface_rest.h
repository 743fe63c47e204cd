#pragma once

#include <cstdint>
#include <vector>

#include <fascia/base/ids.h>
#include <fascia/field/solid.h>
#include <fascia/rig/rigged_model.h>
#include <fascia/skin/def/skin_def.h>
#include <fascia/skin/mesh/mesh_topology.h>

namespace fascia {

// All that the rest shape of a skin around its solids' surface depends on.
struct SurfaceRestKey {
  SkinSurfaceDef surface;
  double fat_m = 0;
  std::vector<SolidDef> solids;  // as they are written
  std::vector<JointId> joints;   // of the solids
  std::vector<Transform> frames;
  std::vector<std::vector<double>> parameters;  // as they are driven at rest
  bool operator==(const SurfaceRestKey&) const = default;
};

// A skin laid around the surface of its solids. Constant; shared by the skins that are edited from
// each other. Points are numbered by storage.
struct SurfaceRest {
  SurfaceRestKey key;
  std::vector<TriangleMembrane::Corners> triangles;  // counter-clockwise from outside
  MeshTopology::Drawn drawn;
  std::vector<SolidId> solid;         // that each point is tied to
  std::vector<PointWeights> weights;  // of each point, by joints of the skeleton: which are near
};

}  // namespace fascia
