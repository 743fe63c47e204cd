#include <fascia/render/gl/frame.h>

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include <fascia/render/gl/floor_tiles.h>

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

Eigen::Matrix4f worldFromObject(const Drawable& drawable) {
  Eigen::Matrix4f world = Eigen::Matrix4f::Identity();
  world.block<3, 3>(0, 0) = drawable.world.rotation.cast<float>();
  world.block<3, 1>(0, 3) = drawable.world.translation_m.cast<float>();
  return world;
}

bool isGround(const Drawable& drawable) {
  return drawable.material.kind == Material::Kind::ground;
}

bool isFlat(const Box& ground) {
  return ground.empty() || ground.size().y() < 1e-6 * ground.size().norm();
}

DarkeningReach reachOf(const Frame& frame, Look look) {
  const float radius_m = frame.subjectRadius_m;
  // A few texels of the shadow map, as shaders look it up.
  if (look == Look::fast) return {frame.keyDirection, 0, 0.02f * radius_m, 0};
  // As far as blockers are searched for.
  return {frame.keyDirection,
          static_cast<float>(std::tan(static_cast<double>(frame.scene->studio.key_radius_rad))),
          0.08f * radius_m, kOcclusionRadius * radius_m};
}

std::vector<ScreenBox> shadowedFloor(const Frame& frame, Look look) {
  const std::vector<ScreenBox> whole{{Eigen::Vector2f::Zero(), Eigen::Vector2f::Ones()}};
  constexpr float kLow = 0.2f;  // of the light above the horizon: shadows as long as the floor
  if (frame.keyDirection.y() < kLow) return whole;
  FloorTiles tiles(frame.clipFromWorld, frame.width, frame.height, reachOf(frame, look));
  for (const Drawable& floor : frame.scene->drawables) {
    if (!isGround(floor)) continue;
    const Box ground = worldBounds(floor);
    if (!isFlat(ground)) return whole;
    if (ground.empty()) continue;
    for (const Drawable& drawable : frame.scene->drawables)
      if (!isGround(drawable))
        tiles.add(drawable.mesh, worldFromObject(drawable), static_cast<float>(ground.low.y()));
  }
  return tiles.boxes();
}

// Floor may be nearer to the camera than what stands on it.
bool dipsBelowFloor(const Frame& frame) {
  const double slack_m = 1e-5 * static_cast<double>(frame.subjectRadius_m);
  return std::ranges::any_of(frame.scene->drawables, [&](const Drawable& drawable) {
    if (!isGround(drawable)) return false;
    const Box ground = worldBounds(drawable);
    return !isFlat(ground) || (!ground.empty() && frame.subject.low.y() < ground.low.y() - slack_m);
  });
}

}  // namespace

void DrawItem::drawSeenSides() const {
  if (culled) glEnable(GL_CULL_FACE);
  mesh->draw();
  glDisable(GL_CULL_FACE);
}

Frame prepareFrame(const Scene& scene, int width, int height, Look look) {
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
  frame.shadowedFloor = shadowedFloor(frame, look);
  frame.dipsBelowFloor = dipsBelowFloor(frame);
  return frame;
}

}  // namespace fascia::gl
