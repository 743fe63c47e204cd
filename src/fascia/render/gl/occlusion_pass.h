#pragma once

#include <fascia/render/gl/frame.h>
#include <fascia/render/gl/shadow_pass.h>

namespace fascia::gl {

// Ambient occlusion, soft key shadow and thickness of what the camera sees, blurred along surfaces.
// Works on a picture of at most half the size when that is large: the blur hides it.
class OcclusionPass {
 public:
  OcclusionPass();
  void draw(const Frame& frame, const ShadowPass& shadow);
  // Binds the results to two units and sets the uniforms about them.
  void bind(Program& program, int geometryUnit, int occlusionUnit) const;

 private:
  void resize(int width, int height);
  void drawGeometry(const Frame& frame);
  void blur(const Frame& frame, const Texture& from, const Framebuffer& to,
            const Eigen::Vector2f& step_uv);

  Program geometryProgram_, occlusionProgram_, blurProgram_;
  VertexArray noArrays_;
  Texture geometry_, occlusion_, blurred_;
  Renderbuffer depth_;
  Framebuffer geometryTarget_, occlusionTarget_, blurredTarget_;
  int width_ = 0, height_ = 0;
};

}  // namespace fascia::gl
