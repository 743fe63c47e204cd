#include <gtest/gtest.h>

#include <fascia/io/gltf/gltf_document.h>

#include "simulated_rig.h"

namespace fascia {
namespace {

using sample::animatedTube;
using sample::animationOf;
using sample::kBend;
using sample::simulate;
using sample::Simulated;
using sample::swaying;
using sample::write;

// A hundredth of what is missing without helpers: what is left when the fit stops.
constexpr double kFollowed_mm = 0.5;

TEST(RigAsBones, PlaysWhatHelpersCanSay) {
  const sample::Folder folder;
  const Simulated s = simulate(write(folder, animatedTube()), 0, 61, 60, swaying);
  const RigBakeReport plain = writeRigAsBones(s.clip(), {0, 4, 12}, folder / "plain.glb");
  EXPECT_GT(plain.error.max_mm, 50);
  const RigBakeReport report = writeRigAsBones(s.clip(), {2, 4, 60}, folder / "out.glb");
  EXPECT_GE(report.added, 1u);
  EXPECT_LT(report.error.max_mm, kFollowed_mm);
  EXPECT_LE(report.error.rms_mm, report.error.max_mm);
}

TEST(RigAsBones, OldMotionKeepsItsJointsChannels) {
  const sample::Folder folder;
  const Simulated s = simulate(write(folder, animatedTube()), 0, 61, 60, swaying);
  writeRigAsBones(s.clip(), {1, 4, 12}, folder / "out.glb");
  const GltfDocument document = GltfDocument::read(folder / "out.glb");
  ASSERT_EQ(document.root()["animations"].size(), 2u);
  const GltfPlace bend = animationOf(document, kBend);
  ASSERT_EQ(bend["channels"].size(), 3u);  // the joint's rotation, then the helper's two
  const GltfPlace first = bend["samplers"].at(0);
  EXPECT_EQ(document.floats(first["input"].index(1000), 1), sample::kTimes);
  EXPECT_EQ(document.floats(first["output"].index(1000), 4), sample::kTurns);
  const GltfPlace helper = bend["samplers"].at(1);
  EXPECT_FLOAT_EQ(document.floats(helper["input"].index(1000), 1).front(), 0.5f);
  EXPECT_EQ(animationOf(document, "hop")["channels"].size(), 1u);
}

TEST(RigAsBones, NewMotionIsWrittenWhole) {
  const sample::Folder folder;
  Simulated s = simulate(write(folder, animatedTube()), 0, 61, 60, swaying);
  s.motion = "from elsewhere";
  const RigBakeReport report = writeRigAsBones(s.clip(), {2, 4, 60}, folder / "out.glb");
  EXPECT_LT(report.error.max_mm, kFollowed_mm);
  const GltfDocument document = GltfDocument::read(folder / "out.glb");
  EXPECT_EQ(document.root()["animations"].size(), 3u);
}

// A piece of a motion can't keep the channels of all of it.
TEST(RigAsBones, CutMotionIsWrittenAnew) {
  const sample::Folder folder;
  Simulated s = simulate(write(folder, animatedTube()), 0, 61, 60, swaying);
  s.recording.frames.erase(s.recording.frames.begin(), s.recording.frames.begin() + 20);
  s.joints_world.erase(s.joints_world.begin(), s.joints_world.begin() + 20);
  const RigBakeReport report = writeRigAsBones(s.clip(), {2, 4, 60}, folder / "out.glb");
  EXPECT_LT(report.error.max_mm, kFollowed_mm);
  const GltfDocument document = GltfDocument::read(folder / "out.glb");
  EXPECT_EQ(document.root()["animations"].size(), 2u);
  const RiggedModel back = readRiggedModel(folder / "out.glb");
  EXPECT_NEAR(back.motions[0].duration_s(), 40.0 / 60, 1e-3);
}

TEST(RigAsBones, HelpersHangBelowTheRig) {
  const sample::Folder folder;
  const Simulated s = simulate(write(folder, animatedTube()), 0, 61, 60, swaying);
  writeRigAsBones(s.clip(), {1, 4, 12}, folder / "out.glb");
  const RiggedModel back = readRiggedModel(folder / "out.glb");
  ASSERT_EQ(back.joints.size(), 3u);
  EXPECT_EQ(back.joints[0].name, "lower");
  EXPECT_EQ(back.joints[1].name, "upper");
  EXPECT_EQ(back.joints[2].name, "fascia_helper_01");
  EXPECT_EQ(back.joints[2].parent, 1);  // what the top of the tube follows
  EXPECT_EQ(back.points_m.size(), s.model.points_m.size());
  for (std::size_t i = 0; i < back.points_m.size(); ++i) {
    EXPECT_LT((back.points_m[i] - s.model.points_m[i]).norm(), 1e-6f);
  }
}

TEST(RigAsBones, BakedFilesCanBeBakedAgain) {
  const sample::Folder folder;
  const Simulated s = simulate(write(folder, animatedTube()), 0, 61, 60, swaying);
  writeRigAsBones(s.clip(), {1, 4, 12}, folder / "once.glb");
  const Simulated again = simulate(folder / "once.glb", 1, 61, 60, swaying);
  EXPECT_EQ(again.motion, "hop");
  const RigBakeReport report = writeRigAsBones(again.clip(), {2, 4, 60}, folder / "twice.glb");
  EXPECT_LT(report.error.max_mm, kFollowed_mm);
  EXPECT_EQ(readRiggedModel(folder / "twice.glb").joints[3].name, "fascia_helper_02");
}

// A joint stretched along one axis: what turns below it would be sheared.
TEST(RigAsBones, StretchedJointsAreAvoided) {
  const sample::Folder folder;
  sample::TubeRig rig;
  rig.file.nodes =
      R"([{"name":"Armature","scale":[2,2,2],"children":[1,3]},)"
      R"({"name":"lower","children":[2]},{"name":"upper","translation":[0,1,0],"scale":[1,3,1]},)"
      R"({"name":"body","mesh":0,"skin":0}])";
  rig.inverseBinds = rig.file.add(
      std::vector<float>{0.5f, 0, 0, 0, 0, 0.5f,    0, 0, 0, 0, 0.5f, 0, 0, 0,        0, 1,
                         0.5f, 0, 0, 0, 0, 1 / 6.f, 0, 0, 0, 0, 0.5f, 0, 0, -1 / 3.f, 0, 1},
      16, "MAT4");
  rig.file.skins = rig.skinOf("[1,2]");
  rig.file.animations =
      "[" + rig.animation(kBend, 1, "rotation", sample::kTimes, sample::kTurns) + "]";
  const Simulated s = simulate(write(folder, rig), 0, 61, 60, swaying, 0.5);
  const RigBakeReport report = writeRigAsBones(s.clip(), {2, 4, 60}, folder / "out.glb");
  EXPECT_LT(report.error.max_mm, kFollowed_mm);
  const GltfDocument document = GltfDocument::read(folder / "out.glb");
  EXPECT_EQ(document.root()["nodes"].at(1)["children"].size(), 1 + report.added);
  EXPECT_FALSE(document.root()["nodes"].at(2)["children"]);
}

// Two nodes show one mesh in two places: each gets its own weights.
TEST(RigAsBones, SharedMeshesArePartedFirst) {
  const sample::Folder folder;
  sample::TubeRig rig = animatedTube();
  const int moved =
      rig.file.add(std::vector<float>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 0,  0, 1,
                                      1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, -1, 0, 1},
                   16, "MAT4");
  rig.file.nodes = R"([{"name":"Armature","children":[1,3,4]},{"name":"lower","children":[2]},)"
                   R"({"name":"upper","translation":[0,1,0]},{"name":"body","mesh":0,"skin":0},)"
                   R"({"name":"twin","mesh":0,"skin":1}])";
  rig.file.skins = rig.skinOf("[1,2]");
  rig.file.skins.back() = ',';
  rig.file.skins += R"({"joints":[1,2],"inverseBindMatrices":)" + std::to_string(moved) + "}]";
  const Simulated s = simulate(write(folder, rig), 0, 61, 60, swaying);
  ASSERT_EQ(s.model.parts.size(), 2u);
  const RigBakeReport report = writeRigAsBones(s.clip(), {4, 4, 60}, folder / "out.glb");
  EXPECT_LT(report.error.max_mm, kFollowed_mm);
  EXPECT_EQ(GltfDocument::read(folder / "out.glb").root()["meshes"].size(), 2u);
}

// A mesh that hung on a joint and is soft now.
TEST(RigAsBones, LooseMeshesGetASkinIfTheyAreSoft) {
  const sample::Folder folder;
  sample::TubeRig rig = animatedTube();
  rig.file.nodes =
      R"([{"name":"Armature","children":[1,3]},{"name":"lower","children":[2]},)"
      R"({"name":"upper","translation":[0,1,0],"children":[4]},)"
      R"({"name":"body","mesh":0,"skin":0},{"name":"hat","mesh":1,"translation":[0,1.5,0]}])";
  rig.file.meshes = "[" + rig.meshOf(rig.primitive()) + "," +
                    rig.meshOf(R"({"attributes":{"POSITION":)" + std::to_string(rig.positions) +
                               R"(},"indices":)" + std::to_string(rig.indices) + "}") +
                    "]";
  const std::string path = write(folder, rig);
  const auto rigidHat = [](const Eigen::Vector3f& p, double t) {
    return p.y() > 2.2f ? p : swaying(p, t);
  };
  const Simulated still = simulate(path, 0, 61, 60, rigidHat);
  writeRigAsBones(still.clip(), {3, 4, 60}, folder / "still.glb");
  EXPECT_FALSE(GltfDocument::read(folder / "still.glb").root()["nodes"].at(4)["skin"]);
  const Simulated soft = simulate(path, 0, 61, 60, swaying);
  const RigBakeReport report = writeRigAsBones(soft.clip(), {3, 4, 60}, folder / "soft.glb");
  EXPECT_LT(report.error.max_mm, kFollowed_mm);
  EXPECT_TRUE(GltfDocument::read(folder / "soft.glb").root()["nodes"].at(4)["skin"]);
}

// Two motions, one set of helpers: each in its own animation.
TEST(RigAsBones, SeveralMotionsShareTheirHelpers) {
  const sample::Folder folder;
  const std::string path = write(folder, animatedTube());
  const Simulated bend = simulate(path, 0, 61, 60, swaying),
                  hop = simulate(path, 1, 61, 60, swaying);
  const std::vector<RigClip> clips{{bend.model, bend.recording, bend.joints_world, bend.motion, 1},
                                   {bend.model, hop.recording, hop.joints_world, hop.motion, 1}};
  const RigBakeReport report = writeRigAsBones(clips, {2, 4, 60}, folder / "out.glb");
  EXPECT_LT(report.error.max_mm, kFollowed_mm);
  ASSERT_EQ(report.baked.size(), 2u);
  EXPECT_EQ(report.baked[1].name, "hop");
  EXPECT_TRUE(report.others.empty());
  const GltfDocument document = GltfDocument::read(folder / "out.glb");
  EXPECT_EQ(document.root()["animations"].size(), 2u);
  EXPECT_EQ(animationOf(document, kBend)["channels"].size(), 1 + 2 * report.added);
  EXPECT_EQ(animationOf(document, "hop")["channels"].size(), 1 + 2 * report.added);
}

TEST(RigAsBones, MotionsNotBakedStayAsTheyWere) {
  const sample::Folder folder;
  const Simulated s = simulate(write(folder, animatedTube()), 1, 61, 60, swaying);
  const RigBakeReport report = writeRigAsBones(s.clip(), {2, 4, 60}, folder / "out.glb");
  ASSERT_EQ(report.others.size(), 1u);
  EXPECT_EQ(report.others[0].name, kBend);
  EXPECT_LE(report.others[0].error.rms_mm, report.others[0].error.max_mm);
  EXPECT_LT(report.others[0].error.max_mm, 20);  // of 2 m
}

TEST(RigAsBones, NothingIsAddedWhereNothingMoves) {
  const sample::Folder folder;
  const auto still = [](const Eigen::Vector3f& p, double) { return p; };
  const Simulated s = simulate(write(folder, animatedTube()), 0, 61, 60, still);
  const RigBakeReport report = writeRigAsBones(s.clip(), {4, 4, 12}, folder / "out.glb");
  EXPECT_TRUE(report.plain);
  EXPECT_EQ(report.added, 0u);
  EXPECT_LT(report.error.max_mm, 0.1);
  const GltfDocument before = GltfDocument::read(folder / "rig.glb");
  const GltfDocument after = GltfDocument::read(folder / "out.glb");
  const auto weights = [](const GltfDocument& document) {
    return document.floats(
        document.root()["meshes"].at(0)["primitives"].at(0)["attributes"]["WEIGHTS_0"].index(1000),
        4);
  };
  EXPECT_EQ(weights(after), weights(before));
}

}  // namespace
}  // namespace fascia
