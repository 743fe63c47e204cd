#include <gtest/gtest.h>

#include <fascia/io/cache/mdd.h>
#include <fascia/io/cache/pc2.h>
#include <fascia/io/gltf/gltf_document.h>

#include "rig_checks.h"
#include "simulated_rig.h"

namespace fascia {
namespace {

using sample::animatedTube;
using sample::simulate;
using sample::Simulated;
using sample::swaying;
using sample::write;

TEST(RigAsCache, HoldsEveryFrameExactly) {
  const sample::Folder folder;
  const Simulated s = simulate(write(folder, animatedTube()), 0, 10, 60, swaying);
  const RigBakeReport report = writeRigAsCache(s.clip(), folder / "out.glb");
  EXPECT_EQ(report.error.max_mm, 0);
  EXPECT_EQ(report.files,
            (std::vector<std::string>{folder / "out.glb", folder / "out.pc2", folder / "out.mdd"}));
  const PointCache pc2 = readPc2(folder / "out.pc2");
  const MddCache mdd = readMdd(folder / "out.mdd");
  ASSERT_EQ(pc2.sampleCount(), 10u);
  ASSERT_EQ(mdd.times_s.size(), 10u);
  EXPECT_EQ(pc2.positions_m.back(), s.recording.frames.back().skin_m.back());
  EXPECT_EQ(mdd.positions_m.back(), s.recording.frames.back().skin_m.back());
  const GltfDocument still = GltfDocument::read(folder / "out.glb");
  EXPECT_FALSE(still.root()["skins"]);
  EXPECT_FALSE(still.root()["animations"]);
  const GltfPlace position =
      still.root()["meshes"].at(0)["primitives"].at(0)["attributes"]["POSITION"];
  EXPECT_EQ(still.elementCount(position.index(1000)), pc2.pointCount);
}

TEST(RigWriter, WhatItDoesNotKnowSurvives) {
  const sample::Folder folder;
  sample::TubeRig rig = animatedTube();
  rig.file.materials = R"([{"name":"fur","extras":{"brush":7},"extensions":)"
                       R"({"KHR_materials_sheen":{"sheenRoughnessFactor":0.25}}}])";
  rig.file.meshes =
      "[" + rig.meshOf(rig.primitive(R"(,"material":0,"extras":{"id":"skin"})")) + "]";
  rig.file.more = R"(,"extensionsUsed":["KHR_materials_sheen"],"extras":{"author":"somebody"})";
  const Simulated s = simulate(write(folder, rig), 0, 61, 60, swaying);
  writeRigAsBones(s.clip(), {1, 4, 3}, folder / "bones.glb");
  writeRigAsMorphs(s.clip(), {}, folder / "morphs.glb");
  writeRigAsCache(s.clip(), folder / "cache.glb");
  for (const char* name : {"bones.glb", "morphs.glb", "cache.glb"}) {
    const GltfDocument document = GltfDocument::read(folder / name);
    const GltfPlace root = document.root();
    EXPECT_EQ(root["extras"]["author"].text(), "somebody") << name;
    EXPECT_EQ(root["extensionsUsed"].at(0).text(), "KHR_materials_sheen") << name;
    const GltfPlace fur = root["materials"].at(0);
    EXPECT_EQ(fur["extras"]["brush"].numberOr(0), 7) << name;
    EXPECT_EQ(fur["extensions"]["KHR_materials_sheen"]["sheenRoughnessFactor"].numberOr(0), 0.25);
    EXPECT_EQ(root["meshes"].at(0)["primitives"].at(0)["extras"]["id"].text(), "skin") << name;
  }
}

// Of other formats than glTF a file is made out of the model: in metres, whatever its unit was.
TEST(RigWriter, OtherFormatsBecomeAGltfOfTheModel) {
  const sample::Folder folder;
  const std::string path = folder / "cloth.smd";
  writeFileWhole(path, sample::kSmd);
  // The far end of the cloth goes up by 10 cm in the frame after the first.
  const auto lifted = [](const Eigen::Vector3f& p, double t) -> Eigen::Vector3f {
    return p.norm() > 3 ? Eigen::Vector3f(p + Eigen::Vector3f(0, static_cast<float>(3 * t), 0)) : p;
  };
  const Simulated s = simulate(path, 0, 2, 30, lifted, 2);
  for (const char* name : {"bones.glb", "morphs.glb"}) {
    const RigBakeReport report = name[0] == 'b'
                                     ? writeRigAsBones(s.clip(), {2, 4, 60}, folder / name)
                                     : writeRigAsMorphs(s.clip(), {}, folder / name);
    EXPECT_GE(report.added, 1u) << name;
    EXPECT_LT(report.error.max_mm, 1) << name;
    const RiggedModel back = readRiggedModel(folder / name);
    ASSERT_EQ(back.points_m.size(), s.model.points_m.size()) << name;
    for (std::size_t i = 0; i < back.points_m.size(); ++i)
      EXPECT_LT((back.points_m[i] - s.model.points_m[i]).norm(), 1e-6f) << name;
  }
}

TEST(RigWriter, BadInputLeavesNoFile) {
  const sample::Folder folder;
  const std::string path = write(folder, animatedTube());
  Simulated s = simulate(path, 0, 5, 60, swaying);
  const auto expectRefused = [&] {
    EXPECT_THROW(writeRigAsBones(s.clip(), {1, 4, 3}, folder / "out.glb"), Error);
    EXPECT_THROW(writeRigAsMorphs(s.clip(), {}, folder / "out.glb"), Error);
    EXPECT_THROW(writeRigAsCache(s.clip(), folder / "out.glb"), Error);
    EXPECT_EQ(folder.entryCount(), 1u);
  };
  const float good = s.recording.frames[2].skin_m[3].x();
  s.recording.frames[2].skin_m[3].x() = std::nanf("");
  expectRefused();
  s.recording.frames[2].skin_m[3].x() = good;
  s.joints_world.pop_back();
  expectRefused();
  s.joints_world.push_back(s.joints_world.back());
  const std::vector<RigClip> twice{s.clip(), s.clip()};  // of one name
  EXPECT_THROW(writeRigAsBones(twice, {1, 4, 3}, folder / "out.glb"), Error);
  sample::TubeRig other = animatedTube();  // the file is another one now
  other.file.nodes = R"([{"name":"lower","children":[1,2]},)"
                     R"({"name":"upper","translation":[0,1,0]},{"name":"body","mesh":0,"skin":0}])";
  other.file.skins = other.skinOf("[0,1]");
  other.file.animations.clear();
  writeFileWhole(path, other.file.glb());
  expectRefused();
}

}  // namespace
}  // namespace fascia
