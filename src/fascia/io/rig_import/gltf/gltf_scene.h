#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <fascia/io/gltf/gltf_document.h>
#include <fascia/io/rig_model/rig_limits.h>
#include <fascia/math/types.h>

namespace fascia {

using Affine = Eigen::AffineCompact3d;

struct GltfNode {
  std::string name;
  int parent = -1, mesh = -1, skin = -1;
  bool inScene = false;                // of the scene that is shown
  Affine matrix = Affine::Identity();  // as given, if hasMatrix
  bool hasMatrix = false;
  Vec3 translation = Vec3::Zero(), scale = Vec3::Ones();
  Quat rotation = Quat::Identity();

  Affine local() const;
};

// The tree of nodes; numbers in it are finite and of a size that can be computed with.
struct GltfScene {
  std::vector<GltfNode> nodes;
  std::vector<int> order;          // parents before children, as the file lists them
  int shown = -1;                  // the scene that is shown; -1: the file has none
  double scale = 1;                // from the file's unit to metres
  std::vector<Affine> rest_world;  // per node, in metres

  // The default scene is shown, unless there is a character in another one only. Throws Error for
  // trees that are none; notes what was mended.
  static GltfScene of(const GltfDocument& document, double scale, std::vector<std::string>& notes);

  // World matrices of some nodes, parents first, from local ones (both per node).
  void toWorld(const std::vector<Affine>& local, const std::vector<int>& some,
               std::vector<Affine>& world) const;
};

inline bool isSane(const Affine& m) {
  for (Eigen::Index i = 0; i < 12; ++i) {
    if (!isSane(m.matrix().data()[i])) return false;
  }
  return true;
}

// The rotation of the polar decomposition m = rotation · stretch (Higham 1986, Newton's iteration);
// for a mirroring m that of −m. `fallback` where m has no inverse.
Mat3 rotationOf(const Mat3& m, const Mat3& fallback);

inline Transform rigidPart(const Affine& m, const Mat3& fallback) {
  return {rotationOf(m.linear(), fallback), m.translation()};
}

}  // namespace fascia
