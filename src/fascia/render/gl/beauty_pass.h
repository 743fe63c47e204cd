#pragma once

#include <initializer_list>

#include <fascia/render/gl/backdrop_pass.h>

namespace fascia::gl {

// The lit, anti-aliased picture: what stands in the studio is drawn on its own, in the part of the
// picture that it covers, and laid over the backdrop. The full look takes several samples per
// pixel, the fast one smooths the edges afterwards.
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
  void resolve();
  void layOverBackdrop();

  int samples_;  // per pixel; 0: one, without what it takes to have more
  LitPrograms lit_;
  BackdropPass backdrop_;
  Program depthProgram_, layerProgram_;
  VertexArray noArrays_;
  Texture layer_;               // what stands in the studio, its colours multiplied by alpha
  Renderbuffer color_, depth_;  // color_: of all samples
  Framebuffer target_, resolved_;
  ScreenBox subject_;  // of what was drawn last
  int width_ = 0, height_ = 0;
};

}  // namespace fascia::gl
