#include <fascia/io/gltf/gltf_builder.h>

#include <algorithm>
#include <cmath>

namespace fascia {
namespace {

// Eigen's small vectors lie without gaps.
template <class Vector>
std::span<const float> numbersOf(std::span<const Vector> values) {
  static_assert(sizeof(Vector) == Vector::SizeAtCompileTime * sizeof(float));
  return {reinterpret_cast<const float*>(values.data()),
          values.size() * static_cast<std::size_t>(Vector::SizeAtCompileTime)};
}

}  // namespace

int GltfBuilder::addVectors(std::span<const Eigen::Vector3f> values, bool withRange,
                            Target target) {
  return document.addFloats(numbersOf(values), "VEC3", withRange, target);
}

int GltfBuilder::addSparseVectors(std::span<const Eigen::Vector3f> values, bool withRange) {
  return document.addSparseVectors(numbersOf(values), withRange, Target::vertices);
}

int GltfBuilder::addUvs(std::span<const Eigen::Vector2f> values) {
  return document.addFloats(numbersOf(values), "VEC2", false, Target::vertices);
}

int GltfBuilder::addQuaternions(std::span<const Eigen::Vector4f> values) {
  return document.addFloats(numbersOf(values), "VEC4");
}

int GltfBuilder::addShortQuaternions(std::span<const Eigen::Vector4f> values) {
  std::vector<std::int16_t> packed;
  for (const float c : numbersOf(values))
    packed.push_back(static_cast<std::int16_t>(std::lround(32767 * std::clamp(c, -1.0f, 1.0f))));
  return document.addShortKeys(packed, "VEC4");
}

int GltfBuilder::addMatrices(std::span<const Eigen::Matrix4f> values) {
  return document.addFloats(numbersOf(values), "MAT4");
}

int GltfBuilder::addScalars(std::span<const float> values, bool withRange) {
  return document.addFloats(values, "SCALAR", withRange);
}

int GltfBuilder::addShares(std::span<const float> values) {
  std::vector<std::uint16_t> packed;
  for (const float v : values)
    packed.push_back(static_cast<std::uint16_t>(std::lround(65535 * std::clamp(v, 0.0f, 1.0f))));
  return document.addShortKeys(packed, "SCALAR");
}

int GltfBuilder::addIndices(std::span<const std::uint32_t> indices) {
  const auto [found, isNew] = indices_.try_emplace({indices.begin(), indices.end()}, 0);
  if (isNew) found->second = document.addIndices(indices);
  return found->second;
}

int GltfBuilder::addTimes(std::span<const float> values) {
  const auto [found, isNew] = times_.try_emplace({values.begin(), values.end()}, 0);
  if (isNew) found->second = addScalars(values, true);
  return found->second;
}

}  // namespace fascia
