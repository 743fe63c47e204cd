#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <sys/stat.h>

#include <fascia/base/error.h>
#include <fascia/io/file/child_process.h>
#include <fascia/io/rig_import/assimp/assimp_import.h>
#include <fascia/io/rig_import/rig_import.h>

#include "programs.h"
#include "rig_checks.h"
#include "sample.h"
#include "support/assets.h"

namespace fascia {
namespace {

using test::expectSuccess;

void write(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string importErrorOf(const std::string& path) {
  try {
    readRiggedModel(path);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Assimp, ReadsBonesWeightsAndMotions) {
  const sample::Folder folder;
  write(folder / "cloth.smd", sample::kSmd);
  const RiggedModel model = readRiggedModel(folder / "cloth.smd");
  sample::expectSound(model);
  EXPECT_EQ(model.points_m.size(), 5u);
  EXPECT_EQ(model.triangles.size(), 3u);
  const auto named = [&](const std::string& name) {
    return std::find_if(model.joints.begin(), model.joints.end(),
                        [&](const RigJoint& j) { return j.name == name; });
  };
  ASSERT_NE(named("hip"), model.joints.end());
  ASSERT_NE(named("knee"), model.joints.end());
  const Vec3 knee = named("knee")->rest_world.translation_m;
  EXPECT_NEAR((knee - named("hip")->rest_world.translation_m).norm(), 1, 1e-6);
  float halves = 0;
  for (const PointWeights& w : model.weights) halves += w.weight[1];
  EXPECT_NEAR(halves, 1, 1e-6);  // two points, half each
}

TEST(Assimp, ScalesLengthsAndNothingElse) {
  const sample::Folder folder;
  write(folder / "cloth.smd", sample::kSmd);
  const RiggedModel model = readRiggedModel(folder / "cloth.smd");
  const RiggedModel half = readRiggedModel(folder / "cloth.smd", {.scale = 0.5});
  ASSERT_EQ(half.points_m.size(), model.points_m.size());
  EXPECT_GT(model.size_m(), 1);
  for (std::size_t i = 0; i < half.points_m.size(); ++i)
    EXPECT_LT((half.points_m[i] - 0.5f * model.points_m[i]).norm(), 1e-6f);
  ASSERT_EQ(half.motions.size(), 1u);
  const SampledMotion &whole = model.motions[0], &small = half.motions[0];
  ASSERT_EQ(small.translation_m.size(), whole.translation_m.size());
  for (std::size_t i = 0; i < small.translation_m.size(); ++i) {
    EXPECT_LT((small.translation_m[i] - 0.5f * whole.translation_m[i]).norm(), 1e-6f);
    EXPECT_TRUE(small.rotation[i].isApprox(whole.rotation[i], 1e-6f));
  }
  EXPECT_EQ(half.motions[0].name, "animation 1");  // the format gives none
}

TEST(Assimp, SaysThatASurfaceWithoutBonesNeedsARig) {
  const sample::Folder folder;
  write(folder / "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_THAT(importErrorOf(folder / "a.obj"), testing::HasSubstr("needs a rig"));
  write(folder / "a.stl",
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
        "endloop\nendfacet\nendsolid a\n");
  EXPECT_THAT(importErrorOf(folder / "a.stl"), testing::HasSubstr("needs a rig"));
}

TEST(Assimp, TellsWhatCannotBeRead) {
  const sample::Folder folder;
  EXPECT_THAT(importErrorOf(folder / "none.fbx"), testing::HasSubstr("none.fbx: cannot be read"));
  EXPECT_THAT(importErrorOf(folder / "none.abc"), testing::HasSubstr("has the ending \".abc\""));
  for (const char* name : {"a.fbx", "a.dae", "a.blend", "a.x", "a.b3d", "a.ms3d", "a.mdl"}) {
    write(folder / name, "Kaydara FBX Binary  \x1a junk \xff\xff\xff\xff\xff\xff\xff\xff\xff");
    EXPECT_NE(importErrorOf(folder / name), "no error") << name;
  }
}

TEST(Assimp, SurvivesTruncatedFiles) {
  const sample::Folder folder;
  const std::string text = sample::kSmd;
  for (std::size_t size = 0; size < text.size(); size += 61) {
    write(folder / "cut.smd", text.substr(0, size));
    importErrorOf(folder / "cut.smd");  // no crash: an error, or what there is
  }
}

TEST(Assimp, ReadsAnFbxAsTheGltfThatItWasMadeFrom) {
  const auto glb = assetFile("khronos-gltf-tests/Fox.glb");
  if (!glb) GTEST_SKIP() << "the shared assets are not here";
  if (findProgram("blender").empty()) GTEST_SKIP() << "Blender is not installed";
  const sample::Folder folder;
  expectSuccess("blender", {"--background", "--factory-startup", "--python-exit-code", "1",
                            "--python", FASCIA_SOURCE_DIR "/tests/io/blender_export_fbx.py", "--",
                            glb->string(), folder / "fox.fbx"});
  const RiggedModel from = readRiggedModel(glb->string());
  const RiggedModel model = readRiggedModel(folder / "fox.fbx");
  sample::expectSound(model);
  EXPECT_EQ(model.triangles.size(), from.triangles.size());
  EXPECT_NEAR(model.height_m(), from.height_m(), 1e-3 * from.height_m());
  EXPECT_FALSE(model.materials[0].texture.empty());
  EXPECT_EQ(model.motions.size(), from.motions.size());
  std::size_t same = 0;
  for (const RigJoint& joint : from.joints) {
    for (const RigJoint& other : model.joints) {
      if (joint.name != other.name) continue;
      ++same;
      const Vec3 apart = joint.rest_world.translation_m - other.rest_world.translation_m;
      EXPECT_LT(apart.norm(), 1e-3 * from.size_m()) << joint.name;
    }
  }
  EXPECT_GT(same, 20u);
}

// What a file leads to beside itself must neither hold it up nor be a device, a pipe or another's.
TEST(Assimp, OpensPlainNeighboursOnly) {
  const sample::Folder folder;
  std::filesystem::create_directory(folder / "folder.mtl");
  std::filesystem::create_symlink("/dev/zero", folder / "link.mtl");
  ASSERT_EQ(mkfifo((folder / "pipe.mtl").c_str(), 0600), 0);
  for (const std::string& library :
       {std::string("pipe.mtl"), folder / "pipe.mtl", std::string("./pipe.mtl"),
        std::string("link.mtl"), std::string("folder.mtl"), std::string("../../dev/zero"),
        std::string("/dev/zero")}) {
    write(folder / "a.obj",
          "mtllib " + library + "\nusemtl seen\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_THAT(importErrorOf(folder / "a.obj"), testing::HasSubstr("needs a rig")) << library;
  }
}

}  // namespace
}  // namespace fascia
