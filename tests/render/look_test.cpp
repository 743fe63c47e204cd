#include <gtest/gtest.h>

#include <fascia/render/closed_surface.h>

#include "pictures.h"

namespace fascia {
namespace {

using test::differing;
using test::draw;
using test::framed;
using test::sphere;

const Rgb kClay(0.8f, 0.4f, 0.2f);

Scene onFloor(Scene scene) {
  scene.drawables.push_back(groundDisc(worldBounds(scene)));
  return scene;
}

// Both sides of a seam to the same place, to the last bit.
void closeSeam(TriangleMesh& mesh) {
  for (auto& p : mesh.positions) p = (p * 65536.f).array().round() / 65536.f;
}

// A ball and a stick, on the floor.
Scene still(Material::Kind kind = Material::Kind::plain, const char* camera = "az=30,el=15") {
  Drawable stick = sphere({0.7f, 0.6f, 0.2f}, 0.6f, kClay, kind);
  for (auto& p : stick.mesh.positions) p.x() = 0.7f + 0.2f * (p.x() - 0.7f);
  Drawable ball = sphere({0, 0.5f, 0}, 0.5f, kClay, kind);
  for (Drawable* drawable : {&ball, &stick}) closeSeam(drawable->mesh);
  return onFloor(framed({ball, stick}, camera));
}

// Opens its surfaces where neither camera nor light look, so that their back faces are drawn.
Scene opened(Scene scene) {
  const Eigen::Vector3f eye = scene.camera.eye_m.cast<float>();
  for (Drawable& drawable : scene.drawables) {
    TriangleMesh& mesh = drawable.mesh;
    if (drawable.material.kind == Material::Kind::ground) continue;
    EXPECT_TRUE(facesOutwards(mesh));
    const Eigen::Vector3f light = scene.studio.key.direction.normalized().cast<float>();
    const auto away = [&](const std::array<std::uint32_t, 3>& t) {
      const Eigen::Vector3f n = mesh.normals[t[0]];
      return n.dot((eye - mesh.positions[t[0]]).normalized()) < -0.5f && n.dot(light) < -0.3f;
    };
    const auto found = std::find_if(mesh.triangles.rbegin(), mesh.triangles.rend(), away);
    EXPECT_NE(found, mesh.triangles.rend());
    *found = {(*found)[0], (*found)[0], (*found)[0]};
    EXPECT_FALSE(facesOutwards(mesh));
  }
  return scene;
}

TEST(Culling, OfClosedSolidsDoesNotChangeThePicture) {
  FASCIA_REQUIRE_GL();
  using Kind = Material::Kind;
  for (const Kind kind : {Kind::skin, Kind::muscle, Kind::bone, Kind::plain}) {
    const Scene scene = still(kind);
    EXPECT_LT(differing(draw(scene), draw(opened(scene))), 5);
  }
}

TEST(Culling, LeavesTheInsideOfOpenSurfaces) {
  FASCIA_REQUIRE_GL();
  Drawable bowl = sphere({0, 0, 0}, 1, kClay);
  std::erase_if(bowl.mesh.triangles, [&](const auto& t) {
    return bowl.mesh.positions[t[0]].z() > 0 || bowl.mesh.positions[t[1]].z() > 0;
  });
  const Pixels picture = draw(framed({bowl}));  // into the bowl
  const auto c = test::rgbAt(picture, 80, 60);
  EXPECT_GT(c[0], c[2] + 40);
}

TEST(Culling, LeavesTheInsideOfASolidThatTheCameraIsIn) {
  FASCIA_REQUIRE_GL();
  Scene scene = framed({sphere({0, 0, 0}, 1, kClay), sphere({0, 0, 3}, 0.1f, kClay)});
  scene.camera.eye_m = Vec3(0, 0, 0.5);
  scene.camera.target_m = Vec3(0, 0, -1);
  scene.camera.near_m = 0.01;
  const auto c = test::rgbAt(draw(scene), 80, 60);
  EXPECT_GT(c[0], c[2] + 10);
}

TEST(Backdrop, IsDrawnAnewWhenAnyPartOfItChanges) {
  FASCIA_REQUIRE_GL();
  const Scene scene = still();
  std::vector<Scene> changed(5, scene);
  changed[0].camera.eye_m += Vec3(0.3, 0.2, 0);
  changed[1].background.top = Rgb(0.2f, 0.4f, 0.9f);
  changed[2].drawables.back().material.color = Rgb(0.3f, 0.6f, 0.3f);
  changed[3].drawables.back().world.translation_m.y() -= 0.2;
  changed[4].background.vignette = 0.8f;
  for (const Scene& other : changed) {
    const Pixels before = draw(scene), after = draw(other);
    EXPECT_GT(differing(before, after), 200);
    Renderer fresh;
    EXPECT_EQ(differing(fresh.render(other, 160, 120), after), 0);
  }
}

// A floor that is not quite flat is searched for shadows everywhere; its bump shows in a few
// pixels, and occlusion in the outermost row is a little off where it is looked for.
TEST(Backdrop, HoldsTheWholeShadowFromEverySide) {
  FASCIA_REQUIRE_GL();
  Renderer fast(Look::fast);
  for (const char* camera : {"front", "az=130,el=50", "top", "az=-60,el=4"})
    for (const Vec3& light : {Vec3(0.8, 0.92, 0.62), Vec3(-0.9, 0.35, 0.1), Vec3(0, 0.3, -1)}) {
      Scene scene = still(Material::Kind::plain, camera);
      scene.studio.key.direction = light;
      Scene lifted = scene;
      lifted.drawables[0].world.translation_m.y() += 0.8;
      for (Scene flat : {scene, lifted})
        for (Renderer* renderer : {test::sharedRenderer().renderer.get(), &fast}) {
          const Pixels part = renderer->render(flat, 160, 120);
          flat.drawables.back().mesh.positions[7].y() += 1e-3f;
          const Pixels whole = renderer->render(flat, 160, 120);
          flat.drawables.back().mesh.positions[7].y() -= 1e-3f;
          EXPECT_LT(differing(part, whole), 30) << camera << " " << light.transpose();
        }
    }
}

TEST(Backdrop, HidesWhatIsBelowTheFloor) {
  FASCIA_REQUIRE_GL();
  Scene scene = framed({sphere({0, 0, 0}, 1, kClay)}, "el=30");
  scene.drawables.push_back(groundDisc(worldBounds(scene), 0));
  const auto clay = [](int r, int, int b) { return r > b + 60; };
  const int half = test::count(draw(scene), clay);
  scene.drawables.pop_back();
  const int whole = test::count(draw(scene), clay);
  EXPECT_LT(half, 0.85 * whole);
  EXPECT_GT(half, 0.4 * whole);
}

// Where a scene's subject is: pixels that change when it goes.
std::vector<bool> silhouette(Renderer& renderer, const Scene& scene) {
  Scene empty = scene;
  for (Drawable& d : empty.drawables)
    if (d.material.kind != Material::Kind::ground) d.mesh.triangles.clear();
  const Pixels with = renderer.render(scene, 160, 120), without = renderer.render(empty, 160, 120);
  std::vector<bool> changed;
  for (int y = 0; y < with.height; ++y)
    for (int x = 0; x < with.width; ++x) {
      const auto a = test::rgbAt(with, x, y), b = test::rgbAt(without, x, y);
      // In colour: shadows are grey.
      changed.push_back(std::abs((a[0] - a[2]) - (b[0] - b[2])) > 24);
    }
  return changed;
}

TEST(FastLook, DrawsTheSameSilhouette) {
  FASCIA_REQUIRE_GL();
  Renderer full, fast(Look::fast);
  using Kind = Material::Kind;
  for (const Kind kind : {Kind::skin, Kind::muscle, Kind::plain}) {
    const Scene scene = still(kind);
    const std::vector<bool> a = silhouette(full, scene), b = silhouette(fast, scene);
    const auto size = std::count(a.begin(), a.end(), true);
    EXPECT_GT(size, 2000);
    int off = 0;
    for (std::size_t i = 0; i < a.size(); ++i) off += a[i] != b[i] ? 1 : 0;
    EXPECT_LT(off, size / 25);
  }
}

// Against a picture four times as large, made smaller.
TEST(FastLook, HasSmoothOutlines) {
  FASCIA_REQUIRE_GL();
  Renderer fast(Look::fast);
  const Scene scene = still();
  const Pixels picture = fast.render(scene, 320, 240), large = fast.render(scene, 1280, 960);
  Scene empty = scene;
  for (Drawable& d : empty.drawables)
    if (d.material.kind != Material::Kind::ground) d.mesh.triangles.clear();
  const Pixels floor = fast.render(empty, 320, 240);
  int outline = 0, off = 0;
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) {
      // In blue and red: how much of a pixel is clay, not grey.
      double clay = 0;
      for (int k = 0; k < 16; ++k) {
        const auto c = test::rgbAt(large, 4 * x + k % 4, 4 * y + k / 4);
        clay += (c[0] - c[2]) / 16.0;
      }
      const auto c = test::rgbAt(picture, x, y), f = test::rgbAt(floor, x, y);
      const bool between = clay > f[0] - f[2] + 25 && clay < 70;
      outline += between ? 1 : 0;
      off += between && std::abs(c[0] - c[2] - clay) > 30 ? 1 : 0;
    }
  EXPECT_GT(outline, 150);
  EXPECT_LT(off, outline / 5);
}

TEST(FastLook, HasAShadowOnTheFloor) {
  FASCIA_REQUIRE_GL();
  Renderer fast(Look::fast);
  Scene scene = still(Material::Kind::plain, "az=0,el=25");
  const Pixels with = fast.render(scene, 160, 120);
  Scene floor = scene;
  floor.drawables.erase(floor.drawables.begin(), floor.drawables.end() - 1);
  const Vec3 light = scene.studio.key.direction;
  const Vec3 shadow = Vec3(0, 0.5, 0) - light * (0.5 / light.y());
  const auto at = test::pixelOf(scene, shadow, 160, 120);
  const Pixels without = fast.render(floor, 160, 120);
  EXPECT_LT(test::sumAt(with, at[0], at[1]), 0.85 * test::sumAt(without, at[0], at[1]));
}

TEST(FastLook, GivesTheSameBytesAgain) {
  FASCIA_REQUIRE_GL();
  Renderer fast(Look::fast), other(Look::fast);
  const Scene scene = still(Material::Kind::skin);
  const Pixels first = fast.render(scene, 160, 120);
  EXPECT_EQ(fast.render(scene, 160, 120).rgba, first.rgba);
  EXPECT_EQ(other.render(scene, 160, 120).rgba, first.rgba);
}

}  // namespace
}  // namespace fascia
