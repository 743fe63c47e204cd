#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include <zlib.h>

#include <fascia/base/error.h>
#include <fascia/io/file/gzip.h>
#include <fascia/io/motion/bvh.h>
#include <fascia/io/motion/joint_map_file.h>
#include <fascia/rig/retarget.h>

#include "support/assets.h"
#include "support/replaced.h"

namespace fascia {
namespace {

using test::replaced;

const std::string kArm = R"(HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Left Arm {
    OFFSET 1 2 3
    CHANNELS 2 Yrotation Xrotation
    End Site
    {
      OFFSET 0 4 0
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.05
1 2 3 30 0 0 90 0
4 5 6 0 0 0 +30 60
)";

std::string parseErrorOf(const std::string& text) {
  try {
    parseBvh(text, "a.bvh");
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Bvh, ReadsJointsChannelsAndFrames) {
  const BvhMotion motion = parseBvh(kArm, "a.bvh");
  ASSERT_EQ(motion.joints.size(), 2u);
  EXPECT_EQ(motion.joints[1].name, "Left Arm");
  EXPECT_EQ(motion.joints[1].parent, 0);
  EXPECT_EQ(motion.joints[1].offset, Vec3(1, 2, 3));
  EXPECT_EQ(motion.joints[1].endSite, Vec3(0, 4, 0));
  EXPECT_EQ(motion.joints[1].firstChannel, 6u);
  EXPECT_THAT(motion.joints[1].channels,
              testing::ElementsAre(BvhChannel::yRotation, BvhChannel::xRotation));
  EXPECT_EQ(motion.frameCount(), 2u);
  EXPECT_DOUBLE_EQ(motion.frameTime_s, 0.05);
  EXPECT_FLOAT_EQ(motion.values[14], 30);
}

TEST(Bvh, TurnsInTheOrderOfTheChannels) {
  const MotionFigure figure = figureOf(parseBvh(kArm, "a.bvh"), 0.01);
  EXPECT_DOUBLE_EQ(figure.motion.rate_hz, 20);
  const auto about = [](const Vec3& axis, double angle) {
    return Quat(Eigen::AngleAxisd(radians(angle), axis));
  };
  const Quat expected = about(Vec3::UnitY(), 30) * about(Vec3::UnitX(), 60);
  EXPECT_LT(figure.motion.rotation[3].cast<double>().angularDistance(expected), 1e-6);
  EXPECT_TRUE(figure.motion.translation_m[2].isApprox(Eigen::Vector3f(0.04f, 0.05f, 0.06f)));
  std::vector<Transform> world;
  poseFigure(figure, 0, world);
  const Vec3 arm = Vec3(1, 2, 3) + about(Vec3::UnitZ(), 30) * Vec3(1, 2, 3);
  EXPECT_LT((world[1].translation_m - 0.01 * arm).norm(), 1e-7);
}

TEST(Bvh, AcceptsOtherLineEndsCasesAndTightBraces) {
  std::string text = kArm;
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) {
    text.replace(at, 1, "\r\n");
  }
  text = replaced(replaced(text, "HIERARCHY", "Hierarchy"), "Zrotation", "ZROTATION");
  EXPECT_EQ(parseBvh(text, "a.bvh").values, parseBvh(kArm, "a.bvh").values);
}

TEST(Bvh, SaysWhereWhatWasFoundAndExpected) {
  EXPECT_EQ(parseErrorOf(""), "a.bvh:1: the file ends, expected HIERARCHY");
  EXPECT_EQ(parseErrorOf("glTF"), "a.bvh:1: found 'glTF', expected HIERARCHY");
  EXPECT_EQ(parseErrorOf(replaced(kArm, "2 Y", "2 W")),
            "a.bvh:8: found 'Wrotation', expected Xposition, Yposition, Zposition, Xrotation, "
            "Yrotation or Zrotation");
  EXPECT_EQ(parseErrorOf(replaced(kArm, "2 Yrotation", "2 Xrotation")),
            "a.bvh:8: found 'Xrotation' twice in 'Left Arm'");
  EXPECT_EQ(parseErrorOf(replaced(kArm, "1 2 3\n", "1 2 nan\n")),
            "a.bvh:7: found 'nan', expected a length");
  EXPECT_EQ(parseErrorOf(replaced(kArm, "0.05", "0")),
            "a.bvh:17: found a frame time of 0, expected seconds in (0, 1000]");
  EXPECT_EQ(parseErrorOf(replaced(kArm, "+30 60", "+30")),
            "a.bvh:20: the last frame has 7 values, expected 8");
  EXPECT_EQ(parseErrorOf(replaced(kArm, "+30", "1e99")),
            "a.bvh:19: found '1e99', expected a number");
  EXPECT_EQ(parseErrorOf(replaced(kArm, "MOTION", "ROOT b { }\nMOTION")),
            "a.bvh:15: found a second ROOT, expected MOTION (keep one figure in the file)");
}

TEST(Bvh, MendsDoubleNamesAndWrongCountsAndSaysSo) {
  const BvhMotion motion =
      parseBvh(replaced(replaced(kArm, "Left Arm", "Hips"), "Frames: 2", "Frames: 7"), "a.bvh");
  EXPECT_EQ(motion.joints[1].name, "Hips_2");
  EXPECT_EQ(motion.frameCount(), 2u);
  EXPECT_THAT(motion.notes,
              testing::ElementsAre("two joints are called 'Hips': one is now 'Hips_2'",
                                   "the file says 7 frames and holds 2"));
}

TEST(Bvh, SurvivesEveryTruncationAndDeepNesting) {
  for (std::size_t size = 0; size < kArm.size(); ++size) parseErrorOf(kArm.substr(0, size));
  std::string deep = "HIERARCHY ROOT a\n{\n";
  for (int k = 0; k < 100000; ++k) deep += "JOINT b\n{\n";
  EXPECT_THAT(parseErrorOf(deep), testing::HasSubstr("more than 4096 joints"));
  EXPECT_THAT(parseErrorOf(replaced(kArm, "Frames: 2", "Frames: 18446744073709551615")),
              "no error");
}

TEST(Bvh, GuessesTheUnitFromAPersonsHeight) {
  const auto unitOf = [](double height) {
    BvhMotion motion;
    motion.joints.resize(2);
    motion.joints[1].parent = 0;
    motion.joints[1].offset = {0, height, 0};
    return guessBvhUnit_m(motion);
  };
  EXPECT_DOUBLE_EQ(unitOf(1.8), 1);
  EXPECT_DOUBLE_EQ(unitOf(17), 0.1);
  EXPECT_DOUBLE_EQ(unitOf(165), 0.01);
  EXPECT_DOUBLE_EQ(unitOf(1750), 0.001);
  EXPECT_DOUBLE_EQ(unitOf(68), 0.0254);
}

TEST(Bvh, AddsPositionsToOffsetsWhereTheyAreSmall) {
  // Programs disagree; here the root's position replaces and the other's, near zero, is added.
  const std::string text =
      "HIERARCHY\nROOT a\n{\nOFFSET 0 9 0\nCHANNELS 3 Xposition Yposition Zposition\nJOINT b\n{\n"
      "OFFSET 0 2 0\nCHANNELS 3 Xposition Yposition Zposition\n}\n}\nMOTION\nFrames: 2\n"
      "Frame Time: 0.1\n0 5 0 0 POS 0\n0 6 0 0 POS 0\n";
  const auto bPlace = [&](const std::string& value) {
    const MotionFigure figure =
        figureOf(parseBvh(replaced(replaced(text, "POS", value), "POS", value), "b.bvh"), 1);
    EXPECT_FLOAT_EQ(figure.motion.translation_m[0].y(), 5);
    return figure.motion.translation_m[1].y();
  };
  EXPECT_FLOAT_EQ(bPlace("0.1"), 2.1f);
  EXPECT_FLOAT_EQ(bPlace("2.1"), 2.1f);
}

std::string packed(const std::string& text) {
  const std::string path = testing::TempDir() + "fascia_packed.bvh.gz";
  gzFile file = gzopen(path.c_str(), "wb");
  gzwrite(file, text.data(), static_cast<unsigned>(text.size()));
  gzclose(file);
  return path;
}

TEST(Gzip, UnpacksAndRefusesWhatIsDamagedOrTooLarge) {
  const std::string path = packed(kArm);
  EXPECT_EQ(readFileUnpacked(path, 1 << 20), kArm);
  EXPECT_EQ(readBvh(path).name, "fascia_packed");
  EXPECT_THROW(readFileUnpacked(path, kArm.size() - 1), Error);
  std::string bytes;
  {
    std::ifstream in(path, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
  }
  for (std::size_t size = 2; size < bytes.size(); ++size) {
    std::ofstream(path, std::ios::binary) << bytes.substr(0, size);
    EXPECT_THROW(readFileUnpacked(path, 1 << 20), Error) << size;
  }
}

TEST(JointMapFile, IsJsonOrLines) {
  const JointMap json = jointMapOf("\n{\"Left Arm\": \"arm.L\", \"Head\": null}", "m.json");
  const JointMap lines = jointMapOf("Left Arm = arm.L\nHead =\n", "m.txt");
  ASSERT_EQ(json.size(), 2u);
  for (std::size_t i = 0; i < json.size(); ++i) {
    EXPECT_EQ(json[i].source, lines[i].source);
    EXPECT_EQ(json[i].target, lines[i].target);
  }
  try {
    jointMapOf("{\"Head\":\n 3}", "m.json");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "m.json:2: /Head: expected the name of a joint, or null");
  }
  EXPECT_THROW(jointMapOf("{\"Head\"", "m.json"), Error);
}

TEST(Bvh, ReadsCapturesPlainAndPacked) {
  const auto walk = assetFile("cmu-mocap/12_01_walk.bvh");
  const auto jump = assetFile("cmu-mocap/01_01.bvh.gz");
  if (!walk || !jump) GTEST_SKIP() << "the shared assets are not here";
  for (const auto& path : {*walk, *jump}) {
    const BvhMotion motion = readBvh(path.string());
    EXPECT_EQ(motion.joints.size(), 31u);
    EXPECT_GT(motion.frameCount(), 500u);
    EXPECT_NEAR(1 / motion.frameTime_s, 120, 0.01);
    std::string unit;
    guessBvhUnit_m(motion, &unit);
    EXPECT_EQ(unit, "CMU's inch/0.45");
    const MotionFigure figure = figureOf(motion, 1);
    for (const auto& r : figure.motion.rotation) ASSERT_NEAR(r.norm(), 1, 1e-5);
  }
}

}  // namespace
}  // namespace fascia
