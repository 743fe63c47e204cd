#include "rigged.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <nlohmann/json.hpp>

namespace {

using nlohmann::json;

constexpr int kColumns = 10, kRings = 11;
constexpr float kRadius = 0.1f;

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k > bytes.size() ? '=' : kDigits[group >> (18 - 6 * k) & 63];
  }
  return out;
}

// Collects accessors over one buffer.
class Gltf {
 public:
  template <class T>
  int add(const std::vector<T>& values, int componentType, int components, const char* type) {
    const std::string bytes(reinterpret_cast<const char*>(values.data()),
                            values.size() * sizeof(T));
    views_.push_back({{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", bytes.size()}});
    buffer_ += bytes;
    buffer_.resize((buffer_.size() + 3) / 4 * 4);
    accessors_.push_back({{"bufferView", views_.size() - 1},
                          {"componentType", componentType},
                          {"count", values.size() / static_cast<std::size_t>(components)},
                          {"type", type}});
    return static_cast<int>(accessors_.size()) - 1;
  }
  json& last() { return accessors_.back(); }

  json document() const {
    return {{"asset", {{"version", "2.0"}}},
            {"buffers",
             {{{"byteLength", buffer_.size()},
               {"uri", "data:application/octet-stream;base64," + base64(buffer_)}}}},
            {"bufferViews", views_},
            {"accessors", accessors_}};
  }

 private:
  std::string buffer_;
  json views_ = json::array(), accessors_ = json::array();
};

constexpr int kFloat = 5126, kShort = 5123, kByte = 5121;

json tubeMesh(Gltf& gltf) {
  std::vector<float> places, weights;
  std::vector<std::uint8_t> joints;
  const auto add = [&](float x, float y, float z) {
    places.insert(places.end(), {x, y, z});
    const float upper = std::min(std::max(2.5f * (y - 0.5f) + 0.5f, 0.f), 1.f);
    weights.insert(weights.end(), {1 - upper, upper, 0, 0});
    joints.insert(joints.end(), {0, 1, 0, 0});
  };
  for (int r = 0; r < kRings; ++r)
    for (int c = 0; c < kColumns; ++c) {
      const float angle = static_cast<float>(2 * std::numbers::pi * c / kColumns);
      add(kRadius * std::sin(angle), static_cast<float>(r) / (kRings - 1),
          kRadius * std::cos(angle));
    }
  add(0, 0, 0);
  add(0, 1, 0);
  std::vector<std::uint16_t> corners;
  const auto at = [](int r, int c) {
    return static_cast<std::uint16_t>(r * kColumns + c % kColumns);
  };
  const std::uint16_t bottom = kRings * kColumns, top = bottom + 1;
  for (int c = 0; c < kColumns; ++c) {
    for (int r = 0; r + 1 < kRings; ++r)
      for (const std::uint16_t v :
           {at(r, c), at(r, c + 1), at(r + 1, c + 1), at(r, c), at(r + 1, c + 1), at(r + 1, c)})
        corners.push_back(v);
    for (const std::uint16_t v : {bottom, at(0, c + 1), at(0, c)}) corners.push_back(v);
    for (const std::uint16_t v : {top, at(kRings - 1, c), at(kRings - 1, c + 1)})
      corners.push_back(v);
  }
  json attributes;
  attributes["POSITION"] = gltf.add(places, kFloat, 3, "VEC3");
  gltf.last()["min"] = {-kRadius, 0, -kRadius};
  gltf.last()["max"] = {kRadius, 1, kRadius};
  attributes["JOINTS_0"] = gltf.add(joints, kByte, 4, "VEC4");
  attributes["WEIGHTS_0"] = gltf.add(weights, kFloat, 4, "VEC4");
  return {{"name", "tube"},
          {"primitives",
           {{{"attributes", attributes},
             {"material", 0},
             {"indices", gltf.add(corners, kShort, 1, "SCALAR")}}}}};
}

// The upper joint turns about z, up to an angle and back.
json motion(Gltf& gltf, const char* name, float duration_s, double angle_rad) {
  const auto z = static_cast<float>(std::sin(0.5 * angle_rad));
  const auto w = static_cast<float>(std::cos(0.5 * angle_rad));
  const int times =
      gltf.add(std::vector<float>{0, duration_s / 2, duration_s}, kFloat, 1, "SCALAR");
  gltf.last()["min"] = {0};
  gltf.last()["max"] = {duration_s};
  const int turns =
      gltf.add(std::vector<float>{0, 0, 0, 1, 0, 0, z, w, 0, 0, 0, 1}, kFloat, 4, "VEC4");
  return {{"name", name},
          {"samplers", {{{"input", times}, {"output", turns}}}},
          {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "rotation"}}}}}}};
}

}  // namespace

std::string riggedGltf() {
  Gltf gltf;
  const json mesh = tubeMesh(gltf);
  const json bend = motion(gltf, "bend", 0.5f, std::numbers::pi / 2);
  const json sway = motion(gltf, "sway", 1.0f, 0.3);
  const std::vector<float> inverseBinds = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,     0, 1,
                                           1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -0.5f, 0, 1};
  const int binds = gltf.add(inverseBinds, kFloat, 16, "MAT4");
  json document = gltf.document();
  document["meshes"] = {mesh};
  document["animations"] = {bend, sway};
  document["materials"] = {{{"name", "rubber"}}};
  document["nodes"] = {{{"name", "lower"}, {"children", {1}}},
                       {{"name", "upper"}, {"translation", {0, 0.5, 0}}},
                       {{"name", "tube"}, {"mesh", 0}, {"skin", 0}}};
  document["skins"] = {{{"joints", {0, 1}}, {"inverseBindMatrices", binds}}};
  document["scenes"] = {{{"nodes", {0, 2}}}};
  document["scene"] = 0;
  return document.dump();
}

std::string riggedCharacter() {
  return R"({
  "fascia": 1,
  "name": "tube",
  "rig": {"file": "tube.gltf"},
  "skeleton": [
    {"name": "lower", "dofs": {"tx": {}, "ty": {}, "tz": {}, "rx": {}, "ry": {}, "rz": {}}},
    {
      "name": "upper",
      "parent": "lower",
      "offset_m": [0, 0.5, 0],
      "dofs": {"tx": {}, "ty": {}, "tz": {}, "rx": {}, "ry": {}, "rz": {}}
    }
  ],
  "solids": [
    {"name": "low", "joint": "lower", "shape": "sphere", "radius_m": 0.09, "position_m": [0, 0.25, 0]},
    {"name": "high", "joint": "upper", "shape": "sphere", "radius_m": 0.09, "position_m": [0, 0.25, 0]}
  ],
  "skin": {},
  "simulation": {"settle_s": 0.05}
}
)";
}

std::string smallBvh() {
  return R"(HIERARCHY
ROOT Root
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Tip
  {
    OFFSET 0 0.5 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 0.5 0
    }
  }
}
MOTION
Frames: 3
Frame Time: 0.1
0 0 0 0 0 0 0 0 0
0 0 0 0 0 0 20 0 0
0 0 0 0 0 0 40 0 0
)";
}
