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

// Where a cloud of points falls in the picture, in [-1, 1] if all of it is in view.
Box seenBy(const Camera& camera, std::span<const Vec3> points, double aspect) {
  const Eigen::Matrix4f clip = clipFromView(camera, aspect, 0.01, 1000) * viewFromWorld(camera);
  Box seen;
  for (const Vec3& p : points) {
    const Eigen::Vector4f c = clip * p.homogeneous().cast<float>();
    EXPECT_GT(c.w(), 0);
    seen.add(Vec3(c.x() / c.w(), c.y() / c.w(), 0));
  }
  return seen;
}

// An arc that fills little of its box.
std::vector<Vec3> arc() {
  std::vector<Vec3> points;
  for (int i = 0; i <= 200; ++i) {
    const double a = kPi * i / 200;
    points.emplace_back(2 * std::cos(a), 1 + 2 * std::sin(a), std::cos(3 * a));
  }
  return points;
}

TEST(Reach, FillsThePictureFromEverySide) {
  const std::vector<Vec3> points = arc();
  Reach reach;
  for (const Vec3& p : points) reach.add(p);
  for (const char* view : {"front", "side", "three-quarter", "back", "top", "az=200,el=-40"})
    for (const double aspect : {0.5, 1.0, 2.0}) {
      const Camera camera = frameReach(parseCamera(view), reach, aspect);
      const Box seen = seenBy(camera, points, aspect);
      const double widest = std::max(seen.high.x(), seen.high.y());
      EXPECT_LT(widest, 1) << view;
      EXPECT_GT(widest, 0.9) << view;
      EXPECT_NEAR(seen.center().x(), 0, 0.02) << view;
      EXPECT_NEAR(seen.center().y(), 0, 0.02) << view;
    }
}

TEST(Reach, IsTighterThanItsBox) {
  Reach reach;
  for (const Vec3& p : arc()) reach.add(p);
  const CameraSpec spec = parseCamera("three-quarter");
  const Camera tight = frameReach(spec, reach, 1), loose = frameBox(spec, reach.box(), 1);
  EXPECT_LT((tight.eye_m - tight.target_m).norm(), 0.95 * (loose.eye_m - loose.target_m).norm());
}

TEST(Reach, OfABoxIsTheBox) {
  const Box box{Vec3(-1, 0, 2), Vec3(3, 1, 5)};
  Reach reach;
  reach.add(box);
  reach.add(Vec3(std::nan(""), 0, 0));
  EXPECT_EQ(reach.box().low, box.low);
  EXPECT_EQ(reach.box().high, box.high);
  EXPECT_TRUE(Reach().empty());
  EXPECT_TRUE(Reach().extremes().empty());
}

}  // namespace
}  // namespace fascia
