#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include <Eigen/Core>

namespace fascia {

using GltfJson = nlohmann::ordered_json;  // keeps the order of members

// Collects a binary glTF 2.0: the JSON tree and the bytes that its accessors point into.
class GlbBuilder {
 public:
  using Json = GltfJson;
  enum class Target { none = 0, vertices = 34962, indices = 34963 };

  GlbBuilder();

  Json root;

  // Each returns the new thing's index.
  std::size_t add(const char* list, Json value);
  std::size_t addImage(const std::string& bytes, const char* mimeType);
  std::size_t addVectors(std::span<const Eigen::Vector3f> values, bool withBounds, Target target);
  std::size_t addUvs(std::span<const Eigen::Vector2f> values);
  // Triangles; those of another mesh are used again if they are the same.
  std::size_t addIndices(std::span<const std::uint32_t> indices, std::size_t vertexCount);
  std::size_t addScalars(std::span<const float> values, bool withBounds);
  std::size_t addQuaternions(std::span<const Eigen::Vector4f> values);  // x, y, z, w
  // The same in 16 bits each: off by less than 3e-5 rad.
  std::size_t addShortQuaternions(std::span<const Eigen::Vector4f> values);
  std::size_t addMatrices(std::span<const Eigen::Matrix4f> values);
  // Numbers in [0, 1], in 16 bits each: 0 and 1 are exact.
  std::size_t addShares(std::span<const float> values);
  // Joints of vertices and what they weigh in 65535ths, four of each a vertex.
  std::size_t addJoints(std::span<const std::uint16_t> values);
  std::size_t addWeights(std::span<const std::uint16_t> values);
  // Times of keys; asked for again, they are there already.
  std::size_t addTimes(std::span<const float> values);
  // Mostly zero vectors: only the others are stored, where that is smaller.
  std::size_t addSparseVectors(std::span<const Eigen::Vector3f> values, bool withBounds);

  // The whole file. Throws Error beyond 4 GiB, which the format cannot hold.
  std::string finish();

 private:
  std::size_t addView(const void* data, std::size_t bytes, Target target);
  std::size_t addAccessor(std::size_t view, int componentType, std::size_t count, const char* type);
  Json& accessor(std::size_t index) { return root["accessors"][index]; }
  std::size_t addPackedIndices(std::span<const std::uint32_t> indices, bool small, Target target);

  std::size_t addNormalized(std::size_t view, int componentType, std::size_t count,
                            const char* type);

  std::string bytes_;
  // What is there already, and the accessors.
  std::map<std::vector<float>, std::size_t> times_;
  std::map<std::pair<bool, std::vector<std::uint32_t>>, std::size_t> indices_;
};

}  // namespace fascia
