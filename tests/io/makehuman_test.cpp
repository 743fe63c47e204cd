#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include <fascia/base/error.h>
#include <fascia/io/motion/bvh.h>
#include <fascia/io/rig_import/makehuman/makehuman_import.h>
#include <fascia/io/rig_import/makehuman/makehuman_mesh.h>
#include <fascia/rig/retarget.h>

#include "support/assets.h"

namespace fascia {
namespace {

namespace fs = std::filesystem;

// A small "MakeHuman": a body of two quads, an eye, a skirt that is dropped, two joint cubes.
class SmallHuman : public testing::Test {
 protected:
  SmallHuman() {
    fs::create_directories(folder_ / "rigs");
    write("base.obj", mesh());
    write("rigs/rig.cmu_mb.json", rig());
    write("rigs/weights.cmu_mb.json", weights());
  }
  ~SmallHuman() override { fs::remove_all(folder_); }

  static std::string mesh() {
    return "v 0 -8 0\nv 1 -8 0\nv 1 0 0\nv 0 0 0\nv 1 8 0\nv 0 8 0\n"  // body
           "v 0 5 1\nv 1 5 1\nv 0 6 1\n"                               // eye
           "v 9 9 9\nv 9 9 8\nv 8 9 9\n"                               // skirt
           "v -1 -1 0\nv 1 1 0\n"                                      // one joint's cube
           "v 0 3 0\nv 0 5 0\n"                                        // another's
           "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
           "g body\nf 1/1 2/2 3/3 4/4\nf 4/1 3/2 5/3 6/4\n"
           "g helper-l-eye\nf 7 8 9\ng helper-skirt\nf 10 11 12\n"
           "g joint-low\nf 13 14 13\ng joint-high\nf 15 16 15\n";
  }
  static std::string rig() {
    return R"({"Spine": {"parent": "Hips",
                 "head": {"strategy": "CUBE", "cube_name": "joint-high"},
                 "tail": {"strategy": "VERTEX", "vertex_index": 5}, "roll": 0},
               "Hips": {"parent": "",
                 "head": {"strategy": "CUBE", "cube_name": "joint-low"},
                 "tail": {"strategy": "MEAN", "vertex_indices": [2, 3]}, "roll": 0.5}})";
  }
  static std::string weights() {
    return R"({"weights": {"Hips": [[0, 1], [1, 1], [2, 0.5], [3, 0.5]],
               "Spine": [[2, 0.5], [3, 1.5], [4, 1], [5, 1], [6, 1], [7, 1], [8, 1]]}})";
  }
  void write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string errorOf(const std::string& name) {
    try {
      readMakeHuman(path(name));
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

  fs::path folder_ = fs::path(testing::TempDir()) /
                     (std::string("fascia_human_") +
                      testing::UnitTest::GetInstance()->current_test_info()->name());
};

// A root without a name would be its own child.
TEST_F(SmallHuman, ABoneWithoutANameIsRefused) {
  std::string rig = SmallHuman::rig();
  rig.replace(rig.find("\"Hips\""), 6, "\"\"");
  rig.replace(rig.find("\"Hips\""), 6, "\"\"");
  write("rigs/rig.cmu_mb.json", rig);
  EXPECT_THAT(errorOf("base.obj"), testing::HasSubstr("rig.cmu_mb.json:"));
  EXPECT_THAT(errorOf("base.obj"), testing::HasSubstr("a bone without a name"));
}

TEST_F(SmallHuman, WeightsAreAFileBesideTheRig) {
  for (const char* name : {"..", ".", "", "../weights", "a/b"}) {
    write("default.mhskel", R"({"joints": {"low": [0], "high": [5]}, "weights_file": ")" +
                                std::string(name) +
                                R"(", "bones": {"Hips": {"head": "low", "tail": "high"}}})");
    EXPECT_THAT(errorOf("default.mhskel"), testing::HasSubstr("default.mhskel:1")) << name;
    EXPECT_THAT(errorOf("default.mhskel"), testing::HasSubstr("a file beside it")) << name;
  }
}

TEST_F(SmallHuman, KeepsBodyAndEyesInMetresOnTheFloor) {
  const RiggedModel model = readMakeHuman(path("base.obj"));
  ASSERT_EQ(model.parts.size(), 2u);
  EXPECT_EQ(model.parts[1].name, "left eye");
  EXPECT_EQ(model.points_m.size(), 9u);
  EXPECT_EQ(model.vertices.size(), 11u);  // two points of the body have two UVs
  EXPECT_EQ(model.triangles.size(), 5u);
  EXPECT_EQ(model.componentCount, 2u);
  EXPECT_NEAR(model.height_m(), 1.6, 1e-6);
  EXPECT_EQ(model.points_m[0], Eigen::Vector3f(0, 0, 0));
  EXPECT_EQ(model.vertices[0].uv, Eigen::Vector2f(0, 1));  // from the top
}

TEST_F(SmallHuman, PlacesJointsByCubesAndPointsParentsFirst) {
  const RiggedModel model = readMakeHuman(path("rigs/rig.cmu_mb.json"));
  ASSERT_EQ(model.joints.size(), 2u);
  EXPECT_EQ(model.joints[0].name, "Hips");
  EXPECT_EQ(model.joints[1].parent, 0);
  EXPECT_LT((model.joints[0].rest_world.translation_m - Vec3(0, 0.8, 0)).norm(), 1e-12);
  EXPECT_LT((model.joints[1].rest_world.translation_m - Vec3(0, 1.2, 0)).norm(), 1e-12);
  // y runs along the bone: from the low cube to the middle of points 2 and 3.
  EXPECT_LT((model.joints[0].rest_world.rotation.col(1) - Vec3::UnitX()).norm(), 1e-12);
  EXPECT_NEAR(model.joints[0].rest_world.rotation.determinant(), 1, 1e-12);
}

TEST_F(SmallHuman, NormalizesWeights) {
  const RiggedModel model = readMakeHuman(path("base.obj"));
  EXPECT_FLOAT_EQ(model.weights[3].weight[0], 0.75f);
  EXPECT_EQ(model.weights[3].joint[0], 1);
  EXPECT_FLOAT_EQ(model.weights[3].weight[1], 0.25f);
}

TEST_F(SmallHuman, TellsFaultsWithFileAndLine) {
  write("rigs/rig.cmu_mb.json", R"({"Hips": {"parent": "", "head": {"strategy": "CUBE",
      "cube_name": "joint-nowhere"}, "tail": {}}})");
  EXPECT_THAT(errorOf("base.obj"),
              testing::HasSubstr("rig.cmu_mb.json:2: the mesh has no group 'joint-nowhere'"));
  std::string loop = rig();
  loop.replace(loop.find(R"("parent": "")"), 12, R"("parent": "Spine")");
  write("rigs/rig.cmu_mb.json", loop);
  EXPECT_THAT(errorOf("base.obj"), testing::HasSubstr("found 0 bones without a parent"));
  write("rigs/rig.cmu_mb.json", rig());
  write("rigs/weights.cmu_mb.json", R"({"weights": {"Hips": [[99, 1]]}})");
  EXPECT_THAT(errorOf("base.obj"), testing::HasSubstr("expected the number of one of 16 points"));
  write("base.obj", "v 0 0 0\nf 1 2 3\n");
  EXPECT_THAT(errorOf("base.obj"), testing::HasSubstr("base.obj:2: found '2', expected an index"));
}

TEST_F(SmallHuman, IsToldFromOtherFiles) {
  EXPECT_TRUE(isMakeHuman(path("base.obj")));
  EXPECT_TRUE(isMakeHuman(path("rigs/rig.cmu_mb.json")));
  EXPECT_FALSE(isMakeHuman(path("rigs/weights.cmu_mb.json")));
  fs::remove_all(folder_ / "rigs");
  EXPECT_FALSE(isMakeHuman(path("base.obj")));
}

TEST(ObjMesh, SurvivesEveryTruncation) {
  const std::string text = "v 1 2 3\nv 0 0 0\nv 1 0 0\nvt 0 1\ng a b\nf 1/1 2//3 -1/1/2\n";
  EXPECT_EQ(parseObj(text, "a").groups[0].corners[2].position, 2u);
  for (std::size_t size = 0; size < text.size(); ++size) {
    try {
      parseObj(text.substr(0, size), "a");
    } catch (const Error&) {
    }
  }
}

TEST(MakeHuman, IsAWholePersonInEveryRig) {
  for (const char* name : {"rig.cmu_mb.json", "rig.game_engine.json", "default.mhskel"}) {
    const auto path = assetFile(std::string("makehuman-cc0/rigs/") + name);
    if (!path) GTEST_SKIP() << "the shared assets are not here";
    const RiggedModel model = readMakeHuman(path->string());
    EXPECT_EQ(model.points_m.size(), 13380u + 2 * 72 + 2 * 68 + 226) << name;
    EXPECT_EQ(model.componentCount, 6u);
    EXPECT_NEAR(model.height_m(), 1.67, 0.01);
    EXPECT_TRUE(model.notes.empty()) << model.notes[0];
    for (const PointWeights& w : model.weights) {
      float sum = 0;
      for (const float x : w.weight) sum += x;
      ASSERT_NEAR(sum, 1, 1e-5);
    }
  }
}

// The balls of the feet while the recorded ones stand: how fast they slide, and how far their
// heights lie apart, recorded and ours.
struct Feet {
  double slide_m_per_s = 0;
  double recordedSpread_m = 0, spread_m = 0;
};

std::size_t jointNamed(const std::vector<RigJoint>& joints, const std::string& name) {
  std::size_t j = 0;
  while (joints[j].name != name) ++j;
  return j;
}

Feet feetOf(const MotionFigure& figure, const RiggedModel& model, std::size_t skipped) {
  constexpr double kStanding_m_per_s = 0.12;
  Feet feet;
  Box recordedHeights, heights;
  int standing = 0;
  const double rate = figure.motion.rate_hz;
  for (const char* name : {"LeftToeBase", "RightToeBase"}) {
    const std::size_t source = jointNamed(figure.joints, name);
    const std::size_t target = jointNamed(model.joints, name);
    Vec3 recordedBefore = Vec3::Zero(), before = Vec3::Zero();
    std::vector<Transform> recordedWorld, world;
    for (std::size_t f = skipped; f < figure.motion.frameCount(); ++f) {
      poseFigure(figure, f, recordedWorld);
      poseRig(model, 0, static_cast<double>(f - skipped) / rate, world);
      const Vec3 here = world[target].translation_m;
      const Vec3 recorded = recordedWorld[source].translation_m;
      if (f > skipped && (recorded - recordedBefore).norm() * rate < kStanding_m_per_s) {
        feet.slide_m_per_s += (here - before).norm() * rate;
        recordedHeights.add(recorded);
        heights.add(here);
        ++standing;
      }
      recordedBefore = recorded, before = here;
    }
  }
  EXPECT_GT(standing, 100);
  feet.slide_m_per_s /= standing;
  feet.recordedSpread_m = recordedHeights.size().y();
  feet.spread_m = heights.size().y();
  return feet;
}

TEST(MakeHuman, WalksAsCapturedWithFeetThatStand) {
  const auto rig = assetFile("makehuman-cc0/rigs/rig.cmu_mb.json");
  const auto walk = assetFile("cmu-mocap/12_01_walk.bvh");
  if (!rig || !walk) GTEST_SKIP() << "the shared assets are not here";
  RiggedModel model = readMakeHuman(rig->string());
  const BvhMotion captured = readBvh(walk->string());
  const MotionFigure figure = figureOf(captured, guessBvhUnit_m(captured));
  const JointMap map = guessJointMap(figure.joints, model.joints);
  EXPECT_EQ(map.size(), model.joints.size());

  RetargetOptions options;
  options.plantFeet = false;
  model.motions = {retarget(figure, model, map, options)};
  const Feet before = feetOf(figure, model, 1);
  options.plantFeet = true;
  model.motions = {retarget(figure, model, map, options)};
  const Feet after = feetOf(figure, model, 1);
  RecordProperty("slide_before_mm_per_s", std::to_string(1000 * before.slide_m_per_s));
  RecordProperty("slide_after_mm_per_s", std::to_string(1000 * after.slide_m_per_s));
  EXPECT_LT(after.slide_m_per_s, 0.6 * before.slide_m_per_s);
  // Up to what a leg that is stretched to its end cannot reach.
  EXPECT_LT(after.spread_m, 1.05 * after.recordedSpread_m + 0.004);

  // It walks upright: the head stays above the hips, and the hips travel forward.
  std::vector<Transform> first, last;
  poseRig(model, 0, 0, first);
  poseRig(model, 0, model.motions[0].duration_s(), last);
  EXPECT_GT((last[0].translation_m - first[0].translation_m).z(), 3);
  EXPECT_GT(first[0].translation_m.y(), 0.8);
}

}  // namespace
}  // namespace fascia
