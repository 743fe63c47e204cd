// KHR_draco_mesh_compression: primitives whose attributes and indices are packed together.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <numeric>

#include <draco/compression/decode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>

#include <fascia/io/gltf/gltf_accessor.h>
#include <fascia/io/gltf/gltf_document.h>

namespace fascia {
namespace {

constexpr const char* kDracoExtension = "KHR_draco_mesh_compression";

// Reads how many faces the data promise, before the decoder makes room for them. Only the version
// of the format that glTF allows (2.2). False: no such data.
bool promisedFaces(std::span<const std::uint8_t> data, std::uint32_t& faces) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(data.data()), data.size());
  draco::DracoHeader header;
  if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) return false;
  if (header.version_major != 2 || header.version_minor != 2) return false;
  buffer.set_bitstream_version(DRACO_BITSTREAM_VERSION(2, 2));
  if (header.encoder_type != draco::TRIANGULAR_MESH) return false;
  if (header.flags & METADATA_FLAG_MASK) {
    draco::GeometryMetadata metadata;
    if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata)) return false;
  }
  if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING) {
    std::uint8_t traversal = 0;
    std::uint32_t vertices = 0;
    if (!buffer.Decode(&traversal) || !draco::DecodeVarint(&vertices, &buffer)) return false;
  }
  return draco::DecodeVarint(&faces, &buffer);
}

std::unique_ptr<draco::Mesh> decodeMesh(std::span<const std::uint8_t> data,
                                        const GltfPlace& place) {
  constexpr std::size_t kMostFacesPerByte = 64;  // even flat regular grids take more than that
  std::uint32_t faces = 0;
  const bool promising = promisedFaces(data, faces);
  if (!promising || faces / kMostFacesPerByte > data.size()) {
    place.fail("its Draco data can't be unpacked", "is the file damaged?");
  }
  try {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(data.data()), data.size());
    auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok())
      place.fail("its Draco data can't be unpacked: " + decoded.status().error_msg_string());
    return std::move(decoded).value();
  } catch (const std::bad_alloc&) {
    place.fail("its Draco data need more memory than there is");
  }
}

template <class T>
void appendAttribute(const draco::Mesh& mesh, const draco::PointAttribute& attribute,
                     std::size_t padded, std::vector<std::uint8_t>& out) {
  const auto components = static_cast<std::size_t>(attribute.num_components());
  std::vector<T> element(components);
  out.reserve(mesh.num_points() * padded);
  for (draco::PointIndex p(0); p < mesh.num_points(); ++p) {
    std::fill(element.begin(), element.end(), T{0});
    attribute.ConvertValue<T>(attribute.mapped_index(p), attribute.num_components(),
                              element.data());
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(element.data());
    out.insert(out.end(), bytes, bytes + components * sizeof(T));
    out.resize(out.size() + padded - components * sizeof(T));
  }
}

// Elements begin at multiples of four bytes, as vertex attributes must.
std::vector<std::uint8_t> attributeBytes(const draco::Mesh& mesh,
                                         const draco::PointAttribute& attribute, int componentType,
                                         std::size_t padded) {
  std::vector<std::uint8_t> out;
  switch (componentType) {
    case kGltfByte:
      appendAttribute<std::int8_t>(mesh, attribute, padded, out);
      break;
    case kGltfUnsignedByte:
      appendAttribute<std::uint8_t>(mesh, attribute, padded, out);
      break;
    case kGltfShort:
      appendAttribute<std::int16_t>(mesh, attribute, padded, out);
      break;
    case kGltfUnsignedShort:
      appendAttribute<std::uint16_t>(mesh, attribute, padded, out);
      break;
    case kGltfUnsignedInt:
      appendAttribute<std::uint32_t>(mesh, attribute, padded, out);
      break;
    default:
      appendAttribute<float>(mesh, attribute, padded, out);
  }
  return out;
}

std::vector<std::uint32_t> faceIndices(const draco::Mesh& mesh) {
  std::vector<std::uint32_t> out;
  out.reserve(3 * std::size_t{mesh.num_faces()});
  for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f) {
    for (const draco::PointIndex& corner : mesh.face(f)) out.push_back(corner.value());
  }
  return out;
}

struct Attribute {
  int accessor = -1;
  std::vector<std::uint8_t> data;
  std::size_t stride = 0, count = 0;
};

// Weights that were rounded when they were packed do not sum to one any more, which players and
// validators mind. `sets`: of four floats a vertex, all of one primitive.
void evenWeights(std::span<Attribute* const> sets, std::size_t vertices) {
  constexpr float kMostRounding = 0.05f;
  std::vector<float> w(4 * sets.size());
  for (std::size_t v = 0; v < vertices; ++v) {
    for (std::size_t s = 0; s < sets.size(); ++s)
      std::memcpy(&w[4 * s], &sets[s]->data[16 * v], 16);
    const float sum = std::accumulate(w.begin(), w.end(), 0.0f);
    if (!(std::abs(sum - 1) <= kMostRounding)) continue;
    for (float& weight : w) weight /= sum;
    *std::max_element(w.begin(), w.end()) += 1 - std::accumulate(w.begin(), w.end(), 0.0f);
    for (std::size_t s = 0; s < sets.size(); ++s)
      std::memcpy(&sets[s]->data[16 * v], &w[4 * s], 16);
  }
}

struct UnpackedPrimitive {
  std::vector<Attribute> attributes;
  std::vector<std::uint32_t> indices;
  int indexAccessor = -1;  // -1: the file has none
};

Attribute unpackAttribute(const GltfPlace& root, const GltfPlace& id, const GltfPlace& target,
                          const draco::Mesh& mesh) {
  const auto* source = mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(id.count()));
  if (!source) id.fail("there is no such attribute in the Draco data");
  Attribute out;
  out.accessor = target.index(static_cast<int>(root["accessors"].size()));
  const GltfPlace accessor = root["accessors"].at(static_cast<std::size_t>(out.accessor));
  const std::size_t type = accessor["componentType"].count();
  const std::size_t bytes = type <= kGltfFloat ? componentBytes(static_cast<int>(type)) : 0;
  if (bytes == 0 || componentCount(accessor["type"].text()) != source->num_components()) {
    accessor.fail("does not fit its Draco data");
  }
  const std::size_t element = static_cast<std::size_t>(source->num_components()) * bytes;
  const std::size_t padded = (element + 3) / 4 * 4;  // vertex attributes begin at multiples of 4
  out.data = attributeBytes(mesh, *source, static_cast<int>(type), padded);
  out.stride = padded == element ? 0 : padded;
  out.count = mesh.num_points();
  return out;
}

UnpackedPrimitive unpackPrimitive(const GltfDocument& document, const GltfPlace& primitive) {
  const GltfPlace root = document.root(), packed = primitive["extensions"][kDracoExtension];
  const int view = packed["bufferView"].index(static_cast<int>(root["bufferViews"].size()));
  const std::unique_ptr<draco::Mesh> mesh = decodeMesh(document.viewBytes(view), packed);
  const GltfPlace ids = packed["attributes"];
  if (!ids || !ids.json()->is(Json::Kind::object)) packed.fail("has no attributes");
  UnpackedPrimitive out;
  std::vector<std::size_t> weights;
  for (const Json::Member& id : ids.json()->object()) {
    out.attributes.push_back(
        unpackAttribute(root, ids[id.key], primitive["attributes"][id.key], *mesh));
    const bool fourFloats = out.attributes.back().data.size() == 16 * out.attributes.back().count;
    if (id.key.starts_with("WEIGHTS_") && fourFloats) weights.push_back(out.attributes.size() - 1);
  }
  std::vector<Attribute*> sets;
  sets.reserve(weights.size());
  for (const std::size_t i : weights) sets.push_back(&out.attributes[i]);
  if (!sets.empty()) evenWeights(sets, mesh->num_points());
  out.indices = faceIndices(*mesh);
  out.indexAccessor = primitive["indices"].indexOr(-1, static_cast<int>(root["accessors"].size()));
  return out;
}

// Gives an accessor unpacked data in place of what it had.
void fillAccessor(Json& root, int accessor, std::size_t count, int view) {
  Json& entry = findMember(root, "accessors")->list()[static_cast<std::size_t>(accessor)];
  putMember(entry, "bufferView", view);
  eraseMember(entry, "byteOffset");
  eraseMember(entry, "sparse");
  putMember(entry, "count", Json::Number{std::to_string(count)});
}

}  // namespace

// "min" and "max" were those of the data before they were packed, which may have rounded them.
void GltfDocument::renewBounds(int accessor) {
  Json& entry = item("accessors", accessor);
  if (!entry.find("min") && !entry.find("max")) return;
  GltfAccessor source = GltfAccessor::of(*this, accessor);
  source.normalized = false;
  const auto components = static_cast<std::size_t>(source.components);
  std::vector<double> low(components, std::numeric_limits<double>::infinity());
  std::vector<double> high(components, -std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < source.count && source.data; ++i) {
    for (std::size_t c = 0; c < components; ++c) {
      const double value = source.number(source.data + i * source.stride, c);
      low[c] = std::min(low[c], value);
      high[c] = std::max(high[c], value);
    }
  }
  for (const auto& [key, values] : {std::pair{"min", low}, {"max", high}}) {
    const bool finite =
        std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
    if (finite)
      putMember(entry, key, numberList(values));
    else
      eraseMember(entry, key);
  }
}

void GltfDocument::unpackCompressedMeshes() {
  const std::size_t meshes = root()["meshes"].size();
  for (std::size_t m = 0; m < meshes; ++m) {
    const std::size_t primitives = root()["meshes"].at(m)["primitives"].size();
    for (std::size_t p = 0; p < primitives; ++p) {
      const GltfPlace place = root()["meshes"].at(m)["primitives"].at(p);
      if (place["extensions"][kDracoExtension]) unpackMesh(m, p);
    }
  }
  forgetExtension(kDracoExtension);
}

void GltfDocument::unpackMesh(std::size_t mesh, std::size_t primitive) {
  const UnpackedPrimitive unpacked =
      unpackPrimitive(*this, root()["meshes"].at(mesh)["primitives"].at(primitive));
  for (const Attribute& a : unpacked.attributes) {
    fillAccessor(json_, a.accessor, a.count,
                 addView(a.data.data(), a.data.size(), Target::none, a.stride));
    renewBounds(a.accessor);
  }
  int indices = unpacked.indexAccessor;
  if (indices < 0) {
    indices = addIndices(unpacked.indices);
  } else {
    const int view = addView(unpacked.indices.data(), unpacked.indices.size() * 4, Target::none);
    fillAccessor(json_, indices, unpacked.indices.size(), view);
    Json& entry = findMember(json_, "accessors")->list()[static_cast<std::size_t>(indices)];
    putMember(entry, "componentType", static_cast<int>(kGltfUnsignedInt));
    renewBounds(indices);
  }
  Json& entry =
      findMember(findMember(json_, "meshes")->list()[mesh], "primitives")->list()[primitive];
  putMember(entry, "indices", indices);
  eraseMember(entry, "mode");  // strips come out as triangles
  Json* extensions = findMember(entry, "extensions");
  eraseMember(*extensions, kDracoExtension);
  if (extensions->object().empty()) eraseMember(entry, "extensions");
}

}  // namespace fascia
