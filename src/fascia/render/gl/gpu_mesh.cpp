#include <fascia/render/gl/gpu_mesh.h>

#include <algorithm>

#include <fascia/base/error.h>
#include <fascia/render/closed_surface.h>
#include <fascia/render/curvature.h>

namespace fascia::gl {
namespace {

// Attribute numbers, as in shaders/mesh_vertex.
enum Attribute : GLuint { kPosition, kNormal, kUv, kCurvature, kFibre };

void validate(const Drawable& drawable) {
  const TriangleMesh& mesh = drawable.mesh;
  const std::size_t n = mesh.positions.size();
  const auto fits = [n](std::size_t size) { return size == 0 || size == n; };
  if (!fits(mesh.normals.size()) || !fits(mesh.uvs.size()) ||
      !fits(drawable.fibre_coordinates.size()))
    throw Error("render: a mesh's normals, uvs or fibre coordinates are not as many as its points");
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t i : triangle)
      if (i >= n)
        throw Error("render: a triangle names point " + std::to_string(i) + " of a mesh with " +
                    std::to_string(n) + " points");
}

template <class T>
void fill(GLuint attribute, const Buffer& buffer, const std::vector<T>& values, GLenum usage) {
  if (values.empty()) {
    glDisableVertexAttribArray(attribute);
    glVertexAttrib4f(attribute, 0, 0, 0, 0);
    return;
  }
  glBindBuffer(GL_ARRAY_BUFFER, buffer.id());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(values.size() * sizeof(T)), values.data(),
               usage);
  glEnableVertexAttribArray(attribute);
  constexpr std::size_t kFloatBytes = 4;  // GL_FLOAT
  glVertexAttribPointer(attribute, sizeof(T) / kFloatBytes, GL_FLOAT, GL_FALSE, 0, nullptr);
}

}  // namespace

GpuMesh::GpuMesh() = default;

void GpuMesh::update(const Drawable& drawable) {
  glBindVertexArray(arrays_.id());
  if (!sameTopology(drawable)) {
    validate(drawable);
    updateTopology(drawable);
  }
  updateShape(drawable);
}

bool GpuMesh::sameTopology(const Drawable& drawable) const {
  const TriangleMesh& mesh = drawable.mesh;
  return mesh.positions.size() == vertexCount_ &&
         (mesh.normals.empty() || mesh.normals.size() == vertexCount_) &&
         mesh.triangles == triangles_ && mesh.uvs == uvValues_ &&
         drawable.fibre_coordinates == fibreValues_;
}

void GpuMesh::updateTopology(const Drawable& drawable) {
  vertexCount_ = drawable.mesh.positions.size();
  triangles_ = drawable.mesh.triangles;
  uvValues_ = drawable.mesh.uvs;
  fibreValues_ = drawable.fibre_coordinates;
  closed_ = facesOutwards(drawable.mesh);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  glBufferData(GL_ELEMENT_ARRAY_BUFFER,
               static_cast<GLsizeiptr>(triangles_.size() * sizeof(triangles_[0])),
               triangles_.data(), GL_STATIC_DRAW);
  fill(kUv, uvs_, uvValues_, GL_STATIC_DRAW);
  fill(kFibre, fibres_, fibreValues_, GL_STATIC_DRAW);
}

void GpuMesh::updateShape(const Drawable& drawable) {
  const TriangleMesh& mesh = drawable.mesh;
  if (mesh.normals.empty()) computeNormals(mesh.positions, mesh.triangles, computedNormals_);
  const auto& normals = mesh.normals.empty() ? computedNormals_ : mesh.normals;
  fill(kPosition, positions_, mesh.positions, GL_STREAM_DRAW);
  fill(kNormal, normals_, normals, GL_STREAM_DRAW);
  curvature_per_m_.clear();
  if (drawable.material.kind == Material::Kind::skin)
    vertexCurvature(mesh.positions, normals, mesh.triangles, curvature_per_m_);
  fill(kCurvature, curvatures_, curvature_per_m_, GL_STREAM_DRAW);
}

void GpuMesh::draw() const {
  glBindVertexArray(arrays_.id());
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * triangles_.size()), GL_UNSIGNED_INT,
                 nullptr);
}

}  // namespace fascia::gl
