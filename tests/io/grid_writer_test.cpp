#include <fascia/io/glb_export/grid_writer.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>

#include <fascia/io/file/child_process.h>
#include <fascia/io/glb_export/grid_rig.h>

#include "played_gltf.h"
#include "sample.h"

namespace fascia {
namespace {

// An arm of two balls in an elastic skin that bends and that hops, with a watch on its elbow.
const char* const kMovingArm = R"({
  "fascia": 1,
  "name": "arm",
  "skeleton": [
    {"name": "shoulder", "offset_m": [0, 1, 0], "dofs": {"ty": {"min_m": 0, "max_m": 1}}},
    {"name": "elbow", "parent": "shoulder", "offset_m": [0, -0.3, 0], "dofs": {"rx": [-90, 90]}},
    {"name": "hand", "parent": "elbow", "offset_m": [0, -0.2, 0]}
  ],
  "solids": [
    {"name": "upper", "joint": "shoulder", "radius_m": 0.2},
    {"name": "lower", "joint": "elbow", "radius_m": 0.15}
  ],
  "ornaments": [
    {"name": "watch", "joint": "elbow", "radius_m": 0.02, "position_m": [0, 0, 0.2]},
    {"name": "ring", "joint": "hand", "radius_m": 0.02, "position_m": [0, 0, 0.1]}
  ],
  "skin": {"grid": [16, 12], "bottom": {"joint": "elbow", "axis": [0, -1, 0]},
           "top": {"joint": "shoulder", "axis": [0, 1, 0]}},
  "motions": [
    {"name": "bend", "tracks": [
      {"joint": "elbow", "dof": "rx", "keys": [[0, 0], [0.3, 60], [0.6, -20], [1, 0]]}]},
    {"name": "hop", "tracks": [
      {"joint": "shoulder", "dof": "ty", "keys": [[0, 0], [0.2, 0.2], [0.5, 0]]}]}
  ],
  "simulation": {"settle_s": 0.1}
})";

class MovingArm : public ::testing::Test {
 protected:
  MovingArm() : character_(readCharacterText(kMovingArm).def) {
    for (const int motion : {0, 1})
      recordings_.push_back(record(character_, character_.source(motion)));
  }

  static GridBakeOptions options(GridWay way) {
    GridBakeOptions out;
    out.way = way;
    out.bones.helperBones = 6;
    out.bones.iterations = 4;
    out.morphs.targets = 12;
    out.morphs.sparsity = 0;
    return out;
  }

  GridBakeReport write(const GridBakeOptions& o) const {
    return writeGridGlb(character_, std::vector<const Recording*>{&recordings_[0], &recordings_[1]},
                        o, file());
  }
  GridBakeReport write(GridWay way) const { return write(options(way)); }
  std::string file() const { return folder_ / "arm.glb"; }

  // RMS and largest distance of what another reader plays to a recording, in mm.
  static BakeError measured(const sample::PlayedGltf& gltf, const Recording& recording) {
    double sum = 0, largest = 0;
    std::size_t count = 0;
    for (const Recording::Frame& frame : recording.frames) {
      const auto found = gltf.vertices(gltf.nodeNamed("skin"),
                                       gltf.animationNamed(recording.motion), frame.time_s);
      EXPECT_EQ(found.size(), frame.skin_m.size());
      for (std::size_t v = 0; v < found.size(); ++v, ++count) {
        const double e = (found[v] - frame.skin_m[v].cast<double>()).squaredNorm();
        sum += e;
        largest = std::max(largest, e);
      }
    }
    return {1e3 * std::sqrt(sum / static_cast<double>(count)), 1e3 * std::sqrt(largest)};
  }

  sample::Folder folder_;
  Character character_;
  std::vector<Recording> recordings_;
};

TEST_F(MovingArm, AnotherReaderMeasuresTheErrorThatIsTold) {
  for (const GridWay way : {GridWay::bones, GridWay::morphs}) {
    const GridBakeReport report = write(way);
    EXPECT_EQ(report.bytes, std::filesystem::file_size(file()));
    EXPECT_GT(report.added, 2u);
    const sample::PlayedGltf gltf(file());
    ASSERT_EQ(report.errors.size(), 2u);
    for (std::size_t r = 0; r < 2; ++r) {
      const BakeError found = measured(gltf, recordings_[r]);
      EXPECT_NEAR(found.rms_mm, report.errors[r].rms_mm, 1e-3 + 0.01 * found.rms_mm);
      EXPECT_NEAR(found.max_mm, report.errors[r].max_mm, 1e-3 + 0.01 * found.max_mm);
      EXPECT_LT(found.rms_mm, 3) << recordings_[r].motion;
      EXPECT_GT(found.rms_mm, 1e-4);
    }
  }
}

TEST_F(MovingArm, MoreHelpersAndMoreTargetsComeNearer) {
  const auto rms_mm = [&](const GridBakeOptions& o) { return write(o).errors[0].rms_mm; };
  GridBakeOptions bones = options(GridWay::bones), morphs = options(GridWay::morphs);
  const double six = rms_mm(bones), twelve = rms_mm(morphs);
  bones.bones.helperBones = 0;
  morphs.morphs.targets = 3;
  EXPECT_LT(six, 0.6 * rms_mm(bones));
  EXPECT_LT(twelve, 0.6 * rms_mm(morphs));
}

// Weights of the joints alone carry a skin that does nothing else.
TEST_F(MovingArm, AStiffMotionNeedsNoHelpers) {
  const GridRig rig = gridRigOf(character_);
  Recording stiff = recordings_[1];
  for (Recording::Frame& frame : stiff.frames) {
    const auto lift = Eigen::Vector3f(0, static_cast<float>(frame.posture[0]), 0);
    for (std::size_t v = 0; v < frame.skin_m.size(); ++v)
      frame.skin_m[v] = rig.surface.positions[v] + lift;
  }
  GridBakeOptions bones = options(GridWay::bones);
  bones.bones.helperBones = 0;
  const Recording* const one = &stiff;
  const GridBakeReport report = writeGridGlb(character_, {&one, 1}, bones, file());
  EXPECT_LT(report.errors[0].max_mm, 0.05);
  EXPECT_LT(measured(sample::PlayedGltf(file()), stiff).max_mm, 0.05);
}

TEST_F(MovingArm, MotionsShareOneBasisAndEveryNodeThatMovesIsInAllOfThem) {
  for (const GridWay way : {GridWay::bones, GridWay::morphs}) {
    write(way);
    const sample::PlayedGltf gltf(file());
    ASSERT_EQ(gltf.model.animations.size(), 2u);
    EXPECT_EQ(gltf.model.meshes.size(), 3u);  // the skin and two ornaments
    const auto moved = [&](const char* motion) {
      std::set<std::pair<int, std::string>> out;
      for (const tinygltf::AnimationChannel& c : gltf.animationNamed(motion)->channels)
        out.emplace(c.target_node, c.target_path);
      return out;
    };
    EXPECT_EQ(moved("bend"), moved("hop"));
    EXPECT_EQ(moved("bend").count({gltf.nodeNamed("elbow"), "rotation"}), 1u);
    EXPECT_EQ(moved("bend").count({gltf.nodeNamed("hand"), "rotation"}), 0u);
  }
}

TEST_F(MovingArm, OrnamentsRideOnTheirJoints) {
  write(GridWay::bones);
  const sample::PlayedGltf gltf(file());
  const int watch = gltf.nodeNamed("watch"), ring = gltf.nodeNamed("ring");
  const auto& elbow = gltf.model.nodes[static_cast<std::size_t>(gltf.nodeNamed("elbow"))];
  EXPECT_EQ(std::count(elbow.children.begin(), elbow.children.end(), watch), 1);
  const auto& nodes = gltf.model.nodes;
  EXPECT_EQ(nodes[static_cast<std::size_t>(watch)].skin, -1);
  // Both are one shape: its vertices are there once.
  const auto positions = [&](int node) {
    const int mesh = nodes[static_cast<std::size_t>(node)].mesh;
    return gltf.model.meshes[static_cast<std::size_t>(mesh)].primitives[0].attributes.at(
        "POSITION");
  };
  EXPECT_EQ(positions(watch), positions(ring));
  Posture posture = character_.skeleton().restPosture();
  PosedSkeleton posed;
  for (const Recording::Frame& frame : recordings_[0].frames) {
    posture.values = frame.posture;
    character_.skeleton().pose(posture, posed);
    const auto world = gltf.nodes(gltf.animationNamed("bend"), frame.time_s);
    const Vec3 ours = posed.joint_world[1].point({0, 0, 0.2});
    EXPECT_LT((world[static_cast<std::size_t>(watch)].translation() - ours).norm(), 1e-4);
  }
}

TEST_F(MovingArm, AtRestItShowsTheRestPosture) {
  for (const GridWay way : {GridWay::bones, GridWay::morphs}) {
    write(way);
    const sample::PlayedGltf gltf(file());
    const GridRig rig = gridRigOf(character_);
    const auto found = gltf.vertices(gltf.nodeNamed("skin"), nullptr, 0);
    for (std::size_t v = 0; v < found.size(); ++v)
      EXPECT_LT((found[v] - rig.surface.positions[v].cast<double>()).norm(), 2e-6);
  }
}

TEST_F(MovingArm, BothAreSmallerThanEveryFrame) {
  GlbOptions whole;
  whole.tolerance_m = 0;
  const std::size_t frames = writeGlb(character_, recordings_[0], file(), whole).bytes;
  for (const GridWay way : {GridWay::bones, GridWay::morphs})
    EXPECT_LT(write(way).bytes, frames / 3);
}

TEST_F(MovingArm, WhatIsWrongLeavesNoFile) {
  const auto refused = [&](const std::vector<const Recording*>& recordings) {
    EXPECT_THROW(writeGridGlb(character_, recordings, options(GridWay::bones), file()), Error);
  };
  refused({});
  refused({&recordings_[0], &recordings_[0]});  // two of one name
  Recording broken = recordings_[0];
  broken.frames[1].skin_m[5].x() = std::nanf("");
  refused({&broken});
  const Recording other = sample::tube(character_.skeleton().valueCount(), 3, 8, 8);
  refused({&other});
  EXPECT_EQ(folder_.entryCount(), 0u);
}

TEST_F(MovingArm, KhronosValidatorFindsNothing) {
  const char* module = std::getenv("GLTF_VALIDATOR");
  if (!module || findProgram("node").empty()) {
    GTEST_SKIP() << "set GLTF_VALIDATOR to the folder of the npm package gltf-validator";
  }
  const Texture texture{encodePng({2, 2, std::vector<std::uint8_t>(16, 200)}), {}};
  for (const GridWay way : {GridWay::bones, GridWay::morphs}) {
    for (const int influences : {4, 8}) {
      GridBakeOptions o = options(way);
      o.bones.influences = influences;
      o.texture = &texture;
      write(o);
      std::optional<ChildProcess> process = ChildProcess::start(
          "node", {FASCIA_SOURCE_DIR "/tests/io/validate_gltf.js", module, file()});
      ASSERT_TRUE(process.has_value());
      const bool good = process->finish();
      EXPECT_TRUE(good) << process->complaints();
    }
  }
}

}  // namespace
}  // namespace fascia
