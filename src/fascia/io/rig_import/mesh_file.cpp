#include <fascia/io/rig_import/mesh_file.h>

#include <algorithm>

#include <fascia/base/index.h>
#include <fascia/geometry/weld.h>
#include <fascia/io/gltf/gltf_triangles.h>
#include <fascia/io/rig_import/gltf/gltf_scene.h>
#include <fascia/io/rig_import/gltf/rig_from_gltf.h>
#include <fascia/io/rig_import/rig_import.h>
#include <fascia/io/rig_model/rig_limits.h>

namespace fascia {
namespace {

// The meshes of a scene that no skin moves, where its nodes put them.
class SurfaceReader {
 public:
  explicit SurfaceReader(const GltfDocument& document)
      : document_(document),
        accessors_(static_cast<int>(document.root()["accessors"].size())),
        scene_(GltfScene::of(document, 1, notes_)) {}

  TriangleMesh read() {
    for (const int n : scene_.order) {
      const GltfNode& node = scene_.nodes[at(n)];
      if (!node.inScene || node.mesh < 0) continue;
      const GltfPlace primitives = document_.root()["meshes"].at(at(node.mesh))["primitives"];
      for (std::size_t p = 0; p < primitives.size(); ++p)
        readPrimitive(scene_.rest_world[at(n)], primitives.at(p));
    }
    if (mesh_.triangles.empty())
      document_.root()["meshes"].fail("there are no triangles in the scene");
    return std::move(mesh_);
  }

 private:
  void readPrimitive(const Affine& world, const GltfPlace& place) {
    const GltfPlace positions = place["attributes"]["POSITION"];
    const int mode = place["mode"].indexOr(kGltfTriangles, 7);
    if (mode < kGltfTriangles || !positions) return;
    const int accessor = positions.index(accessors_);
    if (document_.elementCount(accessor) > kMostRigVertices - mesh_.positions.size())
      positions.fail("more than " + std::to_string(kMostRigVertices) + " vertices in one mesh");
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    const std::vector<float> local = document_.floats(accessor, 3);
    for (std::size_t v = 0; v < local.size() / 3; ++v) {
      const Vec3 p = world * Eigen::Map<const Eigen::Vector3f>(&local[3 * v]).cast<double>();
      if (!isSane(p.x()) || !isSane(p.y()) || !isSane(p.z()))
        positions.fail("has a position that is no number");
      mesh_.positions.push_back(p.cast<float>());
    }
    readTriangles(place, mode, first, world.linear().determinant() < 0);
  }

  void readTriangles(const GltfPlace& place, int mode, std::uint32_t first, bool mirrored) {
    const auto count = static_cast<std::uint32_t>(mesh_.positions.size()) - first;
    std::vector<std::uint32_t> run;
    if (const GltfPlace indices = place["indices"]) {
      corners_ += document_.elementCount(indices.index(accessors_));
      if (corners_ > kMostRigCorners)
        indices.fail("more than " + std::to_string(kMostRigCorners) + " corners of triangles");
      run = document_.integers(indices.index(accessors_), 1);
    } else {
      for (std::uint32_t i = 0; i < count; ++i) run.push_back(i);
    }
    for (std::array<std::uint32_t, 3> t : gltfTriangles(mode, run)) {
      if (*std::ranges::max_element(t) >= count)
        place["indices"].fail("names a vertex that is not there");
      if (mirrored) std::swap(t[1], t[2]);
      for (std::uint32_t& corner : t) corner += first;
      mesh_.triangles.push_back(t);
    }
  }

  const GltfDocument& document_;
  int accessors_;
  std::vector<std::string> notes_;
  GltfScene scene_;
  TriangleMesh mesh_;
  std::size_t corners_ = 0;  // read so far
};

TriangleMesh welded(const TriangleMesh& cut) {
  Box box;
  for (const Eigen::Vector3f& p : cut.positions) box.add(p.cast<double>());
  const auto tolerance = static_cast<float>(1e-6 * box.size().norm());
  const Weld weld = weldVertices(cut.positions, cut.triangles, tolerance,
                                 [](std::uint32_t, std::uint32_t) { return true; });
  TriangleMesh out;
  out.positions.resize(weld.pointCount);
  for (std::size_t v = cut.positions.size(); v-- > 0;)  // a point is its first vertex
    out.positions[weld.point[v]] = cut.positions[v];
  for (std::array<std::uint32_t, 3> t : cut.triangles) {
    for (std::uint32_t& corner : t) corner = weld.point[corner];
    if (!isDegenerate(out.positions[t[0]], out.positions[t[1]], out.positions[t[2]]))
      out.triangles.push_back(t);
  }
  return out;
}

TriangleMesh surfaceOf(RiggedModel model) {
  return {std::move(model.points_m), {}, {}, std::move(model.triangles)};
}

}  // namespace

TriangleMesh readMeshFile(const std::string& path) {
  if (!isGltfFile(path)) return surfaceOf(readRiggedModel(path));
  const GltfDocument document = GltfDocument::read(path);
  if (document.root()["skins"].size() == 0) return welded(SurfaceReader(document).read());
  return surfaceOf(rigFromGltf(document));
}

}  // namespace fascia
