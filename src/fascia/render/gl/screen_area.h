#pragma once

#include <array>
#include <span>

#include <Eigen/Geometry>

#include <fascia/math/types.h>

namespace fascia::gl {

// A part of the picture; (0, 0) = bottom left, (1, 1) = top right.
using ScreenBox = Eigen::AlignedBox2f;

std::array<Vec3, 8> cornersOf(const Box& box);

// What points cover, seen through a camera; all of the picture if one is behind it.
ScreenBox onScreen(std::span<const Vec3> points, const Eigen::Matrix4f& clipFromWorld);

// Restricts drawing, clearing and copying to a part of a target of this size, and to a margin
// around it, while it lives.
class ScissorTo {
 public:
  static constexpr int kMargin = 3;  // pixels: blurs and edges reach a little farther
  ScissorTo(const ScreenBox& box, int width, int height, int margin = kMargin);
  ~ScissorTo();
  ScissorTo(const ScissorTo&) = delete;
  ScissorTo& operator=(const ScissorTo&) = delete;
};

}  // namespace fascia::gl
