#pragma once

#include <array>
#include <initializer_list>
#include <memory>

#include <fascia/render/gl/frame.h>
#include <fascia/render/gl/occlusion_pass.h>

namespace fascia::gl {

// The lit, anti-aliased picture.
class BeautyPass {
 public:
  BeautyPass();
  void draw(const Frame& frame, const OcclusionPass& occlusion);
  void read(Pixels& pixels) const;  // what draw() drew last

 private:
  void resize(int width, int height);
  void drawBackground(const Frame& frame);
  void drawOpaque(const Frame& frame, const OcclusionPass& occlusion,
                  std::initializer_list<Material::Kind> kinds);
  void drawSeeThrough(const Frame& frame, const OcclusionPass& occlusion, Material::Kind kind);
  void drawHidden(const Frame& frame, const OcclusionPass& occlusion);
  void drawDepth(const Frame& frame, Material::Kind kind);
  void drawLit(const Frame& frame, const OcclusionPass& occlusion, const DrawItem& item,
               bool hidden = false);
  Program& litProgram(Material::Kind kind);

  Program backgroundProgram_, depthProgram_;
  std::array<std::unique_ptr<Program>, 5> litPrograms_;  // by kind, made when first needed
  VertexArray noArrays_;
  Texture scatterLookup_, noise_;
  Renderbuffer color_, depth_, resolvedColor_;
  Framebuffer target_, resolved_;
  int width_ = 0, height_ = 0;
};

}  // namespace fascia::gl
