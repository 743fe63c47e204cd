#include <string>

#include <fascia/deformable/surfaces/body_surface.h>
#include <fascia/geometry/signed_mesh.h>

namespace fascia {
namespace {

[[noreturn]] void refuse(const std::string& message) {
  Issue issue{{}, "mesh of a body: " + message, "close it, and turn its triangles outward"};
  throw Error(issue);
}

class MeshSurface final : public BodySurface {
 public:
  explicit MeshSurface(TriangleMesh mesh) : mesh_(std::move(mesh)), signed_(mesh_) {
    if (mesh_.normals.size() != mesh_.positions.size())
      computeNormals(mesh_.positions, mesh_.triangles, mesh_.normals);
    if (signed_.borderCount() > 0)
      refuse("found an edge of " + std::to_string(signed_.borderTriangles()) +
             " triangles, expected 2");
    if (!(enclosedVolume(signed_.welded()) > 0))
      refuse("found nothing inside, expected some volume");
  }

  Box bounds_m() const override { return signed_.bounds_m(); }
  const TriangleMesh& mesh() const override { return mesh_; }

  void evaluate(ConstVectors X, float* distance_m, Vectors normal) const override {
    for (std::size_t i = 0; i < X.count; ++i) {
      const auto nearest = signed_.nearest(Vec3(X.x[i], X.y[i], X.z[i]));
      if (!nearest) {  // no place at all, so no near one
        distance_m[i] = kNowhere_m;
        normal.x[i] = normal.z[i] = 0, normal.y[i] = 1;
        continue;
      }
      distance_m[i] = static_cast<float>(nearest->distance_m);
      normal.x[i] = static_cast<float>(nearest->normal.x());
      normal.y[i] = static_cast<float>(nearest->normal.y());
      normal.z[i] = static_cast<float>(nearest->normal.z());
    }
  }

 private:
  static constexpr float kNowhere_m = 1e9f;

  TriangleMesh mesh_;  // as given
  SignedMesh signed_;
};

}  // namespace

BodySurfacePtr makeMeshSurface(TriangleMesh mesh) {
  if (mesh.triangles.empty()) refuse("found no triangles, expected some");
  return std::make_shared<MeshSurface>(std::move(mesh));
}

}  // namespace fascia
