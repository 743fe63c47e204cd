#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <fascia/io/file/inputs.h>
#include <fascia/io/gltf/gltf_place.h>
#include <fascia/io/json/json.h>

namespace fascia {

// A glTF 2.0 file in memory: its JSON, and its accessors as plain numbers. Reading checks
// everything that is used (indices, ranges, sizes); what is not understood is kept as it is, so
// that a file that was read, edited and written still has all its materials, extensions and extras.
class GltfDocument {
 public:
  GltfDocument() : GltfDocument(std::string()) {}
  // One of our own, with nothing in it; `path` stands in messages.
  explicit GltfDocument(std::string path);

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

  // Appends an entry to a list of the document ("nodes"), made if it is missing; its index.
  int add(const char* list, Json entry);
  Json& item(const char* list, int index);

  // What a graphics card takes data for; other data (keys, matrices) are for none of them.
  enum class Target { none = 0, vertices = 34962, indices = 34963 };

  // Appends data and returns the new accessor's index. `type`: "SCALAR", "VEC3", "MAT4" …
  // Positions need min and max: withRange.
  int addFloats(std::span<const float> values, std::string_view type, bool withRange = false,
                Target target = Target::none);
  // Attributes of vertices, each beginning at a multiple of four bytes.
  int addBytes(std::span<const std::uint8_t> values, std::string_view type,
               bool normalized = false);
  int addShorts(std::span<const std::uint16_t> values, std::string_view type,
                bool normalized = false);
  // Slots of a skin, four a vertex; in bytes where they fit.
  int addJoints(std::span<const std::uint16_t> values);
  // Values of keys in 16 bits each: 32767ths in [-1, 1], or 65535ths in [0, 1].
  int addShortKeys(std::span<const std::int16_t> values, std::string_view type);
  int addShortKeys(std::span<const std::uint16_t> values, std::string_view type);
  int addIndices(std::span<const std::uint32_t> values);
  int addImage(std::span<const std::uint8_t> encoded);  // PNG, JPEG …; returns the image's index
  // Three numbers a vertex, most of them zero: only the others are stored, where that is smaller.
  int addSparseVectors(std::span<const float> values, bool withRange = false,
                       Target target = Target::none);

  // Data that no accessor uses any more are left out. Everything, pictures too, goes into the file.
  void writeGlb(const std::string& path) const;
  std::string glb() const;  // the same in memory

 private:
  void loadBuffers(std::string_view binaryChunk);
  void unpackCompressedViews();   // EXT_meshopt_compression
  void unpackCompressedMeshes();  // KHR_draco_mesh_compression
  void unpackMesh(std::size_t mesh, std::size_t primitive);
  void renewBounds(int accessor);
  void forgetExtension(std::string_view name);
  void embedImages();
  using Bytes = std::shared_ptr<std::vector<std::uint8_t>>;
  Bytes dataOf(const std::string& uri, const GltfPlace& place) const;
  Bytes fileBeside(const std::string& name) const;
  void notePictures() const;
  void charge(std::size_t numbers, int accessor) const;
  std::span<const std::uint8_t> part(int buffer, const GltfPlace& place) const;
  int addBuffer(std::vector<std::uint8_t> bytes);
  int addView(const void* data, std::size_t bytes, Target target, std::size_t stride = 0);
  int addPackedIndices(std::span<const std::uint32_t> values, bool small, Target target);
  int addAccessor(Json view, int componentType, std::size_t count, std::string_view type,
                  bool normalized);
  int addSparse(std::span<const std::uint32_t> indices, std::span<const float> values,
                std::size_t count, bool withRange);

  std::string path_;
  Json json_;
  // Copies of a document share them until one is added to; so do buffers of one file.
  std::vector<Bytes> buffers_;
  mutable std::map<FileId, Bytes> files_;  // beside it, as far as they have been read
  mutable std::size_t file_bytes_ = 0;     // of all of them
  mutable std::size_t decoded_ = 0;        // numbers out of accessors
  int ownBuffer_ = -1;                     // where added data go
};

}  // namespace fascia
