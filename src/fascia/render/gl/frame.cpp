#include <fascia/render/gl/frame.h>

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace fascia::gl {
namespace {

Eigen::Vector3f turned(const Vec3& direction, double azimuth_rad) {
  const double c = std::cos(azimuth_rad), s = std::sin(azimuth_rad);
  const Vec3 d = direction.normalized();
  return Vec3(c * d.x() + s * d.z(), d.y(), c * d.z() - s * d.x()).cast<float>();
}

float largestScatter(const Scene& scene) {
  float scatter_m = 0;
  for (const Drawable& drawable : scene.drawables)
    if (drawable.material.kind == Material::Kind::skin)
      scatter_m = std::max(scatter_m, drawable.material.scatter_m);
  return scatter_m;
}

// Around all places of the ground at height_m that the subject darkens, by being near or by its
// shadow.
std::vector<Vec3> darkenedBy(const Frame& frame, double height_m) {
  const double radius_m = static_cast<double>(frame.subjectRadius_m);
  const double near_m = kOcclusionRadius * radius_m;
  const double spread = std::tan(frame.scene->studio.key_radius_rad);
  const Vec3 light = frame.keyDirection.cast<double>();
  std::vector<Vec3> points;
  for (const Vec3& corner : cornersOf(frame.subject)) {
    const double along_m = std::max(corner.y() - height_m, 0.0) / light.y();
    const Vec3 foot = corner - along_m * light;
    // The penumbra widens with the way, and is stretched where the light is low. The rest is how
    // far blockers are searched for.
    const double soft_m = (spread * along_m + 0.08 * radius_m) / light.y();
    for (const auto& [center, reach_m] : {std::pair(corner, near_m), std::pair(foot, soft_m)})
      for (const double x : {-reach_m, reach_m})
        for (const double z : {-reach_m, reach_m})
          points.emplace_back(center.x() + x, height_m, center.z() + z);
  }
  return points;
}

ScreenBox shadowedFloor(const Frame& frame) {
  const ScreenBox whole(Eigen::Vector2f::Zero(), Eigen::Vector2f::Ones());
  constexpr float kLow = 0.2f;  // of the light above the horizon: shadows as long as the floor
  if (frame.keyDirection.y() < kLow) return whole;
  ScreenBox box;
  for (const Drawable& drawable : frame.scene->drawables) {
    if (drawable.material.kind != Material::Kind::ground) continue;
    const Box ground = worldBounds(drawable);
    const bool flat = ground.empty() || ground.size().y() < 1e-6 * ground.size().norm();
    if (!flat) return whole;
    if (!ground.empty())
      box.extend(onScreen(darkenedBy(frame, ground.low.y()), frame.clipFromWorld));
  }
  return box;
}

}  // namespace

void DrawItem::drawSeenSides() const {
  if (culled) glEnable(GL_CULL_FACE);
  mesh->draw();
  glDisable(GL_CULL_FACE);
}

Frame prepareFrame(const Scene& scene, int width, int height) {
  Frame frame;
  frame.scene = &scene;
  frame.width = width, frame.height = height;
  frame.subject = worldBounds(scene);
  if (frame.subject.empty()) frame.subject = {Vec3::Constant(-0.5), Vec3::Constant(0.5)};
  const double radius_m = std::max(0.5 * frame.subject.size().norm(), 1e-4);
  frame.subjectRadius_m = static_cast<float>(radius_m);

  const Camera& camera = scene.camera;
  const double reach_m = (camera.eye_m - frame.subject.center()).norm();
  // The floor reaches ten radii out and its near part may lie between the eye and the subject.
  const double near_m =
      camera.near_m > 0 ? camera.near_m : std::max(0.05 * reach_m, 0.01 * radius_m);
  const double clearance_m = 2 * near_m;  // as far as the near plane's corners, and more
  frame.seenFromOutside =
      ((frame.subject.low - camera.eye_m).cwiseMax(camera.eye_m - frame.subject.high)).maxCoeff() >
      clearance_m;
  const double far_m = camera.far_m > near_m ? camera.far_m : near_m + reach_m + 25 * radius_m;
  const double aspect = static_cast<double>(width) / height;
  frame.viewFromWorld = fascia::viewFromWorld(camera);
  frame.worldFromView = frame.viewFromWorld.inverse();
  frame.clipFromWorld = clipFromView(camera, aspect, near_m, far_m) * frame.viewFromWorld;
  const double tanY = std::tan(0.5 * camera.vertical_fov_rad);
  frame.tanHalfFov = Vec2(tanY * aspect, tanY).cast<float>();

  const Studio& studio = scene.studio;
  frame.keyDirection = turned(studio.key.direction, studio.azimuth_rad);
  frame.fillDirection = turned(studio.fill.direction, studio.azimuth_rad);
  frame.rimDirection = turned(studio.rim.direction, studio.azimuth_rad);
  frame.thicknessScale_m = std::max(2 * largestScatter(scene), 0.01f * frame.subjectRadius_m);
  frame.subjectOnScreen = onScreen(cornersOf(frame.subject), frame.clipFromWorld);
  frame.shadowedFloor = shadowedFloor(frame);
  return frame;
}

}  // namespace fascia::gl
