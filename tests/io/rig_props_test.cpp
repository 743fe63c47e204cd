// What a file has beside its skinned mesh: props that move, scenes that are not shown, morph
// targets.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fascia/io/cache/pc2.h>
#include <fascia/io/gltf/gltf_keys.h>
#include <fascia/io/rig_export/rig_writer.h>

#include "rig_checks.h"
#include "simulated_rig.h"

namespace fascia {
namespace {

using namespace sample;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

Eigen::Vector3f still(const Eigen::Vector3f& p, double) {
  return p;
}

// The tube, and a box-less triangle beside it, whose node rises from 0 to 5 m while the tube bends.
TubeRig tubeWithProp(bool rises) {
  TubeRig rig;
  const int triangle = rig.file.add(std::vector<float>{2, 0, 0, 2.3f, 0, 0, 2, 0.3f, 0}, 3, "VEC3");
  rig.file.meshes = "[" + TubeRig::meshOf(rig.primitive()) +
                    R"(,{"name":"prop","primitives":[{"attributes":{"POSITION":)" +
                    std::to_string(triangle) + "}}]}]";
  rig.file.nodes = R"([{"name":"Armature","children":[1,3]},{"name":"lower","children":[2]},)"
                   R"({"name":"upper","translation":[0,1,0]},{"name":"body","mesh":0,"skin":0},)"
                   R"({"name":"prop","mesh":1}])";
  rig.file.scenes = R"([{"nodes":[0,4]}])";
  std::string bend = rig.animation(kBend, rises ? 2 : 1, rises ? "rotation" : "translation", kTimes,
                                   rises ? kTurns : std::vector<float>{0, 0, 0, 1, 0, 0, 2, 0, 0});
  if (rises) {
    const int input = rig.file.add(std::vector<float>{0.5f, 1.5f}, 1, "SCALAR");
    const int output = rig.file.add(std::vector<float>{0, 0, 0, 0, 5, 0}, 3, "VEC3");
    const auto insert = [&](const std::string& after, const std::string& text) {
      bend.insert(bend.find(after) + after.size(), text);
    };
    insert(R"("channels":[)", R"({"sampler":1,"target":{"node":4,"path":"translation"}},)");
    insert(R"("interpolation":"LINEAR"})", R"(,{"input":)" + std::to_string(input) +
                                               R"(,"output":)" + std::to_string(output) + "}");
  }
  rig.file.animations = "[" + bend + "]";
  return rig;
}

TEST(RigProps, AMeshBesideTheBodyMovesAsItsNodeDoes) {
  const RiggedModel m = imported(tubeWithProp(true));
  expectSound(m);
  ASSERT_EQ(m.joints.size(), 3u);
  EXPECT_EQ(m.joints[2].name, "prop");
  EXPECT_THAT(m.notes, Contains(HasSubstr("1 meshes without a skin move by themselves")));
  std::vector<Transform> world;
  poseRig(m, 0, m.motions.at(0).duration_s(), world);
  EXPECT_NEAR(world[2].translation_m.y(), 5, 1e-4);
}

TEST(RigProps, AMeshBesideTheBodyStaysWhereItIsWhileTheRootWalks) {
  const RiggedModel m = imported(tubeWithProp(false));
  expectSound(m);
  ASSERT_EQ(m.joints.size(), 3u);
  std::vector<Transform> world;
  poseRig(m, 0, 1, world);
  EXPECT_NEAR(world[0].translation_m.x(), 2, 1e-4);
  EXPECT_NEAR(world[2].translation_m.norm(), 0, 1e-4);
}

TEST(RigProps, WithoutMotionsMeshesBesideTheBodyGoWithIt) {
  TubeRig rig = tubeWithProp(false);
  rig.file.animations.clear();
  const RiggedModel m = imported(rig);
  EXPECT_EQ(m.joints.size(), 2u);
  EXPECT_THAT(m.notes, Contains(HasSubstr("move with the root")));
}

TEST(RigProps, BakesMoveThemToo) {
  const Folder folder;
  const std::string path = write(folder, tubeWithProp(true));
  const Simulated s = simulate(path, 0, 31, 30, still);
  const RigBakeReport cache = writeRigAsCache(s.clip(), folder / "c.glb");
  EXPECT_THAT(cache.notes, Contains(HasSubstr("left out are 3 joints, 1 animations")));
  ASSERT_EQ(cache.files.size(), 5u);
  const PointCache prop = readPc2(folder / "c.prop.pc2");
  EXPECT_NEAR(prop.positions_m.front().y(), 0, 1e-5);
  EXPECT_NEAR(prop.positions_m[prop.positions_m.size() - 3].y(), 5, 1e-4);
  const RigBakeReport bones = writeRigAsBones(s.clip(), {}, folder / "b.glb");
  EXPECT_LT(bones.error.max_mm, 1);
}

TEST(RigProps, ACharacterInAnotherSceneIsFound) {
  TubeRig rig;
  rig.file.scenes = R"([{"name":"empty","nodes":[]},{"name":"stage","nodes":[0]}])";
  const RiggedModel m = imported(rig);
  EXPECT_EQ(m.joints.size(), 2u);
  EXPECT_THAT(m.notes, Contains(HasSubstr("scene 0 (\"empty\") has no skinned mesh: scene 1")));
  rig.file.scenes = R"([{"nodes":[0]},{"nodes":[0]}])";
  EXPECT_THAT(imported(rig).notes, Not(Contains(HasSubstr("is taken"))));
  rig.file.scenes = R"([{"nodes":[]},{"nodes":[]}])";
  EXPECT_THAT(complaint(rig), HasSubstr("no mesh of the scene has a skin"));
}

TEST(RigProps, AnUnevenScaleAboveTheJointsIsNamed) {
  TubeRig rig;
  rig.file.nodes =
      R"([{"name":"Armature","children":[1,3],"scale":[1,2,0.5]},{"name":"lower","children":[2]},)"
      R"({"name":"upper","translation":[0,1,0]},{"name":"body","mesh":0,"skin":0}])";
  rig.file.animations = "[" + rig.animation(kBend, 2, "rotation", kTimes, kTurns) + "]";
  const auto named = Contains(
      HasSubstr(R"(sheared in "bend" by the uneven scale (1, 2, 0.5) of the node "Armature")"));
  EXPECT_THAT(imported(rig).notes, named);
  const Folder folder;
  const Simulated s = simulate(write(folder, rig), 0, 31, 30, still);
  EXPECT_THAT(writeRigAsBones(s.clip(), {}, folder / "b.glb").notes, named);
}

// The tube with a morph target, animated beside the bend: 0, 1, 0 at 0.5, 1 and 1.5 s.
TubeRig tubeWithFace() {
  TubeRig rig;
  const int target = rig.file.add(std::vector<float>(36, 0.01f), 3, "VEC3");
  rig.file.meshes = "[" +
                    TubeRig::meshOf(rig.primitive(R"(,"targets":[{"POSITION":)" +
                                                  std::to_string(target) + "}]")) +
                    "]";
  std::string bend = rig.animation(kBend, 2, "rotation", kTimes, kTurns);
  const int output = rig.file.add(std::vector<float>{0, 1, 0}, 1, "SCALAR");
  const int input = rig.file.add(kTimes, 1, "SCALAR");
  const auto insert = [&](const std::string& after, const std::string& text) {
    bend.insert(bend.find(after) + after.size(), text);
  };
  insert(R"("channels":[)", R"({"sampler":1,"target":{"node":3,"path":"weights"}},)");
  insert(R"("interpolation":"LINEAR"})",
         R"(,{"input":)" + std::to_string(input) + R"(,"output":)" + std::to_string(output) + "}");
  rig.file.animations = "[" + bend + "]";
  return rig;
}

GltfKeys weightKeys(const GltfDocument& document) {
  const GltfPlace animation = animationOf(document, kBend), channels = animation["channels"];
  GltfKeys keys;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (channels.at(c)["target"]["path"].text() != "weights") continue;
    EXPECT_TRUE(readGltfKeys(document, animation, *channels.at(c).json(), keys));
  }
  return keys;
}

TEST(RigProps, APartOfAMotionKeepsThePartOfItsFace) {
  const Folder folder;
  const std::string path = write(folder, tubeWithFace());
  const Simulated s = simulate(path, 0, 10, 30, swaying);  // 0.3 of 1 s
  for (const bool morphs : {false, true}) {
    const std::string out = folder / (morphs ? "m.glb" : "b.glb");
    const RigBakeReport report =
        morphs ? writeRigAsMorphs(s.clip(), {}, out) : writeRigAsBones(s.clip(), {}, out);
    EXPECT_TRUE(report.notes.empty());
    const GltfKeys keys = weightKeys(GltfDocument::read(out));
    ASSERT_FALSE(keys.times_s.empty());
    EXPECT_NEAR(keys.times_s.back(), 0.8, 1e-5);
    for (const double t : {0.5, 0.6, 0.7})  // as in the file, on its clock
      EXPECT_NEAR(keys.valueAt(t)[0], 2 * (t - 0.5), 1e-5);
  }
}

TEST(RigProps, ALongerBakeRepeatsTheFaceOfALoop) {
  const Folder folder;
  const std::string path = write(folder, tubeWithFace());
  const Simulated s = simulate(path, 0, 61, 30, swaying);  // twice
  ASSERT_TRUE(s.model.motions[0].loop);
  writeRigAsBones(s.clip(), {}, folder / "b.glb");
  const GltfKeys keys = weightKeys(GltfDocument::read(folder / "b.glb"));
  EXPECT_NEAR(keys.times_s.back(), 2.5, 1e-5);
  EXPECT_NEAR(keys.valueAt(1.75)[0], 0.5, 1e-5);
  EXPECT_NEAR(keys.valueAt(2)[0], 1, 1e-5);
}

}  // namespace
}  // namespace fascia
