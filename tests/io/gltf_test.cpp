#include <gtest/gtest.h>

#include <cstring>
#include <optional>

// Declarations only: the functions are in the library.
#include <tiny_gltf.h>

#include <fascia/geometry/welded_normals.h>
#include <fascia/io/file/child_process.h>
#include <fascia/io/file/file.h>
#include <fascia/io/glb_export/gltf_writer.h>
#include <fascia/io/glb_export/keep_frames.h>

#include "programs.h"
#include "sample.h"

namespace fascia {
namespace {

using test::expectSuccess;

// The arm of the sample without its skin, which is not simulated here: the recording brings one.
Character armWithoutSkin() {
  CharacterDef def = readCharacterText(sample::kFull).def;
  def.skin.reset();
  return Character(def);
}

class SkinnedArm {
 public:
  SkinnedArm() : character_(readCharacterText(sample::kArm).def) {}
  const Character& character() const { return character_; }

 private:
  Character character_;
};

tinygltf::Model load(const std::string& path) {
  tinygltf::Model model;
  tinygltf::TinyGLTF loader;
  std::string error, warning;
  EXPECT_TRUE(loader.LoadBinaryFromFile(&model, &error, &warning, path)) << error;
  EXPECT_EQ(error + warning, "");
  return model;
}

// Any accessor of floats, sparse or not, as plain numbers.
std::vector<float> floats(const tinygltf::Model& model, int index) {
  const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
  const auto width = static_cast<std::size_t>(
      tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)));
  std::vector<float> out(accessor.count * width, 0.0f);
  const auto bytes = [&](int view, std::size_t offset) {
    const tinygltf::BufferView& v = model.bufferViews[static_cast<std::size_t>(view)];
    return model.buffers[0].data.data() + v.byteOffset + offset;
  };
  if (accessor.bufferView >= 0) {
    std::memcpy(out.data(), bytes(accessor.bufferView, accessor.byteOffset), out.size() * 4);
  }
  if (!accessor.sparse.isSparse) return out;
  const auto* indices =
      reinterpret_cast<const std::uint16_t*>(bytes(accessor.sparse.indices.bufferView, 0));
  const unsigned char* values = bytes(accessor.sparse.values.bufferView, 0);
  for (int i = 0; i < accessor.sparse.count; ++i) {
    std::memcpy(&out[indices[i] * width], values + static_cast<std::size_t>(i) * width * 4,
                width * 4);
  }
  return out;
}

// The skin at a time, as any viewer would blend it.
std::vector<float> skinAt(const tinygltf::Model& model, float time_s) {
  const tinygltf::Mesh& mesh = model.meshes[static_cast<std::size_t>(model.nodes.back().mesh)];
  const tinygltf::Primitive& primitive = mesh.primitives[0];
  std::vector<float> out = floats(model, primitive.attributes.at("POSITION"));
  if (primitive.targets.empty()) return out;
  const tinygltf::Animation& animation = model.animations[0];
  const tinygltf::AnimationSampler* sampler = nullptr;
  for (const tinygltf::AnimationChannel& channel : animation.channels) {
    if (channel.target_path == "weights") {
      sampler = &animation.samplers[static_cast<std::size_t>(channel.sampler)];
    }
  }
  const std::vector<float> times = floats(model, sampler->input);
  const std::vector<float> weights = floats(model, sampler->output);
  std::size_t k = 0;
  while (k + 2 < times.size() && times[k + 1] <= time_s) ++k;
  const float s = std::clamp((time_s - times[k]) / (times[k + 1] - times[k]), 0.0f, 1.0f);
  const std::size_t count = primitive.targets.size();
  for (std::size_t t = 0; t < count; ++t) {
    const float w = (1 - s) * weights[k * count + t] + s * weights[(k + 1) * count + t];
    if (w == 0) continue;
    const std::vector<float> delta = floats(model, primitive.targets[t].at("POSITION"));
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += w * delta[i];
  }
  return out;
}

float largestError(const std::vector<float>& found, const Recording::Frame& frame) {
  float largest = 0;
  for (std::size_t v = 0; v < frame.skin_m.size(); ++v) {
    const Eigen::Vector3f p(found[3 * v], found[3 * v + 1], found[3 * v + 2]);
    largest = std::max(largest, (p - frame.skin_m[v]).norm());
  }
  return largest;
}

TEST(KeepFrames, KeepsTheEndsOfAStraightMotion) {
  const auto always = [](std::size_t, std::size_t) { return true; };
  EXPECT_EQ(keepFrames(1000, always), (std::vector<std::size_t>{0, 999}));
  EXPECT_EQ(keepFrames(1, always), (std::vector<std::size_t>{0}));
  EXPECT_TRUE(keepFrames(0, always).empty());
}

TEST(KeepFrames, KeepsTheCornersOfABrokenMotion) {
  const auto noCornerInside = [](std::size_t a, std::size_t b) {
    for (std::size_t f = a + 1; f < b; ++f) {
      if (f == 7 || f == 50) return false;
    }
    return true;
  };
  EXPECT_EQ(keepFrames(100, noCornerInside), (std::vector<std::size_t>{0, 7, 50, 99}));
}

TEST(WeldedNormals, PointOutwardsAndAgreeAcrossTheSeam) {
  const Recording recording = sample::tube(0, 1);
  const WeldedNormals welded(recording.skin);
  std::vector<Eigen::Vector3f> normals;
  welded.compute(recording.skin.positions, normals);
  for (std::size_t j = 0; j < 8; ++j) EXPECT_EQ(normals[17 * j], normals[17 * j + 16]);
  for (std::size_t v = 17; v < 7 * 17; ++v) {
    Eigen::Vector3f outward = recording.skin.positions[v];
    outward.y() = 0;
    EXPECT_GT(normals[v].dot(outward.normalized()), 0.5f);
  }
}

TEST(Glb, EveryFrameIsExactWithoutTolerance) {
  const sample::Folder folder;
  const SkinnedArm arm;
  const Recording recording = sample::tube(arm.character().skeleton().valueCount());
  GlbOptions options;
  options.tolerance_m = 0;
  const GlbReport report = writeGlb(arm.character(), recording, folder / "a.glb", options);
  EXPECT_EQ(report.framesKept, recording.frames.size());
  const tinygltf::Model model = load(folder / "a.glb");
  for (const Recording::Frame& frame : recording.frames) {
    EXPECT_LT(largestError(skinAt(model, static_cast<float>(frame.time_s)), frame), 2e-7f);
  }
}

TEST(Glb, DroppedFramesBlendWithinTheTolerance) {
  const sample::Folder folder;
  const SkinnedArm arm;
  const Recording recording = sample::tube(arm.character().skeleton().valueCount(), 60);
  GlbOptions options;
  options.tolerance_m = 2e-3;
  const GlbReport report = writeGlb(arm.character(), recording, folder / "a.glb", options);
  EXPECT_LT(report.framesKept, recording.frames.size() / 2);
  EXPECT_GT(report.framesKept, 4u);
  const tinygltf::Model model = load(folder / "a.glb");
  for (const Recording::Frame& frame : recording.frames) {
    EXPECT_LT(largestError(skinAt(model, static_cast<float>(frame.time_s)), frame), 2.6e-3f);
  }
}

TEST(Glb, SkeletonAndOrnamentsKeepTheirNames) {
  const sample::Folder folder;
  const Character character = armWithoutSkin();
  Recording recording = sample::tube(character.skeleton().valueCount());
  for (Recording::Frame& frame : recording.frames) frame.skin_m.clear();
  writeGlb(character, recording, folder / "a.glb");
  const tinygltf::Model model = load(folder / "a.glb");
  ASSERT_EQ(model.nodes.size(), 3u);
  EXPECT_EQ(model.nodes[0].name, "shoulder");
  EXPECT_EQ(model.nodes[1].name, "elbow");
  EXPECT_EQ(model.nodes[0].children, std::vector<int>{1});
  EXPECT_EQ(model.nodes[1].children, std::vector<int>{2});
  EXPECT_EQ(model.nodes[2].name, "watch");
  EXPECT_GE(model.nodes[2].mesh, 0);
  ASSERT_EQ(model.animations.size(), 1u);
  EXPECT_EQ(model.animations[0].channels.size(), 2u);  // the elbow turns and slides
}

TEST(Glb, StillPictureHasNoAnimation) {
  const sample::Folder folder;
  const SkinnedArm arm;
  writeGlb(arm.character(), sample::tube(arm.character().skeleton().valueCount(), 1),
           folder / "a.glb");
  EXPECT_TRUE(load(folder / "a.glb").animations.empty());
}

TEST(Glb, BadRecordingsLeaveNoFile) {
  const sample::Folder folder;
  const SkinnedArm arm;
  Recording recording = sample::tube(arm.character().skeleton().valueCount(), 3);
  recording.frames[1].skin_m[5].x() = std::nanf("");
  EXPECT_THROW(writeGlb(arm.character(), recording, folder / "a.glb"), Error);
  recording.frames.clear();
  EXPECT_THROW(writeGlb(arm.character(), recording, folder / "a.glb"), Error);
  EXPECT_EQ(folder.entryCount(), 0u);
}

// Runs a program on files made here; its complaints are the test's.
TEST(Glb, KhronosValidatorFindsNothing) {
  const char* module = std::getenv("GLTF_VALIDATOR");
  if (!module || findProgram("node").empty()) {
    GTEST_SKIP() << "set GLTF_VALIDATOR to the folder of the npm package gltf-validator";
  }
  const sample::Folder folder;
  const SkinnedArm arm;
  const Texture texture{encodePng({2, 2, std::vector<std::uint8_t>(16, 200)}), {}};
  GlbOptions options;
  options.texture = &texture;
  options.solids = true;
  writeGlb(arm.character(), sample::tube(arm.character().skeleton().valueCount()), folder / "a.glb",
           options);
  expectSuccess("node", {FASCIA_SOURCE_DIR "/tests/io/validate_gltf.js", module, folder / "a.glb"});
}

TEST(Glb, BlenderReadsOurFrames) {
  if (findProgram("blender").empty()) GTEST_SKIP() << "Blender is not installed";
  const sample::Folder folder;
  const SkinnedArm arm;
  const Recording recording = sample::tube(arm.character().skeleton().valueCount());
  GlbOptions options;
  options.tolerance_m = 0;
  writeGlb(arm.character(), recording, folder / "a.glb", options);
  std::string frames;
  for (const Recording::Frame& frame : recording.frames) {
    frames.append(reinterpret_cast<const char*>(frame.skin_m.data()), frame.skin_m.size() * 12);
  }
  writeFileWhole(folder / "frames.f32", frames);
  expectSuccess("blender", {"--background", "--factory-startup", "--python-exit-code", "1",
                            "--python", FASCIA_SOURCE_DIR "/tests/io/blender_readback.py", "--",
                            folder / "a.glb", folder / "frames.f32", "30", "skin"});
}

}  // namespace
}  // namespace fascia
