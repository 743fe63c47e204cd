#include <gtest/gtest.h>

#include <cstdlib>

#include <fascia/io/file/child_process.h>
#include <fascia/io/rig_export/rig_player.h>

#include "programs.h"
#include "simulated_rig.h"
#include "support/assets.h"

namespace fascia {
namespace {

using sample::simulate;
using sample::Simulated;

using test::expectSuccess;

// Everywhere a little, as flesh does.
Eigen::Vector3f breathing(const Eigen::Vector3f& p, double time_s) {
  const auto s = static_cast<float>(0.01 * std::sin(9 * time_s + 5 * static_cast<double>(p.z())));
  return p + s * Eigen::Vector3f(p.x(), 0.2f, p.y());
}

class BakedFox : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto file = assetFile("khronos-gltf-tests/Fox.glb");
    if (!file) GTEST_SKIP() << "the shared assets are not here";
    fox_ = simulate(*file, 0, 40, 24, breathing, 0.01);
  }

  // What the file plays by our own player, frame after frame, for other programs to compare with.
  void writeFrames(const std::string& glb, const std::string& path) {
    const GltfDocument document = GltfDocument::read(glb);
    const RigPlayer player(document, fox_.model.parts, 0, 1);
    std::string bytes;
    std::vector<Eigen::Vector3f> vertices;
    for (const Recording::Frame& frame : fox_.recording.frames) {
      player.pose(frame.time_s, vertices);
      bytes.append(reinterpret_cast<const char*>(vertices.data()), vertices.size() * 12);
    }
    writeFileWhole(path, bytes);
  }

  void expectSameInBlender(const std::string& glb, const std::string& frames,
                           const std::string& motion) {
    // Fox is 155 units long: a single-precision rounding of its positions is 1e-5 of them.
    expectSuccess("blender", {"--background", "--factory-startup", "--python-exit-code", "1",
                              "--python", FASCIA_SOURCE_DIR "/tests/io/rig_writer_blender.py", "--",
                              glb, frames, "24", motion, "1e-3"});
  }

  Simulated fox_;
};

TEST_F(BakedFox, KhronosValidatorFindsNothing) {
  const char* module = std::getenv("GLTF_VALIDATOR");
  if (!module || findProgram("node").empty()) {
    GTEST_SKIP() << "set GLTF_VALIDATOR to the folder of the npm package gltf-validator";
  }
  const sample::Folder folder;
  writeRigAsBones(fox_.clip(), {4, 8, 3}, folder / "bones.glb");
  writeRigAsMorphs(fox_.clip(), {}, folder / "morphs.glb");
  writeRigAsCache(fox_.clip(), folder / "cache.glb");
  const Simulated walk =
      simulate(*assetFile("khronos-gltf-tests/Fox.glb"), 1, 18, 24, breathing, 0.01);
  const std::vector<RigClip> two{
      fox_.clip(), {fox_.model, walk.recording, walk.joints_world, walk.motion, fox_.scale}};
  writeRigAsBones(two, {6, 4, 3}, folder / "two.glb");
  writeRigAsMorphs(two, {}, folder / "two_morphs.glb");
  for (const char* name : {"bones.glb", "morphs.glb", "cache.glb", "two.glb", "two_morphs.glb"}) {
    expectSuccess("node", {FASCIA_SOURCE_DIR "/tests/io/validate_gltf.js", module, folder / name});
  }
}

TEST_F(BakedFox, BlenderPlaysTheBones) {
  if (findProgram("blender").empty()) GTEST_SKIP() << "Blender is not installed";
  const sample::Folder folder;
  writeRigAsBones(fox_.clip(), {4, 4, 3}, folder / "fox.glb");
  writeFrames(folder / "fox.glb", folder / "frames.f32");
  expectSameInBlender(folder / "fox.glb", folder / "frames.f32", fox_.motion);
}

TEST_F(BakedFox, BlenderPlaysTheMorphs) {
  if (findProgram("blender").empty()) GTEST_SKIP() << "Blender is not installed";
  const sample::Folder folder;
  const RigBakeReport report = writeRigAsMorphs(fox_.clip(), {}, folder / "fox.glb");
  writeFrames(folder / "fox.glb", folder / "frames.f32");
  expectSameInBlender(folder / "fox.glb", folder / "frames.f32", fox_.motion);
}

TEST_F(BakedFox, BlenderPlaysTheCaches) {
  if (findProgram("blender").empty()) GTEST_SKIP() << "Blender is not installed";
  const sample::Folder folder;
  writeRigAsCache(fox_.clip(), folder / "fox.glb");
  std::string bytes;
  for (const Recording::Frame& frame : fox_.recording.frames) {
    bytes.append(reinterpret_cast<const char*>(frame.skin_m.data()), frame.skin_m.size() * 12);
  }
  writeFileWhole(folder / "frames.f32", bytes);
  for (const char* format : {"pc2", "mdd"}) {
    expectSameInBlender(folder / "fox.glb", folder / "frames.f32", format);
  }
}

}  // namespace
}  // namespace fascia
