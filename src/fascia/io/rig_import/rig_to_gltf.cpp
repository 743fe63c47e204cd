#include <fascia/io/rig_import/rig_to_gltf.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <string_view>

#include <fascia/base/error.h>
#include <fascia/io/rig_import/assimp/assimp_import.h>
#include <fascia/io/rig_import/makehuman/makehuman_import.h>

namespace fascia {
namespace {

constexpr const char* kEmpty = R"({"asset": {"version": "2.0", "generator": "Fascia"}})";

Json object() {
  return Json(Json::Object{});
}

template <class Values>
Json listOf(const Values& values) {
  Json::List list;
  for (const auto value : values) list.push_back(Json(static_cast<double>(value)));
  return Json(std::move(list));
}

// All rows of one kind as plain numbers.
template <class T>
std::span<const float> floatsOf(const std::vector<T>& rows) {
  static_assert(sizeof(T) % sizeof(float) == 0);
  return {reinterpret_cast<const float*>(rows.data()), rows.size() * sizeof(T) / sizeof(float)};
}

class Converter {
 public:
  explicit Converter(const RiggedModel& model)
      : model_(model), document_(GltfDocument::parse(kEmpty, model.sourceFile)) {}

  GltfDocument run() {
    addJoints();
    for (std::size_t m = 0; m < model_.materials.size(); ++m) addMaterial(model_.materials[m]);
    for (const RigPart& part : model_.parts) addPart(part);
    for (const SampledMotion& motion : model_.motions) addMotion(motion);
    Json& json = document_.json();
    Json scene = object();
    scene.set("nodes", listOf(top_));
    json.set("scene", 0);
    json.set("scenes", Json::List{std::move(scene)});
    set("nodes", nodes_);
    set("meshes", meshes_);
    set("skins", skins_);
    set("materials", materials_);
    set("textures", textures_);
    set("animations", animations_);
    return std::move(document_);
  }

 private:
  void set(const char* name, Json::List& list) {
    if (!list.empty()) document_.json().set(name, std::move(list));
  }
  void addJoints();
  void addMaterial(const RigMaterial& material);
  void addPart(const RigPart& part);
  Json attributesOf(const RigPart& part);
  void addInfluences(const RigPart& part, Json& attributes);
  void addMotion(const SampledMotion& motion);
  int textureOf(const std::vector<std::uint8_t>& picture);

  const RiggedModel& model_;
  GltfDocument document_;
  Json::List nodes_, meshes_, skins_, materials_, textures_, animations_;
  std::vector<int> top_;                       // nodes of the scene
  std::map<std::string_view, int> textureOf_;  // by the picture's bytes, which the model keeps
};

void Converter::addJoints() {
  std::vector<std::vector<int>> children(model_.joints.size());
  std::vector<Eigen::Matrix4f> inverseBind;
  std::vector<int> all;
  for (std::size_t j = 0; j < model_.joints.size(); ++j) {
    const RigJoint& joint = model_.joints[j];
    const int self = static_cast<int>(j);
    all.push_back(self);
    (joint.parent < 0 ? top_ : children[static_cast<std::size_t>(joint.parent)]).push_back(self);
    const Transform inverse = joint.rest_world.inverse();
    Eigen::Matrix4f matrix = Eigen::Matrix4f::Identity();
    matrix.topLeftCorner<3, 3>() = inverse.rotation.cast<float>();
    matrix.topRightCorner<3, 1>() = inverse.translation_m.cast<float>();
    inverseBind.push_back(matrix);
  }
  for (std::size_t j = 0; j < model_.joints.size(); ++j) {
    const RigJoint& joint = model_.joints[j];
    const Transform local =
        joint.parent < 0
            ? joint.rest_world
            : model_.joints[static_cast<std::size_t>(joint.parent)].rest_world.inverse() *
                  joint.rest_world;
    Json node = object();
    node.set("name", joint.name);
    node.set("translation", listOf(local.translation_m));
    node.set("rotation", listOf(Quat(local.rotation).normalized().coeffs()));
    if (!children[j].empty()) node.set("children", listOf(children[j]));
    nodes_.push_back(std::move(node));
  }
  Json skin = object();
  skin.set("joints", listOf(all));
  skin.set("inverseBindMatrices", document_.addFloats(floatsOf(inverseBind), "MAT4"));
  skins_.push_back(std::move(skin));
}

int Converter::textureOf(const std::vector<std::uint8_t>& picture) {
  const std::string_view bytes(reinterpret_cast<const char*>(picture.data()), picture.size());
  const auto [found, isNew] = textureOf_.try_emplace(bytes, static_cast<int>(textures_.size()));
  if (isNew) {
    Json texture = object();
    texture.set("source", document_.addImage(picture));
    textures_.push_back(std::move(texture));
  }
  return found->second;
}

void Converter::addMaterial(const RigMaterial& material) {
  const auto within = [](float value) { return std::clamp(value, 0.0f, 1.0f); };
  std::array<float, 4> color = material.color;
  for (float& c : color) c = within(c);
  Json surface = object();
  surface.set("baseColorFactor", listOf(color));
  surface.set("metallicFactor", static_cast<double>(within(material.metallic)));
  surface.set("roughnessFactor", static_cast<double>(within(material.roughness)));
  if (!material.texture.empty()) {
    Json use = object();
    use.set("index", textureOf(material.texture));
    surface.set("baseColorTexture", std::move(use));
  }
  Json out = object();
  out.set("name", material.name);
  out.set("pbrMetallicRoughness", std::move(surface));
  if (material.doubleSided) out.set("doubleSided", true);
  materials_.push_back(std::move(out));
}

// Four influences a set; the second only where a point has more.
void Converter::addInfluences(const RigPart& part, Json& attributes) {
  std::vector<std::uint16_t> joints[2];
  std::vector<float> weights[2];
  bool more = false;
  for (std::uint32_t v = 0; v < part.vertexCount; ++v) {
    const PointWeights& w = model_.weights[model_.vertices[part.firstVertex + v].point];
    for (std::size_t i = 0; i < PointWeights::kMost; ++i) {
      joints[i / 4].push_back(w.joint[i]);
      weights[i / 4].push_back(w.weight[i]);
      more = more || (i >= 4 && w.weight[i] > 0);
    }
  }
  for (std::size_t set = 0; set < (more ? 2u : 1u); ++set) {
    const std::string number = std::to_string(set);
    attributes.set(std::string("JOINTS_") + number, document_.addShorts(joints[set], "VEC4"));
    attributes.set(std::string("WEIGHTS_") + number, document_.addFloats(weights[set], "VEC4"));
  }
}

Json Converter::attributesOf(const RigPart& part) {
  std::vector<Eigen::Vector3f> positions, normals;
  std::vector<Eigen::Vector2f> uvs;
  for (std::uint32_t v = 0; v < part.vertexCount; ++v) {
    const RigVertex& vertex = model_.vertices[part.firstVertex + v];
    positions.push_back(model_.points_m[vertex.point]);
    const float length = vertex.normal.norm();
    normals.push_back(length > 1e-6f ? Eigen::Vector3f(vertex.normal / length)
                                     : Eigen::Vector3f::UnitY());
    uvs.push_back(vertex.uv);
  }
  Json attributes = object();
  attributes.set("POSITION", document_.addFloats(floatsOf(positions), "VEC3", true));
  attributes.set("NORMAL", document_.addFloats(floatsOf(normals), "VEC3"));
  attributes.set("TEXCOORD_0", document_.addFloats(floatsOf(uvs), "VEC2"));
  addInfluences(part, attributes);
  return attributes;
}

void Converter::addPart(const RigPart& part) {
  if (part.vertexCount == 0 || part.triangleCount == 0) return;
  std::vector<std::uint32_t> indices;
  for (std::uint32_t t = 0; t < part.triangleCount; ++t) {
    for (const std::uint32_t v : model_.drawnTriangles[part.firstTriangle + t]) {
      indices.push_back(v - part.firstVertex);
    }
  }
  Json primitive = object();
  primitive.set("attributes", attributesOf(part));
  primitive.set("indices", document_.addIndices(indices));
  if (part.material >= 0) primitive.set("material", part.material);
  Json mesh = object();
  mesh.set("name", part.name);
  mesh.set("primitives", Json::List{std::move(primitive)});
  Json node = object();
  node.set("name", part.name);
  node.set("mesh", static_cast<int>(meshes_.size()));
  node.set("skin", 0);
  meshes_.push_back(std::move(mesh));
  top_.push_back(static_cast<int>(nodes_.size()));
  nodes_.push_back(std::move(node));
}

// A key per frame. A motion that loops ends with its first frame, as players expect.
void Converter::addMotion(const SampledMotion& motion) {
  const std::size_t count = motion.joints.size(), frames = motion.frameCount();
  const std::size_t keys = frames + (motion.loop && frames > 1 ? 1 : 0);
  std::vector<float> times;
  for (std::size_t k = 0; k < keys; ++k) {
    times.push_back(static_cast<float>(static_cast<double>(k) / motion.rate_hz));
  }
  const int input = document_.addFloats(times, "SCALAR", true);
  Json::List samplers, channels;
  const auto addChannel = [&](int node, const char* path, int output) {
    Json sampler = object(), target = object(), channel = object();
    sampler.set("input", input);
    sampler.set("output", output);
    target.set("node", node);
    target.set("path", path);
    channel.set("sampler", static_cast<int>(samplers.size()));
    channel.set("target", std::move(target));
    samplers.push_back(std::move(sampler));
    channels.push_back(std::move(channel));
  };
  std::map<std::string, int> joints;
  for (std::size_t j = 0; j < model_.joints.size(); ++j) {
    joints.emplace(model_.joints[j].name, static_cast<int>(j));
  }
  for (std::size_t j = 0; j < count; ++j) {
    const auto node = joints.find(motion.joints[j]);
    if (node == joints.end()) continue;
    std::vector<Eigen::Vector4f> turns;
    std::vector<Eigen::Vector3f> places;
    for (std::size_t k = 0; k < keys; ++k) {
      const std::size_t i = k % frames * count + j;
      turns.push_back(motion.rotation[i].normalized().coeffs());
      places.push_back(motion.translation_m[i]);
    }
    addChannel(node->second, "rotation", document_.addFloats(floatsOf(turns), "VEC4"));
    addChannel(node->second, "translation", document_.addFloats(floatsOf(places), "VEC3"));
  }
  if (channels.empty()) return;
  Json animation = object();
  animation.set("name", motion.name);
  animation.set("samplers", std::move(samplers));
  animation.set("channels", std::move(channels));
  animations_.push_back(std::move(animation));
}

std::string endingOf(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

}  // namespace

GltfDocument gltfOf(const RiggedModel& model) {
  return Converter(model).run();
}

void writeRigGlb(const RiggedModel& model, const std::string& path) {
  gltfOf(model).writeGlb(path);
}

GltfDocument readAsGltf(const std::string& path) {
  const std::string ending = endingOf(path);
  if (ending == ".glb" || ending == ".gltf" || ending == ".vrm") return GltfDocument::read(path);
  if (isMakeHuman(path)) return gltfOf(readMakeHuman(path));
  if (isAssimpEnding(ending)) return readWithAssimp(path);
  Issue issue;
  issue.where.file = path;
  issue.message = "has the ending \"" + ending + "\", which Fascia can't read a character from";
  issue.hint = "export it as .glb";
  throw Error(std::move(issue));
}

}  // namespace fascia
