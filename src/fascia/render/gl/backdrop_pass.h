#pragma once

#include <vector>

#include <fascia/render/gl/lit_programs.h>

namespace fascia::gl {

// The picture of an empty studio, with the shadows on its floor. The part without shadows is kept
// for as long as neither camera nor studio changes, as in most films.
class BackdropPass {
 public:
  BackdropPass();
  // Draws all of picture(), before anything that stands in the studio.
  void draw(const Frame& frame, const LightPasses& light, LitPrograms& lit);
  const Framebuffer& picture() const { return picture_; }

 private:
  void resize(int width, int height);
  void drawEmpty(const Frame& frame, const LightPasses& light, LitPrograms& lit);
  void drawGround(const Frame& frame, const LightPasses& light, LitPrograms& lit,
                  LitPrograms::Part part);

  Program backgroundProgram_;
  VertexArray noArrays_;
  Renderbuffer emptyColor_, color_, depth_;
  Framebuffer empty_, picture_;
  std::vector<float> emptyIsOf_;  // all that the empty picture depends on
  int width_ = 0, height_ = 0;
};

}  // namespace fascia::gl
