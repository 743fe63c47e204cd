#pragma once

#include <cmath>
#include <vector>

#include <fascia/baking/skinning_decomposition.h>

namespace fascia {

// A tube along z of 1 m length and 0.1 m radius.
struct Tube {
  static constexpr std::uint32_t kAround = 12, kAlong = 41;

  Tube() {
    for (std::uint32_t a = 0; a < kAlong; ++a) {
      for (std::uint32_t k = 0; k < kAround; ++k) {
        const double angle = 2 * kPi * k / kAround;
        rest.emplace_back(static_cast<float>(0.1 * std::cos(angle)),
                          static_cast<float>(0.1 * std::sin(angle)),
                          static_cast<float>(a) / static_cast<float>(kAlong - 1));
      }
    }
    for (std::uint32_t a = 0; a + 1 < kAlong; ++a) {
      for (std::uint32_t k = 0; k < kAround; ++k) {
        const std::uint32_t p = a * kAround + k, q = a * kAround + (k + 1) % kAround;
        triangles.push_back({p, q, q + kAround});
        triangles.push_back({p, q + kAround, p + kAround});
      }
    }
  }

  std::vector<Eigen::Vector3f> rest;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

inline PointWeights onTwo(std::uint16_t a, std::uint16_t b, float shareOfB) {
  PointWeights w;
  w.joint = {shareOfB < 1 ? a : b, b};
  w.weight = {shareOfB < 1 ? 1 - shareOfB : 1, shareOfB < 1 ? shareOfB : 0};
  return w;
}

// Rotation about a point.
inline Transform turnAbout(const Vec3& center, const Vec3& axis, double angle_rad) {
  const Mat3 turn = Eigen::AngleAxisd(angle_rad, axis.normalized()).toRotationMatrix();
  return {turn, center - turn * center};
}

// Frames of linear blend skinning, in single precision as a simulation gives them.
inline PointFrames skinnedFrames(const std::vector<Eigen::Vector3f>& rest,
                                 const std::vector<PointWeights>& weights,
                                 const std::vector<std::vector<Transform>>& bones) {
  PointFrames frames;
  for (const std::vector<Transform>& pose : bones) {
    std::vector<Eigen::Vector3f>& frame = frames.emplace_back();
    for (std::size_t i = 0; i < rest.size(); ++i) {
      Vec3 sum = Vec3::Zero();
      for (std::size_t k = 0; k < PointWeights::kMost; ++k) {
        if (weights[i].weight[k] == 0) continue;
        sum += static_cast<double>(weights[i].weight[k]) *
               pose[weights[i].joint[k]].point(rest[i].cast<double>());
      }
      frame.push_back(sum.cast<float>());
    }
  }
  return frames;
}

}  // namespace fascia
