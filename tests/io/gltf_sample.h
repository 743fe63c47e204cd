#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace fascia::sample {

// A binary glTF of one JSON and one binary chunk.
inline std::string glbOf(std::string json, std::string binary) {
  const auto word = [](std::size_t value) {
    const auto v = static_cast<std::uint32_t>(value);
    char bytes[4];
    std::memcpy(bytes, &v, 4);
    return std::string(bytes, 4);
  };
  json.resize((json.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4);
  std::string out = "glTF" + word(2) + word(28 + json.size() + binary.size());
  out += word(json.size()) + "JSON" + json;
  return out + word(binary.size()) + std::string("BIN\0", 4) + binary;
}

// Writes small glTF files by hand, right and wrong ones. Every list is JSON text that a test may
// change; accessors and views are added with their data.
class TinyGltf {
 public:
  std::string asset = R"({"version":"2.0"})";
  std::string scenes = R"([{"nodes":[0]}])";
  std::string nodes, meshes, skins, animations, materials, textures, images, more;
  std::string binary;
  std::vector<std::string> views, accessors;

  int addView(const void* data, std::size_t bytes, const std::string& extra = {}) {
    binary.resize((binary.size() + 3) / 4 * 4);
    views.push_back(R"({"buffer":0,"byteOffset":)" + std::to_string(binary.size()) +
                    R"(,"byteLength":)" + std::to_string(bytes) + extra + "}");
    binary.append(static_cast<const char*>(data), bytes);
    return static_cast<int>(views.size()) - 1;
  }

  // `perElement`: how many numbers of `values` are one element.
  template <class T>
  int add(const std::vector<T>& values, std::size_t perElement, const char* type,
          const std::string& extra = {}, const std::string& viewExtra = {}) {
    const int view = addView(values.data(), values.size() * sizeof(T), viewExtra);
    return addAccessor(R"("bufferView":)" + std::to_string(view) + R"(,"componentType":)" +
                       std::to_string(componentType<T>()) + R"(,"count":)" +
                       std::to_string(values.size() / perElement) + R"(,"type":")" + type + "\"" +
                       extra);
  }
  int addAccessor(const std::string& members) {
    accessors.push_back("{" + members + "}");
    return static_cast<int>(accessors.size()) - 1;
  }

  // `buffer`: what stands in the buffer beside its length, e.g. a URI.
  std::string json(const std::string& buffer = {}) const {
    std::string out = R"({"asset":)" + asset;
    const auto list = [&](const char* name, const std::string& text) {
      if (!text.empty()) out += std::string(",\"") + name + "\":" + text;
    };
    list("scenes", scenes), list("nodes", nodes), list("meshes", meshes), list("skins", skins);
    list("animations", animations), list("materials", materials), list("textures", textures);
    list("images", images), list("accessors", joined(accessors)),
        list("bufferViews", joined(views));
    if (!binary.empty()) {
      const std::string length = std::to_string(binary.size());
      list("buffers", R"([{"byteLength":)" + length + buffer + "}]");
    }
    return out + more + "}";
  }

  std::string glb() const { return glbOf(json(), binary); }

 private:
  template <class T>
  static int componentType() {
    if (std::is_same_v<T, float>) return 5126;
    if (std::is_same_v<T, std::int8_t>) return 5120;
    if (std::is_same_v<T, std::uint8_t>) return 5121;
    if (std::is_same_v<T, std::int16_t>) return 5122;
    return std::is_same_v<T, std::uint16_t> ? 5123 : 5125;
  }
  static std::string joined(const std::vector<std::string>& items) {
    std::string out;
    for (const std::string& item : items) out += (out.empty() ? "[" : ",") + item;
    return out.empty() ? out : out + "]";
  }
};

// A square tube along y, two metres tall: rings of four points at y = 0, 1, 2; two joints, "lower"
// at the origin and "upper" at y = 1; the points between belong to both.
struct TubeRig {
  TinyGltf file;
  int positions, joints, weights, indices, inverseBinds;

  static std::vector<float> ringPositions() {
    std::vector<float> out;
    for (const float y : {0.f, 1.f, 2.f}) {
      for (const auto& [x, z] : {std::pair{1.f, 1.f}, {1.f, -1.f}, {-1.f, -1.f}, {-1.f, 1.f}}) {
        out.insert(out.end(), {0.25f * x, y, 0.25f * z});
      }
    }
    return out;
  }
  static std::vector<std::uint16_t> ringIndices() {
    std::vector<std::uint16_t> out;
    for (std::uint16_t r = 0; r < 8; r = static_cast<std::uint16_t>(r + 4)) {
      for (std::uint16_t k = 0; k < 4; ++k) {
        const auto a = static_cast<std::uint16_t>(r + k);
        const auto b = static_cast<std::uint16_t>(r + (k + 1) % 4);
        const auto c = static_cast<std::uint16_t>(b + 4), d = static_cast<std::uint16_t>(a + 4);
        out.insert(out.end(), {a, b, c, a, c, d});
      }
    }
    return out;
  }
  static std::vector<float> ringWeights() {
    std::vector<float> out;
    for (const float upper : {0.f, 0.5f, 1.f}) {
      for (int k = 0; k < 4; ++k) out.insert(out.end(), {1 - upper, upper, 0.f, 0.f});
    }
    return out;
  }
  static std::vector<std::uint8_t> ringJoints() {
    std::vector<std::uint8_t> out;
    for (int v = 0; v < 12; ++v) out.insert(out.end(), {0, 1, 0, 0});
    return out;
  }
  // Column by column: the identity, and a shift by -1 along y.
  static std::vector<float> binds() {
    return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,
            1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1};
  }

  TubeRig() {
    positions = file.add(ringPositions(), 3, "VEC3");
    joints = file.add(ringJoints(), 4, "VEC4");
    weights = file.add(ringWeights(), 4, "VEC4");
    indices = file.add(ringIndices(), 1, "SCALAR");
    inverseBinds = file.add(binds(), 16, "MAT4");
    file.nodes = R"([{"name":"Armature","children":[1,3]},{"name":"lower","children":[2]},)"
                 R"({"name":"upper","translation":[0,1,0]},{"name":"body","mesh":0,"skin":0}])";
    file.skins = skinOf("[1,2]");
    file.meshes = "[" + meshOf(primitive()) + "]";
  }
  std::string skinOf(const std::string& nodes) const {
    return R"([{"joints":)" + nodes + R"(,"inverseBindMatrices":)" + std::to_string(inverseBinds) +
           "}]";
  }
  static std::string meshOf(const std::string& primitive) {
    return R"({"primitives":[)" + primitive + "]}";
  }
  std::string attributes() const {
    return R"("POSITION":)" + std::to_string(positions) + R"(,"JOINTS_0":)" +
           std::to_string(joints) + R"(,"WEIGHTS_0":)" + std::to_string(weights);
  }
  std::string primitive(const std::string& extra = {}) const {
    return R"({"attributes":{)" + attributes() + R"(},"indices":)" + std::to_string(indices) +
           extra + "}";
  }
  // An animation of one node; returns its JSON.
  std::string animation(const std::string& name, int node, const std::string& path,
                        const std::vector<float>& times, const std::vector<float>& values,
                        const std::string& mode = "LINEAR") {
    const int input = file.add(times, 1, "SCALAR");
    const std::size_t n = path == "rotation" ? 4 : 3;
    const int output = file.add(values, n, n == 4 ? "VEC4" : "VEC3");
    return R"({"name":")" + name + R"(","channels":[{"sampler":0,"target":{"node":)" +
           std::to_string(node) + R"(,"path":")" + path + R"("}}],"samplers":[{"input":)" +
           std::to_string(input) + R"(,"output":)" + std::to_string(output) +
           R"(,"interpolation":")" + mode + R"("}]})";
  }
};

}  // namespace fascia::sample
