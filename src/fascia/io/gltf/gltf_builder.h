#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <fascia/io/gltf/gltf_document.h>

namespace fascia {

// Makes a document out of vectors, and uses what is there already again. All return the accessor.
class GltfBuilder {
 public:
  using Target = GltfDocument::Target;

  explicit GltfBuilder(const std::string& path) : document(path) {}  // which stands in messages

  GltfDocument document;

  int add(const char* list, Json entry) { return document.add(list, std::move(entry)); }

  int addVectors(std::span<const Eigen::Vector3f> values, bool withRange, Target target);
  int addSparseVectors(std::span<const Eigen::Vector3f> values, bool withRange);
  int addUvs(std::span<const Eigen::Vector2f> values);
  int addQuaternions(std::span<const Eigen::Vector4f> values);  // x, y, z, w
  // The same in 16 bits each: off by less than 3e-5 rad.
  int addShortQuaternions(std::span<const Eigen::Vector4f> values);
  int addMatrices(std::span<const Eigen::Matrix4f> values);
  int addScalars(std::span<const float> values, bool withRange);
  // Numbers in [0, 1], in 16 bits each: 0 and 1 are exact.
  int addShares(std::span<const float> values);
  // Triangles; those of another mesh are used again if they are the same.
  int addIndices(std::span<const std::uint32_t> indices);
  // Times of keys; asked for again, they are there already.
  int addTimes(std::span<const float> values);

 private:
  // What is there already, and the accessors.
  std::map<std::vector<float>, int> times_;
  std::map<std::vector<std::uint32_t>, int> indices_;
};

}  // namespace fascia
