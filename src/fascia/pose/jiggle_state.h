#pragma once

#include <vector>

#include <fascia/math/types.h>

namespace fascia {

// Vectors of the pose function are four floats with w = 0: one register, one load.
using Vector4f = Eigen::Vector4f;
using FrameArray = std::vector<Vector4f>;

// All that the pose function remembers of the past: per node its offset and velocity, and where its
// place on the skin was. A plain value: a copy goes on exactly as the original does.
struct JiggleState {
  FrameArray offset, velocity;      // of the flesh against its place, m and m/s
  FrameArray place, placeVelocity;  // of the last frame; place is relative to `origin_m`
  Vec3 origin_m = Vec3::Zero();
  int frames = 0;  // seen so far, up to 2: then accelerations are known
};

}  // namespace fascia
