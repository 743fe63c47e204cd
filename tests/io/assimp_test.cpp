#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include <fascia/base/error.h>
#include <fascia/io/file/child_process.h>
#include <fascia/io/picture/image.h>
#include <fascia/io/rig_import/assimp/assimp_import.h>
#include <fascia/io/rig_import/makehuman/makehuman_import.h>
#include <fascia/io/rig_import/rig_import.h>
#include <fascia/io/rig_import/rig_to_gltf.h>

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

// The tube with a picture, and a motion that bends it.
RiggedModel tube() {
  RiggedModel model = sample::imported(sample::TubeRig());
  RigMaterial material;
  material.name = "wool";
  material.color = {0.5f, 0.25f, 1, 1};
  material.roughness = 0.75f;
  material.doubleSided = true;
  const std::string png = encodePng({2, 2, std::vector<std::uint8_t>(16, 200)});
  material.texture.assign(png.begin(), png.end());
  model.materials = {material};
  for (RigPart& part : model.parts) part.material = 0;
  for (std::size_t v = 0; v < model.vertices.size(); ++v) {
    model.vertices[v].uv = {0.125f * static_cast<float>(v), 0.5f};
  }
  SampledMotion motion;
  motion.name = "bow";
  motion.rate_hz = 25;
  for (const RigJoint& joint : model.joints) motion.joints.push_back(joint.name);
  for (int f = 0; f < 5; ++f) {
    for (std::size_t j = 0; j < model.joints.size(); ++j) {
      const float angle = 0.2f * static_cast<float>(f) * static_cast<float>(j);
      motion.rotation.emplace_back(Eigen::AngleAxisf(angle, Eigen::Vector3f::UnitX()));
      motion.translation_m.emplace_back(0.1f * static_cast<float>(f), static_cast<float>(j), 0.f);
    }
  }
  model.motions = {motion};
  return model;
}

void expectSameSurface(const RiggedModel& a, const RiggedModel& b) {
  ASSERT_EQ(a.points_m.size(), b.points_m.size());
  for (std::size_t i = 0; i < a.points_m.size(); ++i) {
    EXPECT_LT((a.points_m[i] - b.points_m[i]).norm(), 1e-6f);
    for (std::size_t k = 0; k < PointWeights::kMost; ++k) {
      EXPECT_NEAR(a.weights[i].weight[k], b.weights[i].weight[k], 1e-6);
      if (a.weights[i].weight[k] > 0) {
        EXPECT_EQ(a.weights[i].joint[k], b.weights[i].joint[k]);
      }
    }
  }
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.drawnTriangles, b.drawnTriangles);
  EXPECT_EQ(a.component, b.component);
}

void expectSameJoints(const RiggedModel& a, const RiggedModel& b) {
  ASSERT_EQ(a.joints.size(), b.joints.size());
  for (std::size_t j = 0; j < a.joints.size(); ++j) {
    EXPECT_EQ(a.joints[j].name, b.joints[j].name);
    EXPECT_EQ(a.joints[j].parent, b.joints[j].parent);
    const Transform &x = a.joints[j].rest_world, &y = b.joints[j].rest_world;
    EXPECT_TRUE(x.rotation.isApprox(y.rotation, 1e-5)) << a.joints[j].name;
    EXPECT_LT((x.translation_m - y.translation_m).norm(), 1e-5) << a.joints[j].name;
  }
}

TEST(RigToGltf, ReadsBackAsItWas) {
  const sample::Folder folder;
  const RiggedModel model = tube();
  writeRigGlb(model, folder / "tube.glb");
  const RiggedModel back = readRiggedModel(folder / "tube.glb");
  sample::expectSound(back);
  expectSameJoints(model, back);
  expectSameSurface(model, back);
  ASSERT_EQ(back.vertices.size(), model.vertices.size());
  for (std::size_t v = 0; v < model.vertices.size(); ++v) {
    EXPECT_EQ(back.vertices[v].uv, model.vertices[v].uv);
    EXPECT_LT((back.vertices[v].normal - model.vertices[v].normal).norm(), 1e-6f);
  }
  ASSERT_EQ(back.materials.size(), 1u);
  EXPECT_EQ(back.materials[0].name, "wool");
  EXPECT_EQ(back.materials[0].color, model.materials[0].color);
  EXPECT_EQ(back.materials[0].texture, model.materials[0].texture);
  EXPECT_TRUE(back.materials[0].doubleSided);
  ASSERT_EQ(back.motions.size(), 1u);
  EXPECT_EQ(back.motions[0].name, "bow");
  std::vector<Transform> before, after;
  for (const double time_s : {0.0, 0.04, 0.1, 0.16}) {
    poseRig(model, 0, time_s, before);
    poseRig(back, 0, time_s, after);
    for (std::size_t j = 0; j < before.size(); ++j) {
      EXPECT_TRUE(before[j].rotation.isApprox(after[j].rotation, 1e-4));
      EXPECT_LT((before[j].translation_m - after[j].translation_m).norm(), 1e-4);
    }
  }
}

TEST(RigToGltf, ClosesTheCycleOfAMotionThatLoops) {
  const sample::Folder folder;
  RiggedModel model = tube();
  model.motions[0].loop = true;
  writeRigGlb(model, folder / "tube.glb");
  const RiggedModel back = readRiggedModel(folder / "tube.glb");
  ASSERT_EQ(back.motions.size(), 1u);
  EXPECT_TRUE(back.motions[0].loop);
  EXPECT_NEAR(back.motions[0].duration_s(), model.motions[0].duration_s(), 1e-6);
}

TEST(RigToGltf, KeepsMoreThanFourInfluences) {
  RiggedModel model = tube();
  while (model.joints.size() < 6) {
    model.joints.push_back({"more" + std::to_string(model.joints.size()), 0, {}, -1});
  }
  for (PointWeights& w : model.weights) {
    w = {};
    for (std::size_t k = 0; k < 5; ++k) {
      w.joint[k] = static_cast<std::uint16_t>(k);
      w.weight[k] = k == 0 ? 0.6f : 0.1f;
    }
  }
  model.motions.clear();
  const sample::Folder folder;
  writeRigGlb(model, folder / "tube.glb");
  const RiggedModel back = readRiggedModel(folder / "tube.glb");
  ASSERT_FALSE(back.weights.empty());
  for (const PointWeights& w : back.weights) {
    EXPECT_NEAR(w.weight[4], 0.1f, 1e-6f);
    EXPECT_EQ(w.weight[5], 0);
  }
}

TEST(RigToGltf, KhronosValidatorFindsNothing) {
  const char* module = std::getenv("GLTF_VALIDATOR");
  if (!module || findProgram("node").empty()) {
    GTEST_SKIP() << "set GLTF_VALIDATOR to the folder of the npm package gltf-validator";
  }
  const sample::Folder folder;
  writeRigGlb(tube(), folder / "a.glb");
  const std::string check = FASCIA_SOURCE_DIR "/tests/io/validate_gltf.js";
  expectSuccess("node", {check, module, folder / "a.glb"});
  if (const auto human = assetFile("makehuman-cc0/base.obj")) {
    writeRigGlb(readMakeHuman(human->string()), folder / "human.glb");
    expectSuccess("node", {check, module, folder / "human.glb"});
  }
}

TEST(RigToGltf, CarriesAWholeMakeHuman) {
  const auto path = assetFile("makehuman-cc0/base.obj");
  if (!path) GTEST_SKIP() << "the shared assets are not here";
  const RiggedModel direct = readMakeHuman(path->string());
  const RiggedModel model = readRiggedModel(path->string());
  expectSameJoints(direct, model);
  ASSERT_EQ(model.points_m.size(), direct.points_m.size());
  EXPECT_EQ(model.triangles, direct.triangles);
  EXPECT_EQ(model.componentCount, direct.componentCount);
  EXPECT_EQ(model.parts.size(), direct.parts.size());
}

// Valve's text format: two bones along y, a bent frame, three triangles.
const char* const kSmd = R"(version 1
nodes
0 "hip" -1
1 "knee" 0
end
skeleton
time 0
0 0 0 0 0 0 0
1 0 1 0 0 0 0
time 1
0 0 0 0 0 0 0
1 0 1 0 0.5 0 0
end
triangles
cloth
0 0 0 0 0 0 1 0 0 1 0 1
0 1 0 0 0 0 1 1 0 1 0 1
0 1 1 0 0 0 1 1 1 2 0 0.5 1 0.5
cloth
0 0 0 0 0 0 1 0 0 1 0 1
0 1 1 0 0 0 1 1 1 2 0 0.5 1 0.5
0 0 1 0 0 0 1 0 1 2 0 0.5 1 0.5
cloth
0 0 1 0 0 0 1 0 1 2 0 0.5 1 0.5
0 1 1 0 0 0 1 1 1 2 0 0.5 1 0.5
0 1 2 0 0 0 1 1 1 1 1 1
end
)";

TEST(Assimp, ReadsBonesWeightsAndMotions) {
  const sample::Folder folder;
  write(folder / "cloth.smd", kSmd);
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
  const std::string text = kSmd;
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

}  // namespace
}  // namespace fascia
