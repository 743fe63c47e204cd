#pragma once

#include <fascia/render/gl/frame.h>

namespace fascia::gl {

// The key light's depth picture of everything that casts a shadow.
class ShadowPass {
 public:
  explicit ShadowPass(int size);  // texels on a side
  void draw(const Frame& frame);
  // Binds the map to two units, as depths and for comparison, and sets the uniforms about it.
  void bind(Program& program, int depthUnit, int compareUnit) const;

 private:
  void fit(const Frame& frame);

  Program program_;
  Texture depth_;
  Framebuffer framebuffer_;
  Sampler plain_, compare_;
  int size_;
  Eigen::Matrix4f shadowFromWorld_;  // to [0, 1]³
  float extent_m_ = 1, range_m_ = 1;
};

}  // namespace fascia::gl
