#include <fascia/io/rig_export/model_gltf.h>

#include <algorithm>
#include <map>
#include <string_view>

#include <fascia/io/gltf/gltf_animation.h>
#include <fascia/io/rig_import/rig_import.h>

namespace fascia {
namespace {

// All rows of one kind as plain numbers.
template <class T>
std::span<const float> floatsOf(const std::vector<T>& rows) {
  static_assert(sizeof(T) % sizeof(float) == 0);
  return {reinterpret_cast<const float*>(rows.data()), rows.size() * sizeof(T) / sizeof(float)};
}

class ModelConverter {
 public:
  explicit ModelConverter(const RiggedModel& model) : model_(model), document_(model.sourceFile) {}

  GltfDocument run() {
    addJoints();
    for (std::size_t m = 0; m < model_.materials.size(); ++m) addMaterial(model_.materials[m]);
    for (const RigPart& part : model_.parts) addPart(part);
    for (const SampledMotion& motion : model_.motions) addMotion(motion);
    Json& json = document_.json();
    Json scene = Json::Object{};
    scene.set("nodes", numberList(top_));
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

void ModelConverter::addJoints() {
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
    Json node = Json::Object{};
    node.set("name", joint.name);
    node.set("translation", numberList(local.translation_m));
    node.set("rotation", numberList(Quat(local.rotation).normalized().coeffs()));
    if (!children[j].empty()) node.set("children", numberList(children[j]));
    nodes_.push_back(std::move(node));
  }
  Json skin = Json::Object{};
  skin.set("joints", numberList(all));
  skin.set("inverseBindMatrices", document_.addFloats(floatsOf(inverseBind), "MAT4"));
  skins_.push_back(std::move(skin));
}

int ModelConverter::textureOf(const std::vector<std::uint8_t>& picture) {
  const std::string_view bytes(reinterpret_cast<const char*>(picture.data()), picture.size());
  const auto [found, isNew] = textureOf_.try_emplace(bytes, static_cast<int>(textures_.size()));
  if (isNew) {
    Json texture = Json::Object{};
    texture.set("source", document_.addImage(picture));
    textures_.push_back(std::move(texture));
  }
  return found->second;
}

void ModelConverter::addMaterial(const RigMaterial& material) {
  const auto within = [](float value) { return std::clamp(value, 0.0f, 1.0f); };
  std::array<float, 4> color = material.color;
  for (float& c : color) c = within(c);
  Json surface = Json::Object{};
  surface.set("baseColorFactor", numberList(color));
  surface.set("metallicFactor", static_cast<double>(within(material.metallic)));
  surface.set("roughnessFactor", static_cast<double>(within(material.roughness)));
  if (!material.texture.empty()) {
    Json use = Json::Object{};
    use.set("index", textureOf(material.texture));
    surface.set("baseColorTexture", std::move(use));
  }
  Json out = Json::Object{};
  out.set("name", material.name);
  out.set("pbrMetallicRoughness", std::move(surface));
  if (material.doubleSided) out.set("doubleSided", true);
  materials_.push_back(std::move(out));
}

// Four influences a set; the second only where a point has more.
void ModelConverter::addInfluences(const RigPart& part, Json& attributes) {
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
    attributes.set(std::string("JOINTS_") + number, document_.addJoints(joints[set]));
    attributes.set(std::string("WEIGHTS_") + number, document_.addFloats(weights[set], "VEC4"));
  }
}

Json ModelConverter::attributesOf(const RigPart& part) {
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
  Json attributes = Json::Object{};
  attributes.set("POSITION", document_.addFloats(floatsOf(positions), "VEC3", true));
  attributes.set("NORMAL", document_.addFloats(floatsOf(normals), "VEC3"));
  attributes.set("TEXCOORD_0", document_.addFloats(floatsOf(uvs), "VEC2"));
  addInfluences(part, attributes);
  return attributes;
}

void ModelConverter::addPart(const RigPart& part) {
  if (part.vertexCount == 0 || part.triangleCount == 0) return;
  std::vector<std::uint32_t> indices;
  for (std::uint32_t t = 0; t < part.triangleCount; ++t) {
    for (const std::uint32_t v : model_.drawnTriangles[part.firstTriangle + t]) {
      indices.push_back(v - part.firstVertex);
    }
  }
  Json primitive = Json::Object{};
  primitive.set("attributes", attributesOf(part));
  primitive.set("indices", document_.addIndices(indices));
  if (part.material >= 0) primitive.set("material", part.material);
  Json mesh = Json::Object{};
  mesh.set("name", part.name);
  mesh.set("primitives", Json::List{std::move(primitive)});
  Json node = Json::Object{};
  node.set("name", part.name);
  node.set("mesh", static_cast<int>(meshes_.size()));
  node.set("skin", 0);
  meshes_.push_back(std::move(mesh));
  top_.push_back(static_cast<int>(nodes_.size()));
  nodes_.push_back(std::move(node));
}

// A key per frame. A motion that loops ends with its first frame, as players expect.
void ModelConverter::addMotion(const SampledMotion& motion) {
  const std::size_t count = motion.joints.size(), frames = motion.frameCount();
  const std::size_t keys = frames + (motion.loop && frames > 1 ? 1 : 0);
  std::vector<float> times;
  for (std::size_t k = 0; k < keys; ++k) {
    times.push_back(static_cast<float>(static_cast<double>(k) / motion.rate_hz));
  }
  const int input = document_.addFloats(times, "SCALAR", true);
  Json animation = Json::Object{{"name", motion.name}};
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
    const int rotation = document_.addFloats(floatsOf(turns), "VEC4");
    addGltfTrack(animation, input, rotation, node->second, "rotation");
    const int translation = document_.addFloats(floatsOf(places), "VEC3");
    addGltfTrack(animation, input, translation, node->second, "translation");
  }
  if (hasGltfTracks(animation)) animations_.push_back(std::move(animation));
}

}  // namespace

GltfDocument gltfOf(const RiggedModel& model) {
  return ModelConverter(model).run();
}

SourceDocument sourceDocumentOf(const RiggedModel& model, double scale) {
  if (isGltfFile(model.sourceFile)) return {GltfDocument::read(model.sourceFile), scale};
  return {gltfOf(model), 1};
}

}  // namespace fascia
