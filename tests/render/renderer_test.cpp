#include <gtest/gtest.h>

#include <limits>

#include "pictures.h"

namespace fascia {
namespace {

using test::count;
using test::draw;
using test::framed;
using test::pixelOf;
using test::rgbAt;
using test::sphere;
using test::sumAt;

const Rgb kRed(0.9f, 0.1f, 0.1f), kGreen(0.1f, 0.8f, 0.1f), kGrey(0.5f, 0.5f, 0.5f);

bool isRed(int r, int g, int b) {
  return r > g + 60 && r > b + 60;
}
bool isGreen(int r, int g, int b) {
  return g > r + 60 && g > b + 60;
}

TEST(Renderer, ShowsASphereBeforeTheBackground) {
  FASCIA_REQUIRE_GL();
  const Pixels picture = draw(framed({sphere({0, 0, 0}, 1, kRed)}));
  EXPECT_TRUE(
      isRed(rgbAt(picture, 80, 60)[0], rgbAt(picture, 80, 60)[1], rgbAt(picture, 80, 60)[2]));
  EXPECT_FALSE(isRed(rgbAt(picture, 2, 60)[0], rgbAt(picture, 2, 60)[1], rgbAt(picture, 2, 60)[2]));
  const int red = count(picture, isRed);
  EXPECT_GT(red, 160 * 120 / 6);
  EXPECT_LT(red, 160 * 120 * 2 / 3);
}

TEST(Renderer, GivesTheSameBytesAgainAndInAnotherRenderer) {
  FASCIA_REQUIRE_GL();
  Scene scene = framed({sphere({0, 0.5f, 0}, 0.5f, kRed, Material::Kind::skin)});
  scene.drawables.push_back(groundDisc(worldBounds(scene)));
  const Pixels first = draw(scene), second = draw(scene);
  EXPECT_EQ(first.rgba, second.rgba);
  Renderer other;
  EXPECT_EQ(other.render(scene, 160, 120).rgba, first.rgba);
}

TEST(Renderer, MovedPointsLookAsInAFreshRenderer) {
  FASCIA_REQUIRE_GL();
  Scene scene = framed({sphere({0, 0, 0}, 1, kRed, Material::Kind::skin)});
  const Pixels before = draw(scene);
  for (auto& p : scene.drawables[0].mesh.positions) p.x() *= 0.6f;
  scene.drawables[0].mesh.normals.clear();
  const Pixels after = draw(scene);
  EXPECT_GT(test::differing(before, after), 500);
  Renderer fresh;
  EXPECT_EQ(fresh.render(scene, 160, 120).rgba, after.rgba);
}

TEST(Renderer, TextureCoordinatesStartAtTheTopLeft) {
  FASCIA_REQUIRE_GL();
  Drawable quad;
  quad.mesh.positions = {{-1, 1, 0}, {1, 1, 0}, {1, -1, 0}, {-1, -1, 0}};
  quad.mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  quad.mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  auto texture = std::make_shared<Pixels>();
  texture->width = texture->height = 64;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const auto on = [](bool yes) { return static_cast<std::uint8_t>(yes ? 220 : 20); };
      const std::uint8_t texel[] = {on(x < 32), on(x >= 32), on(y >= 32), 255};
      texture->rgba.insert(texture->rgba.end(), texel, texel + 4);
    }
  quad.material.color = Rgb::Ones();
  quad.material.texture = texture;
  const Pixels picture = draw(framed({quad}, "az=0,el=0"));
  const auto topLeft = rgbAt(picture, 55, 35), topRight = rgbAt(picture, 105, 35);
  const auto bottomLeft = rgbAt(picture, 55, 85);
  EXPECT_GT(topLeft[0], topLeft[1] + 60);
  EXPECT_GT(topRight[1], topRight[0] + 60);
  EXPECT_GT(bottomLeft[2], topLeft[2] + 60);
}

TEST(Renderer, ViewsSeeTheirSideOfTheCharacter) {
  FASCIA_REQUIRE_GL();
  // A grey head, red in front (+z), green at its left (+x).
  const std::vector<Drawable> head{sphere({0, 0, 0}, 1, kGrey), sphere({0, 0, 0.9f}, 0.4f, kRed),
                                   sphere({0.9f, 0, 0}, 0.4f, kGreen)};
  struct View {
    const char* camera;
    int red, green;  // which is seen full on
  };
  for (const View& view : {View{"front", 1, 0}, View{"side", 0, 1}, View{"back", 0, 0}}) {
    const Pixels picture = draw(framed(head, view.camera));
    const auto middle = rgbAt(picture, 80, 60);
    EXPECT_EQ(isRed(middle[0], middle[1], middle[2]), view.red == 1) << view.camera;
    EXPECT_EQ(isGreen(middle[0], middle[1], middle[2]), view.green == 1) << view.camera;
  }
  // Seen from the front, the character's left is at the right of the picture.
  const Pixels front = draw(framed(head, "front"));
  const auto c = pixelOf(framed(head, "front"), {1.15, 0, 0.2}, 160, 120);
  EXPECT_GT(c[0], 80);
  EXPECT_TRUE(isGreen(rgbAt(front, c[0], c[1])[0], rgbAt(front, c[0], c[1])[1],
                      rgbAt(front, c[0], c[1])[2]));
}

TEST(Renderer, ShadowDarkensTheGroundAwayFromTheKeyLight) {
  FASCIA_REQUIRE_GL();
  Scene lit = framed({sphere({0, 1.2f, 0}, 0.5f, kGrey), sphere({0, 0, 2}, 0.02f, kGrey)}, "el=30");
  lit.drawables.push_back(groundDisc(worldBounds(lit), 0));
  Scene empty = lit;
  empty.drawables[0].material.kind = Material::Kind::ground;  // keeps the framing, casts nothing
  empty.drawables[0].mesh.triangles.clear();
  const Vec3 light = lit.studio.key.direction;
  const Vec3 shadow = Vec3(0, 1.2, 0) - light * (1.2 / light.y());
  const auto at = pixelOf(lit, shadow, 160, 120);
  const Pixels withSphere = draw(lit), without = draw(empty);
  ASSERT_GT(sumAt(without, at[0], at[1]), 300);
  EXPECT_LT(sumAt(withSphere, at[0], at[1]), 0.85 * sumAt(without, at[0], at[1]));
  const auto opposite = pixelOf(lit, Vec3(-shadow.x(), 0, -shadow.z()), 160, 120);
  EXPECT_NEAR(sumAt(withSphere, opposite[0], opposite[1]), sumAt(without, opposite[0], opposite[1]),
              24);
}

TEST(Renderer, SkinGlowsRedWhereTheLightEnds) {
  FASCIA_REQUIRE_GL();
  Scene scene = framed({sphere({0, 0, 0}, 0.1f, {0.86f, 0.66f, 0.56f}, Material::Kind::skin)});
  scene.studio.key.direction = Vec3(1, 0, 0);
  scene.drawables[0].material.translucency = 0;  // scattering around, not through
  const auto redness = [&](float scatter_m) {
    scene.drawables[0].material.scatter_m = scatter_m;
    const Pixels picture = draw(scene);
    const auto c = rgbAt(picture, 77, 60);  // just behind the terminator
    return static_cast<double>(c[0]) / (c[2] + 1);
  };
  EXPECT_GT(redness(0.05f), 1.08 * redness(0));
}

TEST(Renderer, SmoothDarkEyesHaveAHighlight) {
  FASCIA_REQUIRE_GL();
  const auto bright = [](float roughness) {
    Drawable eye = sphere({0, 0, 0}, 1, {0.03f, 0.03f, 0.03f});
    eye.material.roughness = roughness;
    const Pixels picture = draw(framed({eye}));
    int n = 0;
    for (int y = 30; y < 90; ++y)
      for (int x = 50; x < 110; ++x) n += sumAt(picture, x, y) > 500 ? 1 : 0;
    return n;
  };
  EXPECT_GT(bright(0.06f), 10);
  EXPECT_LT(bright(0.06f), 600);
  EXPECT_EQ(bright(0.9f), 0);
}

TEST(Renderer, SeeThroughSkinShowsWhatIsInsideAndItsOwnOutline) {
  FASCIA_REQUIRE_GL();
  Drawable skin = sphere({0, 0, 0}, 1, {0.86f, 0.66f, 0.56f}, Material::Kind::skin);
  skin.material.opacity = 0.25f;
  const Drawable inside = sphere({0, 0, 0}, 0.5f, kGreen);
  const Pixels both = draw(framed({inside, skin}));
  const auto middle = rgbAt(both, 80, 60);
  EXPECT_GT(middle[1], middle[0]);
  Scene bare = framed({inside, skin});
  bare.drawables.pop_back();
  const Pixels nothing = draw(bare);
  // Outside the inner sphere only the veil differs, most of all near its rim.
  const auto change = [&](double x) {
    const auto at = pixelOf(bare, {x, 0, 0}, 160, 120);
    const auto c = rgbAt(both, at[0], at[1]), d = rgbAt(nothing, at[0], at[1]);
    return std::abs(c[0] - d[0]) + std::abs(c[1] - d[1]) + std::abs(c[2] - d[2]);
  };
  EXPECT_GT(change(-0.96), 40);
  EXPECT_GT(change(-0.96), change(-0.75));
}

TEST(Renderer, XrayBonesShowThroughFlesh) {
  FASCIA_REQUIRE_GL();
  Drawable bone = sphere({0, 0, 0}, 0.4f, {0.93f, 0.89f, 0.79f}, Material::Kind::bone);
  const Drawable flesh = sphere({0, 0, 0}, 1, {0.72f, 0.28f, 0.26f}, Material::Kind::muscle);
  const Pixels hidden = draw(framed({bone, flesh}));
  EXPECT_EQ(test::differing(hidden, draw(framed({flesh}))), 0);
  bone.material.xray = 0.6f;
  const Pixels seen = draw(framed({bone, flesh}));
  EXPECT_GT(sumAt(seen, 80, 60), sumAt(hidden, 80, 60) + 60);
}

TEST(Renderer, OddSizesAreFilledWholly) {
  FASCIA_REQUIRE_GL();
  Scene scene = framed({sphere({0, 0, 0}, 1, kRed)});
  scene.drawables.push_back(groundDisc(worldBounds(scene)));
  for (const auto& [width, height] : {std::pair{1, 1}, {333, 77}, {2, 301}, {900, 601}}) {
    const Pixels picture = draw(scene, width, height);
    EXPECT_EQ(picture.width, width);
    EXPECT_EQ(picture.height, height);
    ASSERT_EQ(picture.rgba.size(), static_cast<std::size_t>(width * height * 4));
    EXPECT_EQ(count(picture, [](int r, int g, int b) { return r + g + b == 0; }), 0);
    for (std::size_t i = 3; i < picture.rgba.size(); i += 4) ASSERT_EQ(picture.rgba[i], 255);
  }
}

TEST(Renderer, AbsurdSizesAreRefused) {
  FASCIA_REQUIRE_GL();
  const Scene scene = framed({sphere({0, 0, 0}, 1, kRed)});
  for (const auto& [width, height] :
       {std::pair{0, 10}, {10, 0}, {-5, 10}, {100000, 1}, {8192, 8192}, {2147483647, 2147483647}})
    EXPECT_THROW(draw(scene, width, height), Error) << width << "x" << height;
}

TEST(Renderer, BrokenScenesAreRefusedAndLeaveItUsable) {
  FASCIA_REQUIRE_GL();
  const Scene good = framed({sphere({0, 0, 0}, 1, kRed)});
  const Pixels expected = draw(good);
  Scene scene = good;
  scene.drawables[0].mesh.triangles.push_back({0, 1, 1'000'000});
  EXPECT_THROW(draw(scene), Error);
  scene = good;
  scene.drawables[0].mesh.normals.pop_back();
  EXPECT_THROW(draw(scene), Error);
  scene = good;
  scene.drawables[0].material.texture = std::make_shared<Pixels>(Pixels{7, 7, {1, 2, 3}});
  EXPECT_THROW(draw(scene), Error);
  scene = good;
  scene.camera.eye_m.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(draw(scene), Error);
  scene.camera.eye_m = scene.camera.target_m;
  EXPECT_THROW(draw(scene), Error);
  EXPECT_EQ(draw(good).rgba, expected.rgba);
}

TEST(Renderer, PointsThatAreNotNumbersSpoilOnlyTheirTriangles) {
  FASCIA_REQUIRE_GL();
  Scene scene = framed({sphere({0, 0, 0}, 1, kRed)});
  const Pixels whole = draw(scene);
  scene.drawables[0].mesh.positions[200].x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_LT(test::differing(draw(scene), whole), 160 * 120 / 8);
}

}  // namespace
}  // namespace fascia
