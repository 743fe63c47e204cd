#include <gtest/gtest.h>

#include <random>

#include <fascia/base/error.h>
#include <fascia/io/rig_model/rig_stream.h>

namespace fascia {
namespace {

RigVertex vertexAt(std::uint32_t point) {
  RigVertex vertex;
  vertex.point = point;
  vertex.normal = Eigen::Vector3f(0, 0.6f, 0.8f);
  vertex.uv = Eigen::Vector2f(0.25f * static_cast<float>(point), 0.5f);
  return vertex;
}

SampledMotion nod(const std::string& name) {
  SampledMotion motion;
  motion.name = name;
  motion.loop = true;
  motion.joints = {"root", "tip"};
  for (int i = 0; i < 6; ++i) {
    motion.rotation.emplace_back(
        Eigen::AngleAxisf(0.1f * static_cast<float>(i), Eigen::Vector3f::UnitX()));
    motion.translation_m.emplace_back(0.f, static_cast<float>(i), 0.f);
  }
  return motion;
}

// Four points on two joints, a vertex more than points, two materials.
RiggedModel smallModel() {
  RiggedModel model;
  model.name = "kite";
  model.sourceFile = "kite.glb";
  model.joints.resize(2);
  model.joints[0].name = "root";
  model.joints[1] = {"tip", 0, {Mat3::Identity(), Vec3(0, 1.0 / 3, 0)}, 7};
  model.points_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  model.weights.resize(4);
  for (PointWeights& weights : model.weights) weights.weight[0] = 1;
  model.weights[3].joint = {1, 0};
  model.weights[3].weight = {0.75f, 0.25f};
  model.triangles = {{0, 1, 2}, {1, 3, 2}};
  model.component = {0, 0, 0, 0};
  model.componentCount = 1;
  for (const std::uint32_t point : {0u, 1u, 2u, 3u, 2u}) model.vertices.push_back(vertexAt(point));
  model.drawnTriangles = {{0, 1, 2}, {1, 3, 4}};
  model.parts.resize(2);
  model.parts[0] = {"left", 3, 0, 0, 0, 0, 3, 0, 1};
  model.parts[1] = {"right", 3, 0, 1, 1, 3, 2, 1, 1};
  model.materials.resize(2);
  model.materials[1].name = "paint";
  model.materials[1].color = {0.1f, 0.2f, 0.3f, 0.5f};
  model.materials[1].texture = {1, 2, 3};
  model.motions = {nod("nod"), nod("shake")};
  return model;
}

// With some of its motions.
std::string written(const RiggedModel& model, const std::vector<std::size_t>& motions) {
  std::vector<SampledMotion> kept;
  for (const std::size_t m : motions) kept.push_back(model.motions.at(m));
  ByteWriter out;
  writeRig(model, kept, out);
  return out.bytes;
}

RiggedModel readBack(const std::string& bytes) {
  ByteReader in(bytes, "kite.fcache");
  RiggedModel model = readRig(in);
  EXPECT_EQ(in.left(), 0u);
  return model;
}

TEST(RigStream, ModelComesBackToTheBit) {
  const std::string bytes = written(smallModel(), {1});
  const RiggedModel back = readBack(bytes);
  EXPECT_EQ(written(back, {0}), bytes);
  EXPECT_EQ(back.joints[1].name, "tip");
  EXPECT_EQ(back.joints[1].rest_world.translation_m.y(), 1.0 / 3);
  EXPECT_EQ(back.weights[3].weight[1], 0.25f);
  EXPECT_EQ(back.vertices[4].point, 2u);
  EXPECT_EQ(back.parts[1].firstTriangle, 1u);
  EXPECT_EQ(back.materials[1].texture.size(), 3u);
}

TEST(RigStream, KeepsTheMotionsThatItIsGiven) {
  const RiggedModel back = readBack(written(smallModel(), {1}));
  ASSERT_EQ(back.motions.size(), 1u);
  EXPECT_EQ(back.motions[0].name, "shake");
  EXPECT_EQ(back.motions[0].frameCount(), 3u);
  EXPECT_TRUE(readBack(written(smallModel(), {})).motions.empty());
}

TEST(RigStream, EveryCutIsNoticed) {
  const std::string bytes = written(smallModel(), {0});
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ByteReader in(std::string_view(bytes).substr(0, size), "cut");
    EXPECT_THROW(readRig(in), Error) << size;
  }
}

TEST(RigStream, BrokenPromisesAreRefused) {
  using Break = void (*)(RiggedModel&);
  const Break breaks[] = {
      [](RiggedModel& m) { m.joints[1].parent = 1; },
      [](RiggedModel& m) { m.joints[1].rest_world.rotation *= 2; },
      [](RiggedModel& m) { m.points_m[0].x() = std::nanf(""); },
      [](RiggedModel& m) { m.weights[0].joint[0] = 2; },
      [](RiggedModel& m) { m.weights[0].weight[0] = 0.5f; },
      [](RiggedModel& m) { m.triangles[0][0] = 4; },
      [](RiggedModel& m) { m.component[0] = 1; },
      [](RiggedModel& m) { m.component.pop_back(); },
      [](RiggedModel& m) { m.vertices[0].point = 4; },
      [](RiggedModel& m) { m.drawnTriangles[0][0] = 5; },
      [](RiggedModel& m) { m.parts[1].triangleCount = 2; },
      [](RiggedModel& m) { m.parts[1].material = 2; },
      [](RiggedModel& m) { m.motions[0].rate_hz = 0; },
      [](RiggedModel& m) { m.motions[0].rotation[1].coeffs().setZero(); },
      [](RiggedModel& m) { m.motions[0].translation_m.pop_back(); },
  };
  EXPECT_NO_THROW(readBack(written(smallModel(), {0})));
  for (std::size_t i = 0; i < std::size(breaks); ++i) {
    RiggedModel model = smallModel();
    breaks[i](model);
    const std::string bytes = written(model, {0});
    ByteReader in(bytes, "broken");
    EXPECT_THROW(readRig(in), Error) << i;
  }
}

// Whatever a stranger changes, reading ends with a model that keeps its promises, or an Error.
TEST(RigStream, AnyChangedByteIsSurvived) {
  const std::string bytes = written(smallModel(), {0});
  std::mt19937 random(11);
  int refused = 0;
  for (int round = 0; round < 4000; ++round) {
    std::string changed = bytes;
    changed[random() % changed.size()] = static_cast<char>(random());
    try {
      ByteReader in(changed, "changed");
      const RiggedModel model = readRig(in);
      for (const auto& triangle : model.drawnTriangles)
        for (const std::uint32_t v : triangle)
          ASSERT_LT(model.vertices[v].point, model.points_m.size());
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace fascia
