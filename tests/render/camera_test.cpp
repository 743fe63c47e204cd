#include <gtest/gtest.h>

#include <fascia/base/error.h>
#include <fascia/base/random.h>
#include <fascia/render/camera.h>

namespace fascia {
namespace {

const Box kUnit{Vec3::Constant(-0.5), Vec3::Constant(0.5)};

std::size_t faults(std::string_view text) {
  try {
    parseCamera(text);
    return 0;
  } catch (const Error& error) {
    for (const Issue& issue : error.issues()) EXPECT_FALSE(issue.hint.empty());
    return error.issues().size();
  }
}

TEST(Camera, NamedViewsLookFromWhereTheirNamesSay) {
  EXPECT_GT(frameBox(parseCamera("front"), kUnit, 1).eye_m.z(), 1);
  EXPECT_NEAR(frameBox(parseCamera("front"), kUnit, 1).eye_m.x(), 0, 1e-9);
  EXPECT_GT(frameBox(parseCamera("side"), kUnit, 1).eye_m.x(), 1);
  EXPECT_LT(frameBox(parseCamera("back"), kUnit, 1).eye_m.z(), -1);
  EXPECT_GT(frameBox(parseCamera("top"), kUnit, 1).eye_m.y(), 1);
  const Vec3 quarter = frameBox(parseCamera("three-quarter"), kUnit, 1).eye_m;
  EXPECT_GT(quarter.x(), 0.5);
  EXPECT_GT(quarter.z(), 0.5);
}

TEST(Camera, FromAboveTheFrontPointsDownThePicture) {
  const Camera top = frameBox(parseCamera("top"), kUnit, 1);
  const Eigen::Vector4f front = viewFromWorld(top) * Eigen::Vector4f(0, 0, 1, 1);
  EXPECT_LT(front.y(), -0.5f);
  EXPECT_NEAR(front.x(), 0, 1e-5f);
}

TEST(Camera, SettingsAreReadAndCombineWithViews) {
  const CameraSpec turned = parseCamera("az=30,el=15");
  EXPECT_NEAR(turned.azimuth_rad, radians(30), 1e-12);
  EXPECT_NEAR(turned.elevation_rad, radians(15), 1e-12);
  const CameraSpec side = parseCamera("side, dist=4 ; fov=40");
  EXPECT_NEAR(side.azimuth_rad, radians(90), 1e-12);
  EXPECT_EQ(side.distance_m, 4);
  EXPECT_NEAR(side.vertical_fov_rad, radians(40), 1e-12);
  for (const char* text : {"eye=1,2,3;target=0,1,0", "eye=1,2,3,target=0,+1,0"}) {
    const CameraSpec spec = parseCamera(text);
    EXPECT_EQ(spec.eye_m, Vec3(1, 2, 3));
    EXPECT_EQ(spec.target_m, Vec3(0, 1, 0));
    EXPECT_EQ(frameBox(spec, kUnit, 2).eye_m, Vec3(1, 2, 3));
  }
}

TEST(Camera, EveryFaultIsReportedAtOnce) {
  EXPECT_EQ(faults("az=x,colour=1,nowhere"), 3u);
  for (const char* text : {"", "fov=0", "fov=180", "el=120", "eye=1,2", "eye=1,2,3,4",
                           "eye=nan,1,2", "eye=inf,1,2", "dist=-1", "az=1e999", "az=", "az=3x",
                           "=3", "front,", "eye=1,1,1;target=1,1,1", "eye=1e300,0,0"})
    EXPECT_EQ(faults(text), text == std::string_view("front,") ? 0u : 1u) << text;
}

TEST(Camera, FramedBoxFillsThePictureAndIsWhollyInside) {
  Random random(7);
  for (int trial = 0; trial < 200; ++trial) {
    Box box;
    for (int i = 0; i < 2; ++i)
      box.add(Vec3(random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)));
    CameraSpec spec;
    spec.azimuth_rad = random.uniform(-4, 4);
    spec.elevation_rad = random.uniform(-1.5, 1.57);
    const double aspect = random.uniform(0.3, 3);
    const Camera camera = frameBox(spec, box, aspect);
    const Eigen::Matrix4f m = clipFromView(camera, aspect, 0.01, 100) * viewFromWorld(camera);
    float farthest = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 p(corner & 1 ? box.high.x() : box.low.x(), corner & 2 ? box.high.y() : box.low.y(),
                   corner & 4 ? box.high.z() : box.low.z());
      const Eigen::Vector4f clip = m * p.homogeneous().cast<float>();
      ASSERT_GT(clip.w(), 0);
      farthest = std::max({farthest, std::abs(clip.x() / clip.w()), std::abs(clip.y() / clip.w())});
    }
    EXPECT_LE(farthest, 1);
    EXPECT_GE(farthest, 0.9f);
  }
}

TEST(Camera, EmptyBoxStillGivesACamera) {
  EXPECT_TRUE(frameBox(CameraSpec{}, Box{}, 1).eye_m.allFinite());
}

}  // namespace
}  // namespace fascia
