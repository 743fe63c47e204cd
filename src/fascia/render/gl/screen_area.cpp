#include <fascia/render/gl/screen_area.h>

#include <algorithm>
#include <cmath>

#include <epoxy/gl.h>

namespace fascia::gl {

std::array<Vec3, 8> cornersOf(const Box& box) {
  std::array<Vec3, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners[i] = Vec3((i & 1 ? box.high : box.low).x(), (i & 2 ? box.high : box.low).y(),
                      (i & 4 ? box.high : box.low).z());
  return corners;
}

ScreenBox onScreen(std::span<const Vec3> points, const Eigen::Matrix4f& clipFromWorld) {
  const ScreenBox whole(Eigen::Vector2f::Zero(), Eigen::Vector2f::Ones());
  constexpr float kInFront = 1e-6f;
  ScreenBox box;
  for (const Vec3& p : points) {
    const Eigen::Vector4f clip = clipFromWorld * p.homogeneous().cast<float>();
    if (!(clip.z() > -clip.w() && clip.w() > kInFront)) return whole;
    box.extend(
        Eigen::Vector2f(0.5f + 0.5f * clip.x() / clip.w(), 0.5f + 0.5f * clip.y() / clip.w()));
  }
  return whole.intersection(box);
}

ScissorTo::ScissorTo(const ScreenBox& box, int width, int height, int margin) {
  const auto around = static_cast<float>(margin);
  const auto span = [&](int axis, int size) {
    const auto n = static_cast<float>(size);
    const float low = std::floor(box.min()[axis] * n - around);
    const float high = std::ceil(box.max()[axis] * n + around);
    const int first = static_cast<int>(std::clamp(low, 0.f, n));
    return std::array{first, static_cast<int>(std::clamp(high, 0.f, n)) - first};
  };
  const auto x = span(0, width), y = span(1, height);
  glEnable(GL_SCISSOR_TEST);
  glScissor(x[0], y[0], std::max(x[1], 0), std::max(y[1], 0));
}

ScissorTo::~ScissorTo() {
  glDisable(GL_SCISSOR_TEST);
}

}  // namespace fascia::gl
