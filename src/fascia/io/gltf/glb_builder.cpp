#include <fascia/io/gltf/glb_builder.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <fascia/base/error.h>
#include <fascia/io/file/byte_stream.h>

namespace fascia {
namespace {

constexpr int kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kUnsignedInt = 5125,
              kFloat = 5126;
constexpr std::size_t kShortLimit = 65535;  // index 65535 restarts primitives

void padTo4(std::string& bytes, char with) {
  bytes.resize((bytes.size() + 3) / 4 * 4, with);
}

GlbBuilder::Json bound(std::span<const Eigen::Vector3f> values, bool upper) {
  Eigen::Vector3f out = Eigen::Vector3f::Zero();
  if (!values.empty()) out = values[0];
  for (const Eigen::Vector3f& v : values) {
    if (upper) {
      out = out.cwiseMax(v);
    } else {
      out = out.cwiseMin(v);
    }
  }
  return {out.x(), out.y(), out.z()};
}

}  // namespace

GlbBuilder::GlbBuilder() {
  root["asset"] = {{"version", "2.0"}, {"generator", "Fascia"}};
}

std::size_t GlbBuilder::add(const char* list, Json value) {
  Json& entries = root[list];
  entries.push_back(std::move(value));
  return entries.size() - 1;
}

std::size_t GlbBuilder::addView(const void* data, std::size_t bytes, Target target) {
  padTo4(bytes_, '\0');
  Json view = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes}};
  if (target != Target::none) view["target"] = static_cast<int>(target);
  bytes_.append(static_cast<const char*>(data), bytes);
  return add("bufferViews", std::move(view));
}

std::size_t GlbBuilder::addAccessor(std::size_t view, int componentType, std::size_t count,
                                    const char* type) {
  return add(
      "accessors",
      {{"bufferView", view}, {"componentType", componentType}, {"count", count}, {"type", type}});
}

std::size_t GlbBuilder::addImage(const std::string& bytes, const char* mimeType) {
  const std::size_t view = addView(bytes.data(), bytes.size(), Target::none);
  return add("images", {{"bufferView", view}, {"mimeType", mimeType}});
}

std::size_t GlbBuilder::addVectors(std::span<const Eigen::Vector3f> values, bool withBounds,
                                   Target target) {
  const std::size_t index = addAccessor(addView(values.data(), values.size_bytes(), target), kFloat,
                                        values.size(), "VEC3");
  if (withBounds) {
    accessor(index)["min"] = bound(values, false);
    accessor(index)["max"] = bound(values, true);
  }
  return index;
}

std::size_t GlbBuilder::addUvs(std::span<const Eigen::Vector2f> values) {
  return addAccessor(addView(values.data(), values.size_bytes(), Target::vertices), kFloat,
                     values.size(), "VEC2");
}

std::size_t GlbBuilder::addPackedIndices(std::span<const std::uint32_t> indices, bool small,
                                         Target target) {
  if (!small) return addView(indices.data(), indices.size_bytes(), target);
  std::vector<std::uint16_t> packed;
  packed.reserve(indices.size());
  for (const std::uint32_t i : indices) packed.push_back(static_cast<std::uint16_t>(i));
  return addView(packed.data(), packed.size() * sizeof packed[0], target);
}

std::size_t GlbBuilder::addIndices(std::span<const std::uint32_t> indices,
                                   std::size_t vertexCount) {
  const bool small = vertexCount <= kShortLimit;
  const auto [found, isNew] =
      indices_.try_emplace({small, std::vector<std::uint32_t>(indices.begin(), indices.end())}, 0);
  if (isNew)
    found->second = addAccessor(addPackedIndices(indices, small, Target::indices),
                                small ? kUnsignedShort : kUnsignedInt, indices.size(), "SCALAR");
  return found->second;
}

std::size_t GlbBuilder::addScalars(std::span<const float> values, bool withBounds) {
  const std::size_t index = addAccessor(addView(values.data(), values.size_bytes(), Target::none),
                                        kFloat, values.size(), "SCALAR");
  if (withBounds) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    accessor(index)["min"] = {*low};
    accessor(index)["max"] = {*high};
  }
  return index;
}

std::size_t GlbBuilder::addQuaternions(std::span<const Eigen::Vector4f> values) {
  return addAccessor(addView(values.data(), values.size_bytes(), Target::none), kFloat,
                     values.size(), "VEC4");
}

std::size_t GlbBuilder::addNormalized(std::size_t view, int componentType, std::size_t count,
                                      const char* type) {
  const std::size_t index = addAccessor(view, componentType, count, type);
  accessor(index)["normalized"] = true;
  return index;
}

std::size_t GlbBuilder::addShortQuaternions(std::span<const Eigen::Vector4f> values) {
  std::vector<std::int16_t> packed;
  for (const Eigen::Vector4f& q : values) {
    for (const float c : q)
      packed.push_back(static_cast<std::int16_t>(std::lround(32767 * std::clamp(c, -1.0f, 1.0f))));
  }
  return addNormalized(addView(packed.data(), packed.size() * sizeof packed[0], Target::none),
                       kShort, values.size(), "VEC4");
}

std::size_t GlbBuilder::addMatrices(std::span<const Eigen::Matrix4f> values) {
  return addAccessor(addView(values.data(), values.size_bytes(), Target::none), kFloat,
                     values.size(), "MAT4");
}

std::size_t GlbBuilder::addShares(std::span<const float> values) {
  std::vector<std::uint16_t> packed;
  for (const float v : values)
    packed.push_back(static_cast<std::uint16_t>(std::lround(65535 * std::clamp(v, 0.0f, 1.0f))));
  return addNormalized(addView(packed.data(), packed.size() * sizeof packed[0], Target::none),
                       kUnsignedShort, values.size(), "SCALAR");
}

std::size_t GlbBuilder::addJoints(std::span<const std::uint16_t> values) {
  const std::size_t count = values.size() / 4;
  if (std::all_of(values.begin(), values.end(), [](std::uint16_t v) { return v < 256; })) {
    const std::vector<std::uint8_t> small(values.begin(), values.end());
    return addAccessor(addView(small.data(), small.size(), Target::vertices), kUnsignedByte, count,
                       "VEC4");
  }
  return addAccessor(addView(values.data(), values.size_bytes(), Target::vertices), kUnsignedShort,
                     count, "VEC4");
}

std::size_t GlbBuilder::addWeights(std::span<const std::uint16_t> values) {
  return addNormalized(addView(values.data(), values.size_bytes(), Target::vertices),
                       kUnsignedShort, values.size() / 4, "VEC4");
}

std::size_t GlbBuilder::addTimes(std::span<const float> values) {
  const auto [found, isNew] = times_.try_emplace({values.begin(), values.end()}, 0);
  if (isNew) found->second = addScalars(values, true);
  return found->second;
}

std::size_t GlbBuilder::addSparseVectors(std::span<const Eigen::Vector3f> values, bool withBounds) {
  std::vector<std::uint32_t> where;
  std::vector<Eigen::Vector3f> what;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i].isZero(0)) continue;
    where.push_back(static_cast<std::uint32_t>(i));
    what.push_back(values[i]);
  }
  const bool small = values.size() <= kShortLimit;
  const std::size_t sparseBytes = where.size() * (12 + (small ? 2 : 4));
  if (sparseBytes >= values.size_bytes()) return addVectors(values, withBounds, Target::vertices);

  // An accessor without a buffer view is all zeros.
  Json entry = {{"componentType", kFloat}, {"count", values.size()}, {"type", "VEC3"}};
  if (!where.empty()) {
    entry["sparse"] = {
        {"count", where.size()},
        {"indices",
         {{"bufferView", addPackedIndices(where, small, Target::none)},
          {"componentType", small ? kUnsignedShort : kUnsignedInt}}},
        {"values", {{"bufferView", addView(what.data(), what.size() * 12, Target::none)}}}};
  }
  if (withBounds) {
    entry["min"] = bound(values, false);
    entry["max"] = bound(values, true);
  }
  return add("accessors", std::move(entry));
}

std::string GlbBuilder::finish() {
  constexpr std::uint32_t kMagic = 0x46546C67, kJson = 0x4E4F534A, kBinary = 0x004E4942;
  padTo4(bytes_, '\0');
  if (!bytes_.empty()) root["buffers"] = Json::array({{{"byteLength", bytes_.size()}}});
  std::string json = root.dump(-1, ' ', false, Json::error_handler_t::replace);
  padTo4(json, ' ');
  const std::size_t total = 12 + 8 + json.size() + (bytes_.empty() ? 0 : 8 + bytes_.size());
  if (total > std::numeric_limits<std::uint32_t>::max()) {
    throw Error("the animation is too large for glTF (4 GiB): allow a larger tolerance");
  }
  ByteWriter out;
  out.bytes.reserve(total);
  out.value(kMagic);
  out.value(std::uint32_t{2});
  out.value(static_cast<std::uint32_t>(total));
  out.value(static_cast<std::uint32_t>(json.size()));
  out.value(kJson);
  out.bytes += json;
  if (!bytes_.empty()) {
    out.value(static_cast<std::uint32_t>(bytes_.size()));
    out.value(kBinary);
    out.bytes += bytes_;
  }
  return std::move(out.bytes);
}

}  // namespace fascia
