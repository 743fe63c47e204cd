#include <fascia/render/scene.h>

#include <algorithm>
#include <cmath>

namespace fascia {

Box worldBounds(const Drawable& drawable) {
  const Eigen::Matrix3f rotation = drawable.world.rotation.cast<float>();
  const Eigen::Vector3f origin = drawable.world.translation_m.cast<float>();
  Eigen::Vector3f low = Eigen::Vector3f::Constant(3e38f), high = -low;
  bool any = false;
  for (const Eigen::Vector3f& p : drawable.mesh.positions) {
    const Eigen::Vector3f w = rotation * p + origin;
    if (!w.allFinite()) continue;
    low = low.cwiseMin(w), high = high.cwiseMax(w);
    any = true;
  }
  return any ? Box{low.cast<double>(), high.cast<double>()} : Box{};
}

Box worldBounds(const Scene& scene) {
  Box box;
  for (const Drawable& drawable : scene.drawables)
    if (drawable.material.kind != Material::Kind::ground) {
      const Box b = worldBounds(drawable);
      if (!b.empty()) box.add(b);
    }
  return box;
}

Drawable groundDisc(const Box& bounds) {
  return groundDisc(bounds, bounds.empty() ? 0.0 : bounds.low.y());
}

Drawable groundDisc(const Box& bounds, double height_m) {
  constexpr int kSegments = 96;
  const double size_m = bounds.empty() ? 1.0 : std::max(bounds.size().norm(), 1e-3);
  const float radius_m = static_cast<float>(5 * size_m);  // the shader fades it out before its edge
  Drawable disc;
  disc.material.kind = Material::Kind::ground;
  disc.material.color = Rgb(0.86f, 0.86f, 0.855f);
  disc.material.roughness = 0.9f;
  disc.world.translation_m = bounds.empty()
                                 ? Vec3(0, height_m, 0)
                                 : Vec3(bounds.center().x(), height_m, bounds.center().z());
  disc.mesh.positions.emplace_back(0.f, 0.f, 0.f);
  disc.mesh.uvs.emplace_back(0.f, 0.f);
  for (int i = 0; i < kSegments; ++i) {
    const float a = static_cast<float>(2 * kPi * i / kSegments);
    const Eigen::Vector2f direction(std::cos(a), std::sin(a));
    disc.mesh.positions.emplace_back(radius_m * direction.x(), 0.f, radius_m * direction.y());
    disc.mesh.uvs.push_back(direction);  // length 1 at the rim
    const auto here = static_cast<std::uint32_t>(1 + i);
    const auto next = static_cast<std::uint32_t>(1 + (i + 1) % kSegments);
    disc.mesh.triangles.push_back({0, next, here});
  }
  disc.mesh.normals.assign(disc.mesh.positions.size(), Eigen::Vector3f::UnitY());
  return disc;
}

}  // namespace fascia
