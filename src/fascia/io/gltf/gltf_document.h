#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <fascia/io/gltf/gltf_document_place.h>
#include <fascia/io/json/json.h>

namespace fascia {

// A glTF 2.0 file in memory: its JSON, and its accessors as plain numbers. Reading checks
// everything that is used (indices, ranges, sizes); what is not understood is kept as it is, so
// that a file that was read, edited and written still has all its materials, extensions and extras.
class GltfDocument {
 public:
  // .glb, or .gltf with data URIs or files beside it (never outside of its folder). Compressed
  // meshes (KHR_draco_mesh_compression, EXT_meshopt_compression) are unpacked and the extension
  // taken out. Throws Error (file, JSON pointer, found, expected).
  static GltfDocument read(const std::string& path);
  // The same from memory; `path` tells where files beside it are, and stands in messages.
  static GltfDocument parse(std::string_view bytes, const std::string& path);

  const std::string& path() const { return path_; }
  const Json& json() const { return json_; }
  Json& json() { return json_; }
  GltfPlace root() const { return {&json_, "", path_}; }  // for checked reading

  // Decoded values of an accessor, element after element: sparse and normalised integers resolved.
  // Throws Error if it has another number of components than `components`.
  std::vector<float> floats(int accessor, int components) const;
  std::vector<std::uint32_t> integers(int accessor, int components) const;
  std::vector<std::uint8_t> image(int image) const;  // encoded bytes; empty if it can't be found
  std::size_t elementCount(int accessor) const;      // of an accessor, before decoding it
  std::span<const std::uint8_t> viewBytes(int bufferView) const;

  // Appends data and returns the new accessor's index. `type`: "SCALAR", "VEC3", "MAT4" …
  // Positions need min and max: withRange.
  int addFloats(std::span<const float> values, std::string_view type, bool withRange = false);
  int addBytes(std::span<const std::uint8_t> values, std::string_view type,
               bool normalized = false);
  int addShorts(std::span<const std::uint16_t> values, std::string_view type,
                bool normalized = false);
  int addIndices(std::span<const std::uint32_t> values);
  int addImage(std::span<const std::uint8_t> encoded);  // PNG, JPEG …; returns the image's index
  // A sparse accessor over zeros: values only at `indices` (increasing).
  int addSparseFloats(std::span<const std::uint32_t> indices, std::span<const float> values,
                      std::size_t count, std::string_view type, bool withRange = false);

  // Data that no accessor uses any more are left out. Everything, pictures too, goes into the file.
  void writeGlb(const std::string& path) const;
  std::string glb() const;  // the same in memory

 private:
  void loadBuffers(std::string_view binaryChunk);
  void unpackCompressedViews();   // EXT_meshopt_compression
  void unpackCompressedMeshes();  // KHR_draco_mesh_compression
  void unpackMesh(std::size_t mesh, std::size_t primitive);
  void forgetExtension(std::string_view name);
  void embedImages();
  std::vector<std::uint8_t> dataOf(const std::string& uri, const GltfPlace& place) const;
  std::span<const std::uint8_t> part(int buffer, const GltfPlace& place) const;
  int addBuffer(std::vector<std::uint8_t> bytes);
  int addView(const void* data, std::size_t bytes, int target, std::size_t stride = 0);
  int addAccessor(Json view, int componentType, std::size_t count, std::string_view type,
                  bool normalized);

  std::string path_;
  Json json_;
  std::vector<std::vector<std::uint8_t>> buffers_;
  int ownBuffer_ = -1;  // where added data go
};

}  // namespace fascia
