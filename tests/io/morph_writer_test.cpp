#include <gtest/gtest.h>

#include <fascia/io/gltf/gltf_document.h>

#include "simulated_rig.h"

namespace fascia {
namespace {

using sample::animatedTube;
using sample::animationOf;
using sample::simulate;
using sample::Simulated;
using sample::swaying;
using sample::write;

TEST(RigAsMorphs, SeveralMotionsShareTheirTargets) {
  const sample::Folder folder;
  const std::string path = write(folder, animatedTube());
  const Simulated bend = simulate(path, 0, 61, 60, swaying),
                  hop = simulate(path, 1, 61, 60, swaying);
  const std::vector<RigClip> clips{{bend.model, bend.recording, bend.joints_world, bend.motion, 1},
                                   {bend.model, hop.recording, hop.joints_world, hop.motion, 1}};
  const RigBakeReport report = writeRigAsMorphs(clips, {}, folder / "out.glb");
  EXPECT_LE(report.added, 3u);
  EXPECT_LT(report.error.max_mm, 0.01);
  ASSERT_EQ(report.baked.size(), 2u);
}

TEST(RigAsMorphs, PlaysWhatTargetsCanSay) {
  const sample::Folder folder;
  const Simulated s = simulate(write(folder, animatedTube()), 0, 61, 60, swaying);
  const RigBakeReport report = writeRigAsMorphs(s.clip(), {}, folder / "out.glb");
  EXPECT_LE(report.added, 3u);
  EXPECT_LT(report.error.max_mm, 0.01);
  const GltfDocument document = GltfDocument::read(folder / "out.glb");
  EXPECT_EQ(document.root()["meshes"].at(0)["primitives"].at(0)["targets"].size(), report.added);
  EXPECT_EQ(document.root()["meshes"].at(0)["extras"]["targetNames"].at(0).text(),
            "fascia_morph_01");
}

TEST(RigAsMorphs, OldTargetsStayAndOtherAnimationsAreWidened) {
  const sample::Folder folder;
  sample::TubeRig rig = animatedTube();
  const int smile = rig.file.add(std::vector<float>(36, 0.1f), 3, "VEC3");
  rig.file.meshes =
      "[" +
      rig.meshOf(rig.primitive(R"(,"targets":[{"POSITION":)" + std::to_string(smile) + "}]")) + "]";
  const int times = rig.file.add(std::vector<float>{0, 1}, 1, "SCALAR");
  const int weights = rig.file.add(std::vector<float>{0, 0.5f}, 1, "SCALAR");
  rig.file.animations.back() = ',';
  rig.file.animations += R"({"name":"smile","channels":[{"sampler":0,"target":{"node":3,)"
                         R"("path":"weights"}}],"samplers":[{"input":)" +
                         std::to_string(times) + R"(,"output":)" + std::to_string(weights) + "}]}]";
  const Simulated s = simulate(write(folder, rig), 0, 61, 60, swaying);
  const RigBakeReport report = writeRigAsMorphs(s.clip(), {}, folder / "out.glb");
  EXPECT_LT(report.error.max_mm, 0.01);
  const GltfDocument document = GltfDocument::read(folder / "out.glb");
  const GltfPlace mesh = document.root()["meshes"].at(0);
  EXPECT_EQ(mesh["weights"].size(), 1 + report.added);
  EXPECT_EQ(mesh["extras"]["targetNames"].at(0).text(), "target_1");
  const GltfPlace animation = animationOf(document, "smile");
  const auto sampler = animation["channels"].at(0)["sampler"].count();
  std::vector<float> wide(2 * (1 + report.added), 0.f);
  wide[1 + report.added] = 0.5f;
  EXPECT_EQ(document.floats(animation["samplers"].at(sampler)["output"].index(1000), 1), wide);
}

}  // namespace
}  // namespace fascia
