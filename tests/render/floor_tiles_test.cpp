#include <gtest/gtest.h>

#include <fascia/render/camera.h>
#include <fascia/render/gl/floor_tiles.h>

#include "pictures.h"

namespace fascia::gl {
namespace {

constexpr int kWidth = 1280, kHeight = 720;
constexpr float kFloor = -0.25f;

struct View {
  Scene scene;
  Eigen::Matrix4f clipFromWorld;
  explicit View(const char* camera = "az=30,el=20")
      : scene(test::framed({test::sphere({-1.5f, 0.6f, 0}, 0.4f, {1, 1, 1}),
                            test::sphere({1.5f, 0.2f, 0.5f}, 0.3f, {1, 1, 1})},
                           camera, 16.0 / 9)),
        clipFromWorld(clipFromView(scene.camera, 16.0 / 9, 0.1, 100) *
                      viewFromWorld(scene.camera)) {}
  FloorTiles tiles(const DarkeningReach& reach) const {
    FloorTiles tiles(clipFromWorld, kWidth, kHeight, reach);
    for (const Drawable& d : scene.drawables)
      tiles.add(d.mesh, Eigen::Matrix4f::Identity(), kFloor);
    return tiles;
  }
  Eigen::Vector2f onScreen(const Eigen::Vector3f& p) const {
    const Eigen::Vector4f clip = clipFromWorld * p.homogeneous();
    return 0.5f * (clip.head<2>() / clip.w() + Eigen::Vector2f(1, 1));
  }
};

DarkeningReach reachTowards(const Vec3& light, float spread, float soft_m, float near_m) {
  return {light.normalized().cast<float>(), spread, soft_m, near_m};
}

double areaOf(const std::vector<ScreenBox>& boxes) {
  double area = 0;
  for (const ScreenBox& box : boxes) area += static_cast<double>(box.volume());
  return area;
}

bool hold(const std::vector<ScreenBox>& boxes, const Eigen::Vector2f& p) {
  const ScreenBox screen(Eigen::Vector2f::Zero(), Eigen::Vector2f::Ones());
  return !screen.contains(p) ||
         std::ranges::any_of(boxes, [&](const ScreenBox& box) { return box.contains(p); });
}

TEST(FloorTiles, HoldAllThatAPointDarkens) {
  for (const Vec3& direction : {Vec3(0.8, 0.92, 0.62), Vec3(-0.9, 0.35, 0.1), Vec3(0, 1, 0)}) {
    const View view;
    const auto reach = reachTowards(direction, 0.1f, 0.05f, 0.6f);
    const auto boxes = view.tiles(reach).boxes();
    int outside = 0, looked = 0;
    for (const Drawable& d : view.scene.drawables)
      for (const Eigen::Vector3f& p : d.mesh.positions) {
        const float along_m = (p.y() - kFloor) / reach.light.y();
        const Eigen::Vector3f foot = p - along_m * reach.light;
        const float soft_m = (reach.spread * along_m + reach.soft_m) / reach.light.y();
        const float height_m = p.y() - kFloor;
        for (int k = 0; k < 8; ++k, ++looked) {
          const float a = 0.785398f * static_cast<float>(k);
          const Eigen::Vector3f out(0.99f * std::cos(a), 0, 0.99f * std::sin(a));
          outside += hold(boxes, view.onScreen(foot + soft_m * out)) ? 0 : 1;
          if (height_m >= reach.near_m) continue;
          const float near_m = std::sqrt(reach.near_m * reach.near_m - height_m * height_m);
          const Eigen::Vector3f below(p.x(), kFloor, p.z());
          outside += hold(boxes, view.onScreen(below + near_m * out)) ? 0 : 1;
        }
      }
    EXPECT_GT(looked, 1000);
    EXPECT_EQ(outside, 0) << direction.transpose();
  }
}

TEST(FloorTiles, LeaveOutWhatLiesBetweenShadowsAndDoNotOverlap) {
  const View view;
  const auto boxes = view.tiles(reachTowards({0.8, 0.92, 0.62}, 0, 0.01f, 0)).boxes();
  ScreenBox common;
  for (const ScreenBox& box : boxes) common.extend(box);
  EXPECT_GT(areaOf(boxes), 0.01);
  EXPECT_LT(areaOf(boxes), 0.5 * static_cast<double>(common.volume()));
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_LT(boxes[i].intersection(boxes[j]).sizes().minCoeff(), 1e-6f) << i << " " << j;
}

TEST(FloorTiles, AreAllOfThePictureWhereShadowsComeFromBehindTheCamera) {
  const auto reach = reachTowards({0, 0.5, -1}, 0, 0.01f, 0);
  View view("front");
  view.scene.drawables[0].mesh.positions[100] =
      (view.scene.camera.eye_m + Vec3(0, 3, 0)).cast<float>();
  EXPECT_NEAR(areaOf(view.tiles(reach).boxes()), 1, 1e-5);
}

TEST(FloorTiles, LeaveOutTrianglesThatAreNotDrawn) {
  const auto reach = reachTowards({0.8, 0.92, 0.62}, 0, 0.01f, 0);
  View view;
  const double whole = areaOf(view.tiles(reach).boxes());
  for (const std::size_t i : {std::size_t{100}, std::size_t{200}})
    view.scene.drawables[0].mesh.positions[i].setConstant(std::numeric_limits<float>::quiet_NaN());
  view.scene.drawables[1].mesh.triangles.push_back({0, 1, 1'000'000});
  EXPECT_LE(areaOf(view.tiles(reach).boxes()), whole);
  EXPECT_GT(areaOf(view.tiles(reach).boxes()), 0.5 * whole);
}

}  // namespace
}  // namespace fascia::gl
