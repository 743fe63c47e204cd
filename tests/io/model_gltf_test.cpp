#include <fascia/io/rig_export/model_gltf.h>

#include <gtest/gtest.h>

#include <cstdlib>

#include <fascia/io/file/child_process.h>
#include <fascia/io/file/file.h>
#include <fascia/io/picture/image.h>
#include <fascia/io/rig_import/rig_import.h>

#include "programs.h"
#include "rig_checks.h"
#include "sample.h"
#include "support/assets.h"

namespace fascia {
namespace {

using test::expectSuccess;

void writeAsGlb(const RiggedModel& model, const std::string& path) {
  gltfOf(model).writeGlb(path);
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

TEST(ModelGltf, ReadsBackAsItWas) {
  const sample::Folder folder;
  const RiggedModel model = tube();
  writeAsGlb(model, folder / "tube.glb");
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

TEST(ModelGltf, ClosesTheCycleOfAMotionThatLoops) {
  const sample::Folder folder;
  RiggedModel model = tube();
  model.motions[0].loop = true;
  writeAsGlb(model, folder / "tube.glb");
  const RiggedModel back = readRiggedModel(folder / "tube.glb");
  ASSERT_EQ(back.motions.size(), 1u);
  EXPECT_TRUE(back.motions[0].loop);
  EXPECT_NEAR(back.motions[0].duration_s(), model.motions[0].duration_s(), 1e-6);
}

TEST(ModelGltf, KeepsMoreThanFourInfluences) {
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
  writeAsGlb(model, folder / "tube.glb");
  const RiggedModel back = readRiggedModel(folder / "tube.glb");
  ASSERT_FALSE(back.weights.empty());
  for (const PointWeights& w : back.weights) {
    EXPECT_NEAR(w.weight[4], 0.1f, 1e-6f);
    EXPECT_EQ(w.weight[5], 0);
  }
}

TEST(ModelGltf, KhronosValidatorFindsNothing) {
  const char* module = std::getenv("GLTF_VALIDATOR");
  if (!module || findProgram("node").empty()) {
    GTEST_SKIP() << "set GLTF_VALIDATOR to the folder of the npm package gltf-validator";
  }
  const sample::Folder folder;
  writeAsGlb(tube(), folder / "a.glb");
  const std::string check = FASCIA_SOURCE_DIR "/tests/io/validate_gltf.js";
  expectSuccess("node", {check, module, folder / "a.glb"});
  if (const auto human = assetFile("makehuman-cc0/base.obj")) {
    writeAsGlb(readRiggedModel(human->string()), folder / "human.glb");
    expectSuccess("node", {check, module, folder / "human.glb"});
  }
}

TEST(ModelGltf, CarriesAWholeMakeHuman) {
  const auto path = assetFile("makehuman-cc0/base.obj");
  if (!path) GTEST_SKIP() << "the shared assets are not here";
  const sample::Folder folder;
  const RiggedModel human = readRiggedModel(path->string());
  writeAsGlb(human, folder / "human.glb");
  const RiggedModel back = readRiggedModel(folder / "human.glb");
  expectSameJoints(human, back);
  expectSameSurface(human, back);
  EXPECT_EQ(back.parts.size(), human.parts.size());
}

// What a person baked is looked up in the file by these numbers.
TEST(ModelGltf, NumbersNodesAsTheModelDoes) {
  const sample::Folder folder;
  writeFileWhole(folder / "cloth.smd", sample::kSmd);
  const RiggedModel model = readRiggedModel(folder / "cloth.smd");
  const GltfDocument document = gltfOf(model);
  const GltfPlace nodes = document.root()["nodes"];
  ASSERT_EQ(nodes.size(), model.joints.size() + model.parts.size());
  for (const RigJoint& joint : model.joints)
    EXPECT_EQ(nodes.at(static_cast<std::size_t>(joint.node))["name"].text(), joint.name);
  ASSERT_FALSE(model.parts.empty());
  for (const RigPart& part : model.parts) {
    const GltfPlace node = nodes.at(static_cast<std::size_t>(part.node));
    EXPECT_EQ(node["mesh"].index(1000), part.mesh);
    EXPECT_EQ(part.primitive, 0);
  }
}

}  // namespace
}  // namespace fascia
