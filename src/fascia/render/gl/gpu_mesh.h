#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <fascia/render/gl/objects.h>
#include <fascia/render/scene.h>

namespace fascia::gl {

// A drawable's arrays on the graphics side. While the topology stays the same, update() only
// streams the positions, normals and curvatures.
class GpuMesh {
 public:
  GpuMesh();
  // Throws Error when array lengths or triangle indices do not fit together.
  void update(const Drawable& drawable);
  void draw() const;
  // Whether it was closed and faced outwards when its topology came; see facesOutwards().
  bool closed() const { return closed_; }

 private:
  bool sameTopology(const Drawable& drawable) const;
  void updateTopology(const Drawable& drawable);
  void updateShape(const Drawable& drawable);

  VertexArray arrays_;
  Buffer positions_, normals_, curvatures_, uvs_, fibres_, indices_;
  // What the constant buffers hold now.
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<Eigen::Vector2f> uvValues_;
  std::vector<Eigen::Vector3f> fibreValues_;
  std::size_t vertexCount_ = 0;
  bool closed_ = false;
  std::vector<Eigen::Vector3f> computedNormals_;
  std::vector<float> curvature_per_m_;
};

}  // namespace fascia::gl
