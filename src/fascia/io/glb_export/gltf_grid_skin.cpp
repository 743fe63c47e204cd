#include <fascia/io/glb_export/gltf_grid_skin.h>

#include <cmath>
#include <string>

#include <fascia/io/glb_export/gltf_skin.h>

namespace fascia {
namespace {

constexpr int kWhole = 65535;  // weights are told in parts of it

// Rounded so that they sum to the whole exactly, as glTF demands: the heaviest takes the rest.
std::array<std::uint16_t, PointWeights::kMost> rounded(const PointWeights& weights) {
  std::array<std::uint16_t, PointWeights::kMost> out{};
  int left = kWhole;
  for (std::size_t k = PointWeights::kMost; k-- > 1;) {
    const auto share =
        static_cast<int>(std::lround(kWhole * static_cast<double>(weights.weight[k])));
    out[k] = static_cast<std::uint16_t>(share);
    left -= share;
  }
  out[0] = static_cast<std::uint16_t>(left);
  return out;
}

void addWeights(const GridSkinMesh& skin, Json& attributes, GltfBuilder& glb) {
  std::array<std::vector<std::uint16_t>, 2> joints, shares;
  bool more = false;
  for (const std::uint32_t point : skin.rig.pointOf) {
    const PointWeights& w = skin.weights[point];
    const auto share = rounded(w);
    for (std::size_t k = 0; k < PointWeights::kMost; ++k) {
      joints[k / 4].push_back(share[k] > 0 ? w.joint[k] : std::uint16_t{0});
      shares[k / 4].push_back(share[k]);
      more = more || (k >= 4 && share[k] > 0);
    }
  }
  for (std::size_t set = 0; set < (more ? 2u : 1u); ++set) {
    const std::string number = std::to_string(set);
    attributes.set("JOINTS_" + number, glb.document.addJoints(joints[set]));
    attributes.set("WEIGHTS_" + number, glb.document.addShorts(shares[set], "VEC4", true));
  }
}

Json targetOf(const GridSkinMesh& skin, std::size_t target, GltfBuilder& glb) {
  const MorphBasis::Target& source = skin.basis.targets[target];
  std::vector<Eigen::Vector3f> points(skin.rig.points_m.size(), Eigen::Vector3f::Zero());
  for (std::size_t k = 0; k < source.points.size(); ++k)
    points[source.points[k]] = source.displacement_m[k];
  std::vector<Eigen::Vector3f> moved, turned;
  for (const std::uint32_t point : skin.rig.pointOf) {
    moved.push_back(points[point]);
    turned.push_back(skin.turns[target][point]);
  }
  const int positions = glb.addSparseVectors(moved, true);
  return morphTarget(positions, glb.addSparseVectors(turned, false));
}

}  // namespace

int addGridSkin(const GridSkinMesh& skin, int material, GltfBuilder& glb) {
  Json primitive = addPrimitive(skin.rig.surface, material, glb);
  addWeights(skin, ensureMember(primitive, "attributes"), glb);
  MorphTargets targets;
  for (std::size_t k = 0; k < skin.basis.targets.size(); ++k) {
    const std::string name =
        std::string(k < 9 ? "fascia_morph_0" : "fascia_morph_") + std::to_string(k + 1);
    targets.add(targetOf(skin, k, glb), name);
  }
  return addMesh("skin", std::move(primitive), std::move(targets), glb);
}

}  // namespace fascia
