#pragma once

#include <initializer_list>

#include <fascia/render/gl/backdrop_pass.h>

namespace fascia::gl {

// The lit, anti-aliased picture: what stands in the studio is drawn on its own, with several
// samples per pixel, in the part of the picture that it covers, and laid over the backdrop.
class BeautyPass {
 public:
  explicit BeautyPass(Look look);
  void draw(const Frame& frame, const LightPasses& light);
  void read(Pixels& pixels) const;  // what draw() drew last

 private:
  void resize(int width, int height);
  void drawSubject(const Frame& frame, const LightPasses& light);
  void drawOpaque(const Frame& frame, const LightPasses& light,
                  std::initializer_list<Material::Kind> kinds);
  void drawSeeThrough(const Frame& frame, const LightPasses& light, Material::Kind kind);
  void drawHidden(const Frame& frame, const LightPasses& light);
  void drawDepth(const Frame& frame, Material::Kind kind);
  void cutGround(const Frame& frame);
  void layOverBackdrop();

  LitPrograms lit_;
  BackdropPass backdrop_;
  Program depthProgram_, layerProgram_;
  VertexArray noArrays_;
  Texture resolvedColor_;
  Renderbuffer color_, depth_;
  Framebuffer target_, resolved_;
  int width_ = 0, height_ = 0;
};

}  // namespace fascia::gl
