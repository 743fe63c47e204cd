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

void addWeights(const GridSkinMesh& skin, GltfJson& attributes, GlbBuilder& glb) {
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
    attributes["JOINTS_" + std::to_string(set)] = glb.addJoints(joints[set]);
    attributes["WEIGHTS_" + std::to_string(set)] = glb.addWeights(shares[set]);
  }
}

GltfJson targetOf(const GridSkinMesh& skin, std::size_t target, GlbBuilder& glb) {
  const MorphBasis::Target& source = skin.basis.targets[target];
  std::vector<Eigen::Vector3f> points(skin.rig.points_m.size(), Eigen::Vector3f::Zero());
  for (std::size_t k = 0; k < source.points.size(); ++k)
    points[source.points[k]] = source.displacement_m[k];
  std::vector<Eigen::Vector3f> moved, turned;
  for (const std::uint32_t point : skin.rig.pointOf) {
    moved.push_back(points[point]);
    turned.push_back(skin.turns[target][point]);
  }
  return {{"POSITION", glb.addSparseVectors(moved, true)},
          {"NORMAL", glb.addSparseVectors(turned, false)}};
}

}  // namespace

std::size_t addGridSkin(const GridSkinMesh& skin, std::size_t material, GlbBuilder& glb) {
  GltfJson primitive = addPrimitive(skin.rig.surface, material, glb);
  addWeights(skin, primitive["attributes"], glb);
  GltfJson mesh = {{"name", "skin"}};
  if (const std::size_t count = skin.basis.targets.size(); count > 0) {
    GltfJson targets = GltfJson::array(), names = GltfJson::array();
    for (std::size_t k = 0; k < count; ++k) {
      targets.push_back(targetOf(skin, k, glb));
      names.push_back(std::string(k < 9 ? "fascia_morph_0" : "fascia_morph_") +
                      std::to_string(k + 1));
    }
    primitive["targets"] = std::move(targets);
    mesh["weights"] = std::vector<float>(count, 0.0f);
    mesh["extras"] = {{"targetNames", std::move(names)}};
  }
  mesh["primitives"] = GltfJson::array({std::move(primitive)});
  return glb.add("meshes", std::move(mesh));
}

}  // namespace fascia
