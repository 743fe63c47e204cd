#include <fascia/io/rig_import/rig_import.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "rig_checks.h"
#include "support/assets.h"

namespace fascia {
namespace {

using namespace sample;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(RigImport, ReadsTheTube) {
  const RiggedModel m = imported(TubeRig());
  expectSound(m);
  EXPECT_THAT(m.notes, IsEmpty());
  ASSERT_EQ(m.joints.size(), 2u);
  EXPECT_EQ(m.joints[1].name, "upper");
  EXPECT_EQ(m.joints[1].node, 2);
  EXPECT_TRUE(m.joints[1].rest_world.translation_m.isApprox(Vec3(0, 1, 0)));
  EXPECT_EQ(m.points_m.size(), 12u);
  EXPECT_EQ(m.triangles.size(), 16u);
  EXPECT_EQ(m.componentCount, 1u);
  EXPECT_NEAR(m.height_m(), 2, 1e-6);
  EXPECT_EQ(m.parts.at(0).name, "body");
  EXPECT_GT(volume(m), 0);  // the triangles are counter-clockwise from outside
}

TEST(RigImport, ScalesEveryLength) {
  const RiggedModel m = imported(TubeRig(), 0.01);
  expectSound(m);
  EXPECT_NEAR(m.height_m(), 0.02, 1e-7);
  EXPECT_TRUE(m.joints[1].rest_world.translation_m.isApprox(Vec3(0, 0.01, 0)));
  EXPECT_THAT(m.notes, Contains(HasSubstr("give --scale 1")));
}

TEST(RigImport, TellsOfGiantsWithAProposal) {
  TubeRig rig;
  const RiggedModel m = imported(rig, 40);
  EXPECT_THAT(m.notes, Contains(HasSubstr("80 m tall")));
  EXPECT_THAT(m.notes, Contains(HasSubstr("centimetres give --scale 0.4")));
}

// The armature turns, stretches and mirrors everything: points go along, joint frames stay rigid.
TEST(RigImport, CarriesAnyScaleOfTheTreeIntoThePoints) {
  for (const std::string scale : {"[2,2,2]", "[1,3,0.5]", "[-1,1,1]", "[-2,-2,-2]"}) {
    TubeRig rig;
    rig.file.nodes =
        R"([{"name":"Armature","children":[1,3],"rotation":[0.70710678,0,0,0.70710678],"scale":)" +
        scale + R"(,"translation":[5,0,0]},{"name":"lower","children":[2]},)" +
        R"({"name":"upper","translation":[0,1,0]},{"name":"body","mesh":0,"skin":0}])";
    rig.file.animations =
        "[" + rig.animation("still", 2, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, 0, 1}) + "]";
    const RiggedModel m = imported(rig);
    expectSound(m);
    double s[3];
    std::sscanf(scale.c_str(), "[%lf,%lf,%lf]", &s[0], &s[1], &s[2]);
    EXPECT_TRUE(m.joints[1].rest_world.translation_m.isApprox(Vec3(5, 0, s[1]), 1e-6)) << scale;
    for (std::size_t i = 0; i < 12; ++i) {  // y became z
      const std::vector<float> ring = TubeRig::ringPositions();
      const Vec3 expected(5 + s[0] * ring[3 * i], -s[2] * ring[3 * i + 2], s[1] * ring[3 * i + 1]);
      EXPECT_TRUE(m.points_m[i].cast<double>().isApprox(expected, 1e-5)) << scale;
    }
    EXPECT_GT(volume(m), 0) << scale;
    std::vector<Transform> world;
    poseRig(m, 0, 0, world);
    EXPECT_LT(largestDistance(skinned(m, world), m.points_m), 1e-5) << scale;
  }
}

TEST(RigImport, TakesTheBindPoseFromTheSkinNotFromTheNodes) {
  TubeRig rig;
  rig.file.nodes =
      R"([{"name":"Armature","children":[1,3]},{"name":"lower","children":[2]},)"
      R"({"name":"upper","translation":[0,1,0],"rotation":[0.70710678,0,0,0.70710678]},)"
      R"({"name":"body","mesh":0,"skin":0}])";
  const RiggedModel m = imported(rig);
  expectSound(m);
  EXPECT_TRUE(m.joints[1].rest_world.rotation.isIdentity(1e-6));
  EXPECT_NEAR(m.height_m(), 2, 1e-6);
  EXPECT_THAT(m.notes, Contains(HasSubstr("1 joints' nodes are not in the bind pose")));
}

TEST(RigImport, BindsByTheNodesWhereMatricesAreMissing) {
  TubeRig rig;
  rig.file.skins = R"([{"joints":[1,2]}])";
  const RiggedModel m = imported(rig);
  expectSound(m);
  EXPECT_THAT(m.notes, Contains(HasSubstr("no inverse bind matrices")));
  EXPECT_TRUE(m.joints[1].rest_world.translation_m.isApprox(Vec3(0, 1, 0)));
  EXPECT_NEAR(m.points_m[11].y(), 3, 1e-6);  // the upper ring is a metre above its joint's origin
}

TEST(RigImport, MendsBindMatricesThatAreNoTransforms) {
  TubeRig rig;
  std::vector<float> binds = TubeRig::binds();
  binds[20] = std::numeric_limits<float>::quiet_NaN();
  rig.inverseBinds = rig.file.add(binds, 16, "MAT4");
  rig.file.skins = rig.skinOf("[1,2]");
  const RiggedModel m = imported(rig);
  expectSound(m);
  EXPECT_THAT(m.notes, Contains(HasSubstr("1 inverse bind matrices are no transforms")));
  EXPECT_TRUE(m.joints[1].rest_world.translation_m.isApprox(Vec3(0, 1, 0)));
  EXPECT_NEAR(m.height_m(), 2, 1e-6);
}

// Two meshes with a skin each; the second one's mesh space is shifted by its own binds.
TEST(RigImport, MergesSkinsByTheirNodes) {
  TubeRig rig;
  std::vector<float> shifted = TubeRig::binds();
  for (const std::size_t column : {12u, 28u}) shifted[column] -= 3;  // this mesh stands at x = 3
  const int second = rig.file.add(shifted, 16, "MAT4");
  std::vector<float> moved = TubeRig::ringPositions();
  for (std::size_t i = 0; i < moved.size(); i += 3) moved[i] += 3;
  const int positions = rig.file.add(moved, 3, "VEC3");
  const std::string first = TubeRig::meshOf(rig.primitive());
  rig.positions = positions;
  rig.file.meshes = "[" + first + "," + TubeRig::meshOf(rig.primitive()) + "]";
  rig.file.skins = R"([{"joints":[1,2],"inverseBindMatrices":)" + std::to_string(rig.inverseBinds) +
                   R"(},{"joints":[1,2],"inverseBindMatrices":)" + std::to_string(second) + "}]";
  rig.file.nodes = R"([{"name":"Armature","children":[1,3,4]},{"name":"lower","children":[2]},)"
                   R"({"name":"upper","translation":[0,1,0]},{"name":"body","mesh":0,"skin":0},)"
                   R"({"name":"coat","mesh":1,"skin":1}])";
  const RiggedModel m = imported(rig);
  expectSound(m);
  EXPECT_EQ(m.joints.size(), 2u);
  EXPECT_EQ(m.parts.size(), 2u);
  EXPECT_THAT(m.notes, IsEmpty());  // both bind poses agree: the meshes lie on each other
  for (std::size_t v = 0; v < 12; ++v) {
    const auto& a = m.points_m[m.vertices[v].point];
    EXPECT_LT((a - m.points_m[m.vertices[v + 12].point]).norm(), 1e-6f);
  }
  EXPECT_EQ(m.componentCount, 2u);  // and are not glued face to face
}

TEST(RigImport, BendsASkinThatDisagreesToTheFirstOnesBindPose) {
  TubeRig rig;
  std::vector<float> bent = TubeRig::binds();  // its upper joint was turned by 90 degrees about x
  const float turned[16] = {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 1, 1};
  std::copy(turned, turned + 16, bent.begin() + 16);
  const int second = rig.file.add(bent, 16, "MAT4");
  rig.file.skins = R"([{"joints":[1,2],"inverseBindMatrices":)" + std::to_string(rig.inverseBinds) +
                   R"(},{"joints":[1,2],"inverseBindMatrices":)" + std::to_string(second) + "}]";
  rig.file.nodes = R"([{"name":"Armature","children":[1,3,4]},{"name":"lower","children":[2]},)"
                   R"({"name":"upper","translation":[0,1,0]},{"name":"body","mesh":0,"skin":0},)"
                   R"({"name":"coat","mesh":0,"skin":1}])";
  const RiggedModel m = imported(rig);
  expectSound(m);
  EXPECT_THAT(m.notes, Contains(HasSubstr("1 skins disagree")));
  EXPECT_TRUE(m.joints[1].rest_world.translation_m.isApprox(Vec3(0, 1, 0)));
}

TEST(RigImport, JoinsSeveralRootsByOneMore) {
  TubeRig rig;
  rig.file.nodes = R"([{"name":"Armature","children":[1,2,3]},{"name":"lower"},)"
                   R"({"name":"upper","translation":[0,1,0]},{"name":"body","mesh":0,"skin":0}])";
  const RiggedModel m = imported(rig);
  expectSound(m);
  ASSERT_EQ(m.joints.size(), 3u);
  EXPECT_EQ(m.joints[0].name, "fascia_root");
  EXPECT_EQ(m.joints[0].node, -1);
  EXPECT_EQ(m.joints[2].parent, 0);
  EXPECT_EQ(m.weights[8].joint[0], 2);
}

TEST(RigImport, NamesJointsThatShareANameOrHaveNone) {
  TubeRig rig;
  rig.file.nodes = R"([{"children":[1,3]},{"name":"bone","children":[2]},)"
                   R"({"name":"bone","translation":[0,1,0]},{"mesh":0,"skin":0}])";
  const RiggedModel doubled = imported(rig);
  expectSound(doubled);
  EXPECT_EQ(doubled.joints[1].name, "bone (2)");
  rig.file.nodes = R"([{"children":[1,3]},{"name":"joint 1","children":[2]},)"
                   R"({"translation":[0,1,0]},{"mesh":0,"skin":0}])";
  const RiggedModel unnamed = imported(rig);
  expectSound(unnamed);
  EXPECT_EQ(unnamed.joints[0].name, "joint 1");
  EXPECT_THAT(unnamed.notes, Contains(HasSubstr("no name")));
}

TEST(RigImport, UnderstandsStripsFansAndRunsWithoutIndices) {
  TubeRig rig;
  rig.indices = rig.file.add<std::uint16_t>({0, 1, 4, 5, 8, 9}, 1, "SCALAR");
  const int fan = rig.file.add<std::uint16_t>({0, 1, 5, 4}, 1, "SCALAR");
  const std::string strip = rig.primitive(R"(,"mode":5)");
  rig.indices = fan;
  const std::string fanned = rig.primitive(R"(,"mode":6)");
  const std::string loose = R"({"attributes":{)" + rig.attributes() + "}}";
  rig.file.meshes = R"([{"primitives":[)" + strip + "," + fanned + "," + loose + "]}]";
  const RiggedModel m = imported(rig);
  expectSound(m);
  ASSERT_EQ(m.parts.size(), 3u);
  EXPECT_EQ(m.parts[0].triangleCount, 4u);
  EXPECT_EQ(m.parts[1].triangleCount, 2u);
  EXPECT_EQ(m.parts[2].triangleCount, 4u);
  const auto facing = [&](std::size_t t) {  // strips alternate: all triangles face one way
    const auto& [a, b, c] = m.drawnTriangles[t];
    const auto p = [&](std::uint32_t v) { return m.points_m[m.vertices[v].point]; };
    return (p(b) - p(a)).cross(p(c) - p(a)).x() > 0;
  };
  for (std::size_t t = 1; t < 6; ++t) EXPECT_EQ(facing(t), facing(0)) << t;
}

TEST(RigImport, ReadsEightInfluencesAndQuantisedAttributes) {
  TubeRig rig;
  std::vector<std::uint8_t> joints, moreJoints, weights, moreWeights;
  for (int v = 0; v < 12; ++v) {
    joints.insert(joints.end(), {0, 1, 0, 1});
    moreJoints.insert(moreJoints.end(), {1, 0, 0, 0});
    weights.insert(weights.end(), {51, 51, 0, 51});
    moreWeights.insert(moreWeights.end(), {51, 51, 0, 0});
  }
  std::vector<std::int16_t> positions;
  const std::vector<float> ring = TubeRig::ringPositions();
  for (std::size_t v = 0; v < 12; ++v) {  // padded to four: elements begin at multiples of 4 bytes
    for (std::size_t c = 0; c < 3; ++c) {
      positions.push_back(static_cast<std::int16_t>(ring[3 * v + c] * 1000));
    }
    positions.push_back(0);
  }
  rig.file.addView(positions.data(), positions.size() * 2, R"(,"byteStride":8)");
  rig.positions =
      rig.file.addAccessor(R"("bufferView":)" + std::to_string(rig.file.views.size() - 1) +
                           R"(,"componentType":5122,"count":12,"type":"VEC3")");
  rig.joints = rig.file.add(joints, 4, "VEC4");
  rig.weights = rig.file.add(weights, 4, "VEC4", R"(,"normalized":true)");
  const int j1 = rig.file.add(moreJoints, 4, "VEC4");
  const int w1 = rig.file.add(moreWeights, 4, "VEC4", R"(,"normalized":true)");
  rig.file.meshes = R"([{"primitives":[{"attributes":{)" + rig.attributes() + R"(,"JOINTS_1":)" +
                    std::to_string(j1) + R"(,"WEIGHTS_1":)" + std::to_string(w1) +
                    R"(},"indices":)" + std::to_string(rig.indices) + "}]}]";
  const RiggedModel m = imported(rig, 0.001);
  expectSound(m);
  EXPECT_NEAR(m.height_m(), 2, 1e-4);
  EXPECT_EQ(m.weights[0].joint[0], 1);  // the same joint's shares are added up
  EXPECT_NEAR(m.weights[0].weight[0], 0.6, 1e-6);
  EXPECT_NEAR(m.weights[0].weight[1], 0.4, 1e-6);
}

TEST(RigImport, MendsWeightsAndSaysSo) {
  TubeRig rig;
  std::vector<float> weights = TubeRig::ringWeights();
  std::vector<std::uint8_t> joints = TubeRig::ringJoints();
  weights[0] = std::numeric_limits<float>::quiet_NaN();  // vertex 0: nothing left
  weights[4] = 5;                                        // vertex 1: sums to five
  weights[8 + 1] = -1;                                   // vertex 2
  joints[12] = 77;                                       // vertex 3: its only joint is not there
  rig.weights = rig.file.add(weights, 4, "VEC4");
  rig.joints = rig.file.add(joints, 4, "VEC4");
  rig.file.meshes = "[" + TubeRig::meshOf(rig.primitive()) + "]";
  const RiggedModel m = imported(rig);
  expectSound(m);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(m.weights[i].joint[0], 0);
    EXPECT_EQ(m.weights[i].weight[0], 1);
  }
  EXPECT_THAT(m.notes, Contains(HasSubstr("2 vertices have no weights")));
  EXPECT_THAT(m.notes, Contains(HasSubstr("1 vertices have weights that do not sum to one")));
  EXPECT_THAT(m.notes, Contains(HasSubstr("2 vertices have weights that are negative")));
  EXPECT_THAT(m.notes, Contains(HasSubstr("1 vertices are moved by joints that are not there")));
}

TEST(RigImport, SaysWhereItKeepsOnlyTheHeaviestWeights) {
  TubeRig rig;
  const std::vector<std::uint8_t> joints(4 * 12, 1);
  const std::vector<float> weights(4 * 12, 0.1f);
  std::string more;
  for (const char* set : {"1", "2"})
    more += std::string(R"(,"JOINTS_)") + set +
            "\":" + std::to_string(rig.file.add(joints, 4, "VEC4")) + R"(,"WEIGHTS_)" + set +
            "\":" + std::to_string(rig.file.add(weights, 4, "VEC4"));
  rig.file.meshes = R"([{"primitives":[{"attributes":{)" + rig.attributes() + more +
                    R"(},"indices":)" + std::to_string(rig.indices) + "}]}]";
  const RiggedModel m = imported(rig);
  expectSound(m);
  EXPECT_THAT(m.notes, Contains(HasSubstr("vertices have more than 8 weights")));
}

TEST(RigImport, MendsPositionsAndTriangles) {
  TubeRig rig;
  std::vector<float> positions = TubeRig::ringPositions();
  positions[5] = std::numeric_limits<float>::infinity();
  std::vector<std::uint16_t> indices = TubeRig::ringIndices();
  indices[47] = 999;
  indices.insert(indices.end(), {0, 0, 3, 8, 9, 10, 8, 9, 10});
  rig.positions = rig.file.add(positions, 3, "VEC3");
  rig.indices = rig.file.add(indices, 1, "SCALAR");
  rig.file.meshes = "[" + TubeRig::meshOf(rig.primitive()) + "]";
  const RiggedModel m = imported(rig);
  expectSound(m);
  EXPECT_THAT(m.notes, Contains(HasSubstr("1 vertices have positions that are no numbers")));
  EXPECT_THAT(m.notes, Contains(HasSubstr("1 triangles name vertices that are not there")));
  EXPECT_THAT(m.notes, Contains(HasSubstr("lie on others of the same points")));
  EXPECT_EQ(m.drawnTriangles.size(), 18u);
  EXPECT_LT(m.triangles.size(), m.drawnTriangles.size());
}

TEST(RigImport, HangsMeshesWithoutASkinOnTheirJoint) {
  TubeRig rig;
  const std::string plain = R"({"attributes":{"POSITION":)" + std::to_string(rig.positions) +
                            R"(},"indices":)" + std::to_string(rig.indices) + "}";
  rig.file.meshes = "[" + TubeRig::meshOf(rig.primitive()) + "," + TubeRig::meshOf(plain) + "]";
  rig.file.nodes = R"([{"children":[1,3,5]},{"name":"lower","children":[2]},)"
                   R"({"name":"upper","translation":[0,1,0],"children":[4]},{"mesh":0,"skin":0},)"
                   R"({"name":"hat","mesh":1,"translation":[0,1,0],"scale":[0.1,0.1,0.1]},)"
                   R"({"name":"floor","mesh":1,"translation":[9,0,0]}])";
  const RiggedModel m = imported(rig);
  expectSound(m);
  ASSERT_EQ(m.parts.size(), 3u);
  EXPECT_EQ(m.parts[0].name, "hat");  // depth first: below its joint
  const auto weightsOf = [&](std::size_t part) {
    return m.weights[m.vertices[m.parts[part].firstVertex].point];
  };
  EXPECT_EQ(weightsOf(0).joint[0], 1);
  EXPECT_EQ(weightsOf(0).weight[0], 1);
  EXPECT_NEAR(m.points_m[m.vertices[m.parts[0].firstVertex].point].y(), 2, 1e-6);
  EXPECT_EQ(m.parts[2].name, "floor");
  EXPECT_EQ(weightsOf(2).joint[0], 0);
  EXPECT_THAT(m.notes, Contains(HasSubstr("1 meshes without a skin hang on a joint")));
  EXPECT_THAT(m.notes, Contains(HasSubstr("1 meshes have neither a skin nor a joint above")));
}

TEST(RigImport, AsksForARigWhereThereIsNone) {
  TubeRig rig;
  rig.file.nodes = R"([{"mesh":0}])";
  EXPECT_THAT(complaint(rig), HasSubstr("needs a rigged character"));
  rig.file.nodes = R"([{"name":"a"}])";
  EXPECT_THAT(complaint(rig), HasSubstr("needs a rigged character"));
}

TEST(RigImport, RefusesTreesThatAreNone) {
  TubeRig rig;
  rig.file.nodes = R"([{"children":[3]},{"children":[2]},{"children":[1]},{"mesh":0,"skin":0}])";
  EXPECT_THAT(complaint(rig), HasSubstr("below themselves"));
  rig.file.nodes = R"([{"children":[1,9]},{"mesh":0,"skin":0}])";
  EXPECT_THAT(complaint(rig), HasSubstr("/nodes/0/children/1"));
}

TEST(RigImport, AbsurdCountsAreRefusedAtOnce) {
  TubeRig rig;
  rig.positions = rig.file.addAccessor(R"("componentType":5126,"count":4000000000,"type":"VEC3")");
  rig.file.meshes = "[" + TubeRig::meshOf(rig.primitive()) + "]";
  EXPECT_THAT(complaint(rig), HasSubstr("4000000000"));
  TubeRig many;
  many.indices = many.file.addAccessor(R"("componentType":5123,"count":1000000,"type":"SCALAR")");
  std::string primitives;
  for (int i = 0; i < 100; ++i) primitives += std::string(i > 0 ? "," : "") + many.primitive();
  many.file.meshes = "[" + TubeRig::meshOf(primitives) + "]";
  EXPECT_THAT(complaint(many), HasSubstr("corners of triangles"));
}

struct RealRig {
  const char* file;
  std::size_t joints, vertices, triangles, motions;
  const char* aJoint;
  const char* restMotion;
  double
      restDistance;  // of the size: how far that motion is from the bind pose, in the file itself
};

class RealRigs : public testing::TestWithParam<RealRig> {};

TEST_P(RealRigs, AreReadAsTheyAre) {
  const RealRig& expected = GetParam();
  const auto file = assetFile(expected.file);
  if (!file) GTEST_SKIP() << "the shared assets are not here";
  const RiggedModel m = readRiggedModel(file->string());
  expectSound(m);
  EXPECT_EQ(m.joints.size(), expected.joints);
  EXPECT_EQ(m.vertices.size(), expected.vertices);
  EXPECT_EQ(m.drawnTriangles.size(), expected.triangles);
  EXPECT_EQ(m.motions.size(), expected.motions);
  EXPECT_LT(m.points_m.size(), m.vertices.size() + 1);
  const auto named = [&](const RigJoint& j) { return j.name == expected.aJoint; };
  EXPECT_EQ(std::count_if(m.joints.begin(), m.joints.end(), named), 1);
  for (std::size_t i = 0; i < m.motions.size(); ++i) {
    if (m.motions[i].name != expected.restMotion) continue;
    std::vector<Transform> world;  // this motion holds the bind pose
    poseRig(m, static_cast<int>(i), 0, world);
    EXPECT_LT(largestDistance(skinned(m, world), m.points_m), expected.restDistance * m.size_m());
  }
}

INSTANTIATE_TEST_SUITE_P(
    Assets, RealRigs,
    testing::Values(RealRig{"mesh2motion-cc0/fox-animations.glb", 49, 1250, 1654, 14, "Spine_2",
                            "Rest Pose", 0.006},
                    RealRig{"mesh2motion-cc0/bird-animations.glb", 55, 1797, 2166, 5, "wing_3_L",
                            "Rest Pose", 0.006},
                    RealRig{"mesh2motion-cc0/dragon-animations.glb", 101, 2905, 3498, 5, "spine_0",
                            "Rest Pose", 0.006},
                    RealRig{"mesh2motion-cc0/snake-animations.glb", 28, 995, 1130, 8, "head",
                            "Rest Pose", 0.006},
                    RealRig{"mesh2motion-cc0/human-base-animations.glb", 53, 8691, 13721, 44,
                            "DEF-hips", "T-Pose", 1e-5},
                    RealRig{"khronos-gltf-tests/Fox.glb", 24, 1728, 576, 3, "b_Hip_01", "", 0},
                    RealRig{"khronos-gltf-tests/SimpleSkin.gltf", 2, 10, 8, 1, "joint 0", "", 0},
                    RealRig{"webxr-generic-hand/left.glb", 26, 1360, 2314, 0, "wrist", "", 0}));

TEST(RigImport, KhronosFoxIsToldToBeInCentimetres) {
  const auto file = assetFile("khronos-gltf-tests/Fox.glb");
  if (!file) GTEST_SKIP() << "the shared assets are not here";
  EXPECT_THAT(readRiggedModel(file->string()).notes, Contains(HasSubstr("--scale 0.01")));
  EXPECT_NEAR(readRiggedModel(file->string(), {0.01}).height_m(), 0.79, 0.01);
}

TEST(RigImport, SaysWhatItCannotRead) {
  EXPECT_THROW(readRiggedModel("a.txt"), Error);
  EXPECT_THROW(readRiggedModel("missing.glb"), Error);
  EXPECT_THROW(readRiggedModel("a.glb", {0}), Error);
}

}  // namespace
}  // namespace fascia
