// Avatars: what VRM's extensions say stays, is used, and is taken out only if that is asked for.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fascia/io/gltf/gltf_humanoid.h>
#include <fascia/io/motion/motion_file.h>
#include <fascia/io/rig_export/rig_writer.h>

#include "rig_checks.h"
#include "simulated_rig.h"

namespace fascia {
namespace {

using namespace sample;
using testing::Contains;
using testing::HasSubstr;

constexpr const char* kOld =
    R"(,"extensionsUsed":["VRM"],"extensions":{"VRM":{"specVersion":"0.0","humanoid":{"humanBones":[)"
    R"({"bone":"hips","node":1},{"bone":"chest","node":2}]},"blendShapeMaster":{"blendShapeGroups":)"
    R"([{"name":"A","binds":[{"mesh":0,"index":0,"weight":100}]}]},"secondaryAnimation":{"boneGroups":)"
    R"([{"stiffiness":1,"bones":[2]},{"stiffiness":2,"bones":[4]}]},"odd":[null,1e-7,{"x":[]}]}})";
constexpr const char* kNew =
    R"(,"extensionsUsed":["VRMC_vrm","VRMC_springBone"],"extensions":{"VRMC_vrm":{"specVersion":"1.0",)"
    R"("humanoid":{"humanBones":{"hips":{"node":1},"chest":{"node":2}}}},"VRMC_springBone":{)"
    R"("specVersion":"1.0","springs":[{"joints":[{"node":2},{"node":4}]},{"joints":[{"node":4}]}]}})";

TubeRig avatar(const char* extensions) {
  TubeRig rig = animatedTube();
  rig.file.nodes =
      R"([{"name":"Armature","children":[1,3]},{"name":"a","children":[2]},)"
      R"({"name":"b","translation":[0,1,0]},{"name":"body","mesh":0,"skin":0},{"name":"tail"}])";
  rig.file.scenes = R"([{"nodes":[0,4]}])";
  rig.file.more = extensions;
  return rig;
}

TEST(Vrm, NamesItsBones) {
  for (const char* extensions : {kOld, kNew}) {
    const GltfDocument document = GltfDocument::parse(avatar(extensions).file.glb(), "a.vrm");
    EXPECT_TRUE(isVrm(document.json()));
    const std::vector<HumanBone> bones = humanBonesOf(document.json());
    ASSERT_EQ(bones.size(), 2u);
    EXPECT_EQ(bones[1].bone, "chest");
    EXPECT_EQ(bones[1].node, 2);
    EXPECT_EQ(springCount(document.json()), 2u);
  }
  const GltfDocument plain = GltfDocument::parse(TubeRig().file.glb(), "a.glb");
  EXPECT_FALSE(isVrm(plain.json()));
  EXPECT_TRUE(humanBonesOf(plain.json()).empty());
}

TEST(Vrm, OddExtensionsArePassedOver) {
  for (const char* odd :
       {R"({"VRM":3})",
        R"({"VRM":{"humanoid":{"humanBones":[3,{"bone":1},{"bone":"hips","node":-2}]}}})",
        R"({"VRM":{"secondaryAnimation":{"boneGroups":[{"bones":[99,"x"]},5]}}})",
        R"({"VRMC_springBone":{"springs":[{"joints":[{"node":77}]},{}]}})",
        R"({"VRMC_vrm":{"humanoid":{"humanBones":{"hips":5}}}})", "[1]"}) {
    TubeRig rig;
    rig.file.more = std::string(R"(,"extensions":)") + odd;
    GltfDocument document = GltfDocument::parse(rig.file.glb(), "a.vrm");
    EXPECT_TRUE(humanBonesOf(document.json()).empty()) << odd;
    EXPECT_EQ(eraseSprings(document.json(), std::vector<bool>(4, true)), 0u) << odd;
  }
}

TEST(Vrm, KeepsEverythingUnlessAsked) {
  const Folder folder;
  for (const char* extensions : {kOld, kNew}) {
    const std::string path = folder / "rig.vrm";
    writeFileWhole(path, avatar(extensions).file.glb());
    const Simulated s = simulate(path, 0, 31, 30, swaying);
    EXPECT_TRUE(isVrm(s.model));
    const GltfDocument before = GltfDocument::read(path);
    const RigBakeReport kept = writeRigAsBones(s.clip(), {}, folder / "kept.vrm");
    EXPECT_THAT(kept.notes, Contains(HasSubstr("2 swinging chains are kept")));
    const GltfDocument after = GltfDocument::read(folder / "kept.vrm");
    for (const char* member : {"extensions", "extensionsUsed"})
      EXPECT_EQ(compactJson(*before.json().find(member)), compactJson(*after.json().find(member)));
    for (std::size_t n = 0; n < 5; ++n)
      EXPECT_EQ(after.root()["nodes"].at(n)["name"].text(),
                before.root()["nodes"].at(n)["name"].text());
    const RigBakeReport replaced = writeRigAsMorphs(s.clip(), {}, folder / "replaced.vrm",
                                                    RigFileOptions{.replaceSprings = true});
    EXPECT_THAT(replaced.notes, Contains(HasSubstr("1 swinging chains are replaced")));
    EXPECT_THAT(replaced.notes, Contains(HasSubstr("1 swinging chains are kept")));
    const GltfDocument other = GltfDocument::read(folder / "replaced.vrm");
    EXPECT_EQ(springCount(other.json()), 1u);
    EXPECT_EQ(humanBonesOf(other.json()).size(), 2u);
  }
}

TEST(Vrm, DrivesTheBonesThatItNames) {
  const Folder folder;
  writeFileWhole(folder / "rig.vrm", avatar(kNew).file.glb());
  writeFileWhole(
      folder / "walk.bvh",
      "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition "
      "Zrotation Xrotation Yrotation\nJOINT Chest\n{\nOFFSET 0 1 0\nCHANNELS 3 Zrotation "
      "Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\n}\nMOTION\nFrames: 2\nFrame "
      "Time: 0.1\n0 0 0 0 0 0 0 0 0\n0 0 0 0 0 0 20 0 0\n");
  const RiggedModel rig = readRiggedModel(folder / "rig.vrm");
  const MotionFile motion = readMotionFile(folder / "walk.bvh", rig, "");
  ASSERT_EQ(motion.map.size(), 2u);
  EXPECT_EQ(motion.map[0].target, "a");
  EXPECT_EQ(motion.map[1].target, "b");
}

// A motion of its own, as .vrma files are: nodes that a human's bones are named by, no mesh.
TEST(Vrm, TakesMotionsOutOfFilesWithoutAMesh) {
  const Folder folder;
  TubeRig motion;
  motion.file.meshes.clear(), motion.file.skins.clear();
  motion.file.nodes = R"([{"name":"x","children":[1]},{"name":"y","translation":[0,1,0]}])";
  motion.file.animations = "[" + motion.animation("wave", 1, "rotation", kTimes, kTurns) + "]";
  motion.file.more =
      R"(,"extensions":{"VRMC_vrm_animation":{"humanoid":{"humanBones":{"hips":{"node":0},)"
      R"("chest":{"node":1}}}}})";
  writeFileWhole(folder / "wave.vrma", motion.file.glb());
  writeFileWhole(folder / "rig.vrm", avatar(kNew).file.glb());
  const RiggedModel rig = readRiggedModel(folder / "rig.vrm");
  EXPECT_TRUE(isMotionFile(folder / "wave.vrma"));
  MotionFile file = readMotionFile(folder / "wave.vrma", rig, "");
  ASSERT_EQ(file.map.size(), 2u);
  EXPECT_EQ(file.map[1].source, "y");
  EXPECT_EQ(file.map[1].target, "b");
  const SampledMotion mapped = ontoRig(file, rig);
  EXPECT_EQ(mapped.name, "wave");
  EXPECT_NEAR(mapped.duration_s(), 1, 0.05);
  double largest_rad = 0;
  for (const Eigen::Quaternionf& q : mapped.rotation)
    largest_rad = std::max(largest_rad, double{q.angularDistance(Eigen::Quaternionf::Identity())});
  EXPECT_NEAR(largest_rad, kPi / 4, 0.02);
}

TEST(Vrm, MotionsThatAreNoneAreRefused) {
  const Folder folder;
  writeFileWhole(folder / "still.glb", TubeRig().file.glb());
  const RiggedModel rig = readRiggedModel(folder / "still.glb");
  EXPECT_THROW(readMotionFile(folder / "still.glb", rig, ""), Error);
}

}  // namespace
}  // namespace fascia
