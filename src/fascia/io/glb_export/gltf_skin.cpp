#include <fascia/io/glb_export/gltf_skin.h>

#include <cmath>

#include <fascia/geometry/welded_normals.h>
#include <fascia/io/glb_export/keep_frames.h>
#include <fascia/io/gltf/gltf_animation.h>

namespace fascia {
namespace {

using Positions = std::vector<Eigen::Vector3f>;

// IEC 61966-2-1.
double linearFromSrgb(double c) {
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

// As glTF wants it: linear, with alpha.
Json linearColor(float r, float g, float b) {
  return Json::List{linearFromSrgb(r), linearFromSrgb(g), linearFromSrgb(b), 1.0};
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

void MorphTargets::add(Json target, const std::string& name, float weight) {
  targets.push_back(std::move(target));
  names.emplace_back(name);
  weights.push_back(weight);
}

Json morphTarget(int positions, int normals) {
  return Json::Object{{"POSITION", positions}, {"NORMAL", normals}};
}

int addMesh(const std::string& name, Json primitive, MorphTargets targets, GltfBuilder& glb) {
  Json mesh = Json::Object{{"name", name}};
  if (!targets.targets.empty()) {
    primitive.set("targets", std::move(targets.targets));
    mesh.set("weights", numberList(targets.weights));
    mesh.set("extras", Json::Object{{"targetNames", std::move(targets.names)}});
  }
  mesh.set("primitives", Json::List{std::move(primitive)});
  return glb.add("meshes", std::move(mesh));
}

int addSkinMaterial(const SkinDef& def, const Texture& texture, GltfBuilder& glb) {
  Json surface = Json::Object{{"metallicFactor", 0.0}, {"roughnessFactor", 0.6}};
  if (texture.empty()) {
    surface.set("baseColorFactor", linearColor(def.color[0], def.color[1], def.color[2]));
  } else {
    const int image = glb.document.addImage(
        {reinterpret_cast<const std::uint8_t*>(texture.bytes.data()), texture.bytes.size()});
    const int sampler = glb.add("samplers", Json::Object{{"magFilter", 9729}, {"minFilter", 9987}});
    const int index = glb.add("textures", Json::Object{{"sampler", sampler}, {"source", image}});
    surface.set("baseColorTexture", Json::Object{{"index", index}});
  }
  return glb.add("materials",
                 Json::Object{{"name", "skin"}, {"pbrMetallicRoughness", std::move(surface)}});
}

int addMaterial(const Color& color, double roughness, GltfBuilder& glb) {
  Json surface = Json::Object{{"baseColorFactor", linearColor(color.r, color.g, color.b)},
                              {"metallicFactor", 0.0},
                              {"roughnessFactor", roughness}};
  return glb.add("materials", Json::Object{{"pbrMetallicRoughness", std::move(surface)}});
}

Json addPrimitive(const TriangleMesh& mesh, int material, GltfBuilder& glb) {
  const auto vertices = GltfBuilder::Target::vertices;
  Json attributes = Json::Object{{"POSITION", glb.addVectors(mesh.positions, true, vertices)},
                                 {"NORMAL", glb.addVectors(mesh.normals, false, vertices)}};
  if (!mesh.uvs.empty()) attributes.set("TEXCOORD_0", glb.addUvs(mesh.uvs));
  const int indices = glb.addIndices({mesh.triangles.data()->data(), 3 * mesh.triangles.size()});
  return Json::Object{
      {"attributes", std::move(attributes)}, {"indices", indices}, {"material", material}};
}

int addSkinMesh(const SkinDef& def, const Recording& recording, const Texture& texture,
                double tolerance_m, GltfBuilder& glb, std::vector<std::size_t>& kept) {
  kept = keepSkinFrames(recording, tolerance_m);
  TriangleMesh mesh = recording.skin;
  mesh.positions = recording.frames[kept.front()].skin_m;
  const WeldedNormals welded(mesh);
  welded.compute(mesh.positions, mesh.normals);

  Json primitive = addPrimitive(mesh, addSkinMaterial(def, texture, glb), glb);

  const double unseenNormal = tolerance_m > 0 ? 0.004 : 0;  // a quarter of a degree
  MorphTargets targets;
  Positions normals;
  for (std::size_t k = 1; k < kept.size(); ++k) {
    const Positions& frame = recording.frames[kept[k]].skin_m;
    welded.compute(frame, normals);
    const Positions moved = difference(frame, mesh.positions, tolerance_m / 4);
    const Positions turned = difference(normals, mesh.normals, unseenNormal);
    const int positions = glb.addSparseVectors(moved, true);
    targets.add(morphTarget(positions, glb.addSparseVectors(turned, false)),
                "frame " + std::to_string(kept[k]));
  }
  return addMesh("skin", std::move(primitive), std::move(targets), glb);
}

void addSkinAnimation(const Recording& recording, const std::vector<std::size_t>& kept, int node,
                      GltfBuilder& glb, Json& animation) {
  if (kept.size() < 2) return;
  const std::size_t targets = kept.size() - 1;
  std::vector<float> times, weights(kept.size() * targets, 0.0f);
  for (std::size_t k = 0; k < kept.size(); ++k) {
    times.push_back(
        static_cast<float>(recording.frames[kept[k]].time_s - recording.frames.front().time_s));
    if (k > 0) weights[k * targets + k - 1] = 1;
  }
  const int input = glb.addScalars(times, true);
  addGltfTrack(animation, input, glb.addScalars(weights, false), node, "weights");
}

}  // namespace fascia
