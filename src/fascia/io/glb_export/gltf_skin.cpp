#include <fascia/io/glb_export/gltf_skin.h>

#include <cmath>

#include <fascia/geometry/welded_normals.h>
#include <fascia/io/glb_export/keep_frames.h>

namespace fascia {
namespace {

using Positions = std::vector<Eigen::Vector3f>;

// IEC 61966-2-1.
double linearFromSrgb(double c) {
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

std::vector<std::size_t> keepSkinFrames(const Recording& recording, double tolerance_m) {
  const auto limit = static_cast<float>(tolerance_m * tolerance_m);
  return keepFrames(recording.frames.size(), [&](std::size_t a, std::size_t b) {
    const Recording::Frame& first = recording.frames[a];
    const Recording::Frame& last = recording.frames[b];
    for (std::size_t f = a + 1; f < b; ++f) {
      const Recording::Frame& frame = recording.frames[f];
      const auto s =
          static_cast<float>((frame.time_s - first.time_s) / (last.time_s - first.time_s));
      for (std::size_t v = 0; v < frame.skin_m.size(); ++v) {
        const Eigen::Vector3f blend = first.skin_m[v] + s * (last.skin_m[v] - first.skin_m[v]);
        if (!((blend - frame.skin_m[v]).squaredNorm() <= limit)) return false;
      }
    }
    return true;
  });
}

// value - base, with what nobody would see set to zero so that it need not be stored.
Positions difference(const Positions& value, const Positions& base, double unseen) {
  Positions out(value.size());
  for (std::size_t v = 0; v < value.size(); ++v) {
    out[v] = value[v] - base[v];
    if (static_cast<double>(out[v].norm()) <= unseen) out[v].setZero();
  }
  return out;
}

}  // namespace

void GltfAnimation::add(std::size_t times, std::size_t values, std::size_t node, const char* path) {
  samplers.push_back({{"input", times}, {"output", values}, {"interpolation", "LINEAR"}});
  channels.push_back(
      {{"sampler", samplers.size() - 1}, {"target", {{"node", node}, {"path", path}}}});
}

std::size_t addSkinMaterial(const SkinDef& def, const Texture& texture, GlbBuilder& glb) {
  GltfJson surface = {{"metallicFactor", 0.0}, {"roughnessFactor", 0.6}};
  if (texture.empty()) {
    surface["baseColorFactor"] = linearColor(def.color[0], def.color[1], def.color[2]);
  } else {
    const std::size_t image = glb.addImage(texture.bytes, texture.mimeType());
    const std::size_t sampler = glb.add("samplers", {{"magFilter", 9729}, {"minFilter", 9987}});
    const std::size_t index = glb.add("textures", {{"sampler", sampler}, {"source", image}});
    surface["baseColorTexture"] = {{"index", index}};
  }
  return glb.add("materials", {{"name", "skin"}, {"pbrMetallicRoughness", surface}});
}

GlbBuilder::Json linearColor(float r, float g, float b) {
  return {linearFromSrgb(r), linearFromSrgb(g), linearFromSrgb(b), 1.0};
}

GlbBuilder::Json addPrimitive(const TriangleMesh& mesh, std::size_t material, GlbBuilder& glb) {
  const auto vertices = GlbBuilder::Target::vertices;
  GltfJson attributes = {{"POSITION", glb.addVectors(mesh.positions, true, vertices)},
                         {"NORMAL", glb.addVectors(mesh.normals, false, vertices)}};
  if (!mesh.uvs.empty()) attributes["TEXCOORD_0"] = glb.addUvs(mesh.uvs);
  GltfJson primitive = {{"attributes", std::move(attributes)}};
  primitive["indices"] = glb.addIndices({mesh.triangles.data()->data(), 3 * mesh.triangles.size()},
                                        mesh.positions.size());
  primitive["material"] = material;
  return primitive;
}

std::size_t addSkinMesh(const SkinDef& def, const Recording& recording, const Texture& texture,
                        double tolerance_m, GlbBuilder& glb, std::vector<std::size_t>& kept) {
  kept = keepSkinFrames(recording, tolerance_m);
  TriangleMesh mesh = recording.skin;
  mesh.positions = recording.frames[kept.front()].skin_m;
  const WeldedNormals welded(mesh);
  welded.compute(mesh.positions, mesh.normals);

  GltfJson primitive = addPrimitive(mesh, addSkinMaterial(def, texture, glb), glb);

  const double unseenNormal = tolerance_m > 0 ? 0.004 : 0;  // a quarter of a degree
  GltfJson targets = GltfJson::array(), names = GltfJson::array();
  Positions normals;
  for (std::size_t k = 1; k < kept.size(); ++k) {
    const Positions& frame = recording.frames[kept[k]].skin_m;
    welded.compute(frame, normals);
    const Positions moved = difference(frame, mesh.positions, tolerance_m / 4);
    const Positions turned = difference(normals, mesh.normals, unseenNormal);
    targets.push_back({{"POSITION", glb.addSparseVectors(moved, true)},
                       {"NORMAL", glb.addSparseVectors(turned, false)}});
    names.push_back("frame " + std::to_string(kept[k]));
  }
  GltfJson out = {{"name", "skin"}};
  if (!targets.empty()) {
    primitive["targets"] = targets;
    out["weights"] = std::vector<float>(targets.size(), 0.0f);
    out["extras"] = {{"targetNames", names}};
  }
  out["primitives"] = GltfJson::array({primitive});
  return glb.add("meshes", std::move(out));
}

void addSkinAnimation(const Recording& recording, const std::vector<std::size_t>& kept,
                      std::size_t node, GlbBuilder& glb, GltfAnimation& animation) {
  if (kept.size() < 2) return;
  const std::size_t targets = kept.size() - 1;
  std::vector<float> times, weights(kept.size() * targets, 0.0f);
  for (std::size_t k = 0; k < kept.size(); ++k) {
    times.push_back(
        static_cast<float>(recording.frames[kept[k]].time_s - recording.frames.front().time_s));
    if (k > 0) weights[k * targets + k - 1] = 1;
  }
  animation.add(glb.addScalars(times, true), glb.addScalars(weights, false), node, "weights");
}

}  // namespace fascia
