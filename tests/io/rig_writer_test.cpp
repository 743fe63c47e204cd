#include <fascia/io/rig_export/rig_writer.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>

#include <fascia/io/cache/mdd.h>
#include <fascia/io/cache/pc2.h>
#include <fascia/io/file/child_process.h>
#include <fascia/io/file/file.h>
#include <fascia/io/rig_export/rig_writer_player.h>
#include <fascia/io/rig_import/rig_import.h>
#include <fascia/rig/linear_blend.h>

#include "gltf_sample.h"
#include "programs.h"
#include "sample.h"
#include "support/assets.h"

namespace fascia {
namespace {

using test::expectSuccess;

// Where a point is in the bind pose at a time, in the place of the rest.
using Bulge = std::function<Eigen::Vector3f(const Eigen::Vector3f& rest, double time_s)>;

// A rig and a made-up simulation of it: its own skinning of bulging points.
struct Simulated {
  RiggedModel model;
  Recording recording;
  std::vector<std::vector<Transform>> joints_world;
  std::string motion;
  double scale = 1;

  RigClip clip() const { return {model, recording, joints_world, motion, scale}; }
};

Simulated simulate(const std::string& path, int motion, std::size_t frames, double rate_hz,
                   const Bulge& bulge, double scale = 1) {
  Simulated out;
  out.scale = scale;
  out.model = readRiggedModel(path, RigImportOptions{scale});
  out.motion = motion < 0 ? "new" : out.model.motions.at(static_cast<std::size_t>(motion)).name;
  out.recording.frame_rate_hz = rate_hz;
  RiggedModel bulging = out.model;
  std::vector<Transform> world, moved;
  std::vector<Eigen::Vector3f> points(out.model.points_m.size());
  for (std::size_t f = 0; f < frames; ++f) {
    const double time = static_cast<double>(f) / rate_hz;
    for (std::size_t i = 0; i < points.size(); ++i) {
      bulging.points_m[i] = bulge(out.model.points_m[i], time);
    }
    poseRig(out.model, motion, time, world);
    restToFrame(out.model, world, moved);
    LinearBlend(bulging).deform(moved, points);
    Recording::Frame& frame = out.recording.frames.emplace_back();
    frame.time_s = time;
    for (const RigVertex& v : out.model.vertices) frame.skin_m.push_back(points[v.point]);
    out.joints_world.push_back(world);
  }
  return out;
}

// The top of the tube sways as a whole: one helper bone, or two morph targets, can follow.
Eigen::Vector3f swaying(const Eigen::Vector3f& p, double time_s) {
  if (p.y() < 1.5f) return p;
  const auto s = static_cast<float>(0.1 * std::sin(6 * time_s)),
             c = static_cast<float>(0.05 * std::cos(6 * time_s));
  return p + Eigen::Vector3f(s, 0, c);
}

// A hundredth of what is missing without helpers: what is left when the fit stops.
constexpr double kFollowed_mm = 0.5;

constexpr const char* kBend = "bend";
const std::vector<float> kTimes{0.5f, 1.f, 1.5f};
const std::vector<float> kTurns{0, 0, 0, 1, 0.3826834f, 0, 0, 0.9238795f, 0, 0, 0, 1};
const std::vector<float> kShifts{0, 0, 0, 0, 0.1f, 0, 0, 0, 0};

// The tube with two animations; the first begins at half a second.
sample::TubeRig animatedTube() {
  sample::TubeRig rig;
  rig.file.animations = "[" + rig.animation(kBend, 2, "rotation", kTimes, kTurns) + "," +
                        rig.animation("hop", 1, "translation", kTimes, kShifts) + "]";
  return rig;
}

std::string write(const sample::Folder& folder, const sample::TubeRig& rig) {
  const std::string path = folder / "rig.glb";
  writeFileWhole(path, rig.file.glb());
  return path;
}

GltfPlace animationOf(const GltfDocument& document, const std::string& name) {
  const GltfPlace animations = document.root()["animations"];
  for (std::size_t i = 0; i < animations.size(); ++i) {
    if (animations.at(i)["name"].textOr("") == name) return animations.at(i);
  }
  ADD_FAILURE() << name;
  return animations;
}

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
  EXPECT_EQ(document.floats(first["input"].index(1000), 1), kTimes);
  EXPECT_EQ(document.floats(first["output"].index(1000), 4), kTurns);
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
  rig.file.animations = "[" + rig.animation(kBend, 1, "rotation", kTimes, kTurns) + "]";
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

// Runs a program on files made here; its complaints are the test's.
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
  void writeFrames(const std::string& glb, const std::string& path, std::size_t ownTargets) {
    const GltfDocument document = GltfDocument::read(glb);
    const RigPlayer player(document, fox_.model.parts, 0, 1, ownTargets);
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
  writeFrames(folder / "fox.glb", folder / "frames.f32", 0);
  expectSameInBlender(folder / "fox.glb", folder / "frames.f32", fox_.motion);
}

TEST_F(BakedFox, BlenderPlaysTheMorphs) {
  if (findProgram("blender").empty()) GTEST_SKIP() << "Blender is not installed";
  const sample::Folder folder;
  const RigBakeReport report = writeRigAsMorphs(fox_.clip(), {}, folder / "fox.glb");
  writeFrames(folder / "fox.glb", folder / "frames.f32", report.added);
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
