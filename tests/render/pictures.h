#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <string>

#include <fascia/base/error.h>
#include <fascia/render/renderer.h>

// What the tests of pictures share: simple meshes, and ways to look at pixels.
namespace fascia::test {

// The process's renderer; nullptr and a reason where this machine has no OpenGL.
struct SharedRenderer {
  std::unique_ptr<Renderer> renderer;
  std::string reason;
};
inline SharedRenderer& sharedRenderer() {
  static SharedRenderer shared = [] {
    SharedRenderer s;
    try {
      s.renderer = std::make_unique<Renderer>();
    } catch (const Error& error) {
      s.reason = error.what();
    }
    return s;
  }();
  return shared;
}

#define FASCIA_REQUIRE_GL()                     \
  if (!fascia::test::sharedRenderer().renderer) \
  GTEST_SKIP() << fascia::test::sharedRenderer().reason

inline Pixels draw(const Scene& scene, int width = 160, int height = 120) {
  return sharedRenderer().renderer->render(scene, width, height);
}

inline TriangleMesh sphereMesh(const Eigen::Vector3f& center, float radius_m, int segments = 32) {
  TriangleMesh mesh;
  const int rings = segments / 2;
  for (int j = 0; j <= rings; ++j)
    for (int i = 0; i <= segments; ++i) {
      const double u = 2 * kPi * i / segments, v = kPi * (static_cast<double>(j) / rings - 0.5);
      const Eigen::Vector3f n =
          Vec3(std::cos(v) * std::cos(u), std::sin(v), -std::cos(v) * std::sin(u)).cast<float>();
      mesh.positions.push_back(center + radius_m * n);
      mesh.normals.push_back(n);
    }
  for (int j = 0; j < rings; ++j)
    for (int i = 0; i < segments; ++i) {
      const auto a = static_cast<std::uint32_t>(j * (segments + 1) + i), b = a + 1;
      const auto c = a + static_cast<std::uint32_t>(segments) + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  return mesh;
}

inline Drawable sphere(const Eigen::Vector3f& center, float radius_m, const Rgb& color,
                       Material::Kind kind = Material::Kind::plain) {
  Drawable drawable;
  drawable.mesh = sphereMesh(center, radius_m);
  drawable.material.kind = kind;
  drawable.material.color = color;
  return drawable;
}

inline Scene framed(std::vector<Drawable> drawables, const char* camera = "front",
                    double aspect = 4.0 / 3) {
  Scene scene;
  scene.drawables = std::move(drawables);
  scene.camera = frameBox(parseCamera(camera), worldBounds(scene), aspect);
  return scene;
}

inline std::array<int, 3> rgbAt(const Pixels& p, int x, int y) {
  const std::uint8_t* c = p.at(x, y);
  return {c[0], c[1], c[2]};
}
inline int sumAt(const Pixels& p, int x, int y) {
  const auto c = rgbAt(p, x, y);
  return c[0] + c[1] + c[2];
}

// How many pixels satisfy a condition on (r, g, b).
template <class Condition>
int count(const Pixels& p, Condition condition) {
  int n = 0;
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x) {
      const auto c = rgbAt(p, x, y);
      n += condition(c[0], c[1], c[2]) ? 1 : 0;
    }
  return n;
}

// Pixels in which two pictures differ by more than noise.
inline int differing(const Pixels& a, const Pixels& b) {
  int n = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      const auto c = rgbAt(a, x, y), d = rgbAt(b, x, y);
      n += std::abs(c[0] - d[0]) + std::abs(c[1] - d[1]) + std::abs(c[2] - d[2]) > 24 ? 1 : 0;
    }
  return n;
}

// Where a world point falls in a picture.
inline std::array<int, 2> pixelOf(const Scene& scene, const Vec3& point, int width, int height) {
  const double aspect = static_cast<double>(width) / height;
  const Eigen::Vector4f clip = clipFromView(scene.camera, aspect, 0.1, 100) *
                               viewFromWorld(scene.camera) * point.homogeneous().cast<float>();
  return {static_cast<int>((0.5f + 0.5f * clip.x() / clip.w()) * static_cast<float>(width)),
          static_cast<int>((0.5f - 0.5f * clip.y() / clip.w()) * static_cast<float>(height))};
}

}  // namespace fascia::test
