#include <gtest/gtest.h>

#include <cstring>
#include <optional>

// Declarations only: the functions are in the library.
#include <tiny_gltf.h>

#include <fascia/deformable/body/carried_mesh.h>
#include <fascia/io/file/child_process.h>
#include <fascia/io/file/file.h>
#include <fascia/io/glb_export/scene_gltf.h>

#include "character/small_character.h"
#include "programs.h"
#include "sample.h"

namespace fascia {
namespace {

using test::expectSuccess;

constexpr double kFrameRate_hz = 30;

// A glTF with one animation, evaluated as any viewer does it.
class PlayedGlb {
 public:
  explicit PlayedGlb(const std::string& path) {
    tinygltf::TinyGLTF loader;
    std::string error, warning;
    EXPECT_TRUE(loader.LoadBinaryFromFile(&model_, &error, &warning, path)) << error;
    EXPECT_EQ(error + warning, "");
  }

  int node(const std::string& name) const {
    for (std::size_t n = 0; n < model_.nodes.size(); ++n)
      if (model_.nodes[n].name == name) return static_cast<int>(n);
    ADD_FAILURE() << "no node is named " << name;
    return 0;
  }
  int parentOf(int node) const {
    for (std::size_t n = 0; n < model_.nodes.size(); ++n)
      if (std::ranges::count(model_.nodes[n].children, node) > 0) return static_cast<int>(n);
    return -1;
  }

  Transform world(int node, float time_s) const {
    const tinygltf::Node& n = model_.nodes[index(node)];
    const auto track = [&](const char* path, const std::vector<double>& given) {
      const std::vector<float> found = sampled(node, path, time_s);
      return found.empty() ? std::vector<float>(given.begin(), given.end()) : found;
    };
    Transform local;
    if (const auto t = track("translation", n.translation); !t.empty())
      local.translation_m = Vec3(t[0], t[1], t[2]);
    if (const auto r = track("rotation", n.rotation); !r.empty())
      local.rotation = Quat(r[3], r[0], r[1], r[2]).normalized().toRotationMatrix();
    const int parent = parentOf(node);
    return parent < 0 ? local : world(parent, time_s) * local;
  }

  std::vector<float> weights(int node, float time_s) const {
    const std::vector<float> moving = sampled(node, "weights", time_s);
    const std::vector<double>& still = meshOf(node).weights;
    return moving.empty() ? std::vector<float>(still.begin(), still.end()) : moving;
  }

  // "POSITION" or "NORMAL", blended, in the node's space.
  std::vector<Vec3> blended(int node, const char* attribute, float time_s) const {
    const tinygltf::Primitive& primitive = meshOf(node).primitives.at(0);
    std::vector<float> sum = floats(primitive.attributes.at(attribute));
    const std::vector<float> weights = this->weights(node, time_s);
    EXPECT_EQ(weights.size(), primitive.targets.size());
    for (std::size_t t = 0; t < primitive.targets.size(); ++t) {
      const std::vector<float> delta = floats(primitive.targets[t].at(attribute));
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += weights[t] * delta[i];
    }
    std::vector<Vec3> out;
    for (std::size_t i = 0; i < sum.size(); i += 3)
      out.emplace_back(sum[i], sum[i + 1], sum[i + 2]);
    return out;
  }
  std::vector<Vec3> baseNormals(int node) const {
    const std::vector<float> n = floats(meshOf(node).primitives.at(0).attributes.at("NORMAL"));
    std::vector<Vec3> out;
    for (std::size_t i = 0; i < n.size(); i += 3) out.emplace_back(n[i], n[i + 1], n[i + 2]);
    return out;
  }
  std::size_t targetCount(int node) const { return meshOf(node).primitives.at(0).targets.size(); }

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  const tinygltf::Mesh& meshOf(int node) const {
    return model_.meshes.at(index(model_.nodes[index(node)].mesh));
  }

  std::vector<float> floats(int accessor) const {
    const tinygltf::Accessor& a = model_.accessors.at(index(accessor));
    EXPECT_FALSE(a.sparse.isSparse);
    EXPECT_EQ(a.componentType, TINYGLTF_COMPONENT_TYPE_FLOAT);
    const tinygltf::BufferView& view = model_.bufferViews.at(index(a.bufferView));
    const int width = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(a.type));
    std::vector<float> out(a.count * index(width));
    std::memcpy(out.data(), model_.buffers[0].data.data() + view.byteOffset + a.byteOffset,
                4 * out.size());
    return out;
  }

  // A channel's value, linear between its keys; empty if there is no such channel.
  std::vector<float> sampled(int node, const char* path, float time_s) const {
    for (const tinygltf::Animation& animation : model_.animations)
      for (const tinygltf::AnimationChannel& channel : animation.channels)
        if (channel.target_node == node && channel.target_path == path)
          return sampled(animation.samplers[index(channel.sampler)], time_s);
    return {};
  }
  std::vector<float> sampled(const tinygltf::AnimationSampler& sampler, float time_s) const {
    EXPECT_EQ(sampler.interpolation, "LINEAR");
    const std::vector<float> times = floats(sampler.input), values = floats(sampler.output);
    const std::size_t width = values.size() / times.size();
    std::size_t k = 0;
    while (k + 2 < times.size() && times[k + 1] <= time_s) ++k;
    const float s = std::clamp((time_s - times[k]) / (times[k + 1] - times[k]), 0.0f, 1.0f);
    std::vector<float> out;
    for (std::size_t i = 0; i < width; ++i)
      out.push_back((1 - s) * values[k * width + i] + s * values[(k + 1) * width + i]);
    return out;
  }

  tinygltf::Model model_;
};

SceneBodyDef body(const std::string& name, const BodyBasisDef& basis, const Vec3& position_m) {
  SceneBodyDef def;
  def.name = name;
  def.solid.shape = "superellipsoid";
  def.solid.parameters = {0.4, 0.15, 0.15, 0.5, 0.5};
  def.basis = basis;
  def.position_m = position_m;
  def.rigidity_Pa = 8e3, def.volume_Pa = 16e3, def.density_kg_per_m3 = 500;
  def.points = {{"end", Vec3(0.4, 0, 0)}};
  PlacedSolidDef& eye = def.ornaments.emplace_back();
  eye.solid.shape = "sphere";
  eye.solid.parameters = {0.05};
  eye.position_m = Vec3(0.3, 0.1, 0.1);
  return def;
}

const BodyBasisDef kAffine{}, kQuadratic{BodyBasisDef::Kind::polynomial, 2, {1, 1, 1}},
    kLattice{BodyBasisDef::Kind::lattice, 2, {2, 1, 1}};

// Bodies that tumble, bend and fall on a floor, beside a thing that stands.
SceneDef tumble() {
  SceneDef def;
  def.name = "tumble";
  def.bodies = {body("affine", kAffine, Vec3(0, 0.3, 0)), body("bent", kQuadratic, Vec3(0, 2, 1)),
                body("free", kLattice, Vec3(2, 0.4, 0))};
  def.bodies[0].spin_rad_per_s = Vec3(3, 2, 1);
  def.bodies[2].orientation_rad = Vec3(0.3, 0.5, 0.7);
  def.constraints.push_back({"", SceneConstraintDef::Kind::nail, {"bent.end"}});
  def.ground = GroundDef{};
  PlacedSolidDef& stone = def.props.emplace_back();
  stone.name = "stone";
  stone.solid.shape = "sphere";
  stone.solid.parameters = {0.2};
  stone.position_m = Vec3(4, 0.5, 6);
  stone.orientation_rad = Vec3(0, 1, 0);
  return def;
}

SceneDef plates() {
  SceneDef def;
  def.name = "plates";
  def.dimension = 2;
  for (const BodyBasisDef& basis : {kAffine, kQuadratic, kLattice}) {
    const double n = static_cast<double>(def.bodies.size());
    SceneBodyDef plate =
        body("plate" + std::to_string(def.bodies.size()), basis, Vec3(n, 0.4 + 0.2 * n, 0.3 * n));
    plate.form = SceneBodyDef::Form::outline;
    plate.outline_m = {{-0.4, -0.15}, {0.4, -0.15}, {0.4, 0.15}, {-0.4, 0.15}};
    plate.inflated = n > 0;
    plate.spin_rad_per_s = Vec3(0, 0, 2 + n);
    plate.rigidity_Pa = 1e3, plate.volume_Pa = 2e3;
    def.bodies.push_back(plate);
  }
  def.ground = GroundDef{};
  return def;
}

SceneDef withDoll() {
  SceneDef def = tumble();
  SceneCharacterDef& doll = def.characters.emplace_back();
  doll.name = "doll";
  doll.position_m = Vec3(-2, 0.25, 1);
  doll.heading_rad = 1.2;
  doll.character = std::make_shared<const Character>(test::smallCharacter());
  return def;
}

// A scene that was performed and written, and what is in the file.
struct Film {
  explicit Film(SceneDef def, double duration_s = 0.7)
      : stage(std::move(def)),
        recording(record(stage, {.frame_rate_hz = kFrameRate_hz, .duration_s = duration_s})),
        report(writeSceneGlb(stage, recording, path())),
        glb(path()) {}

  std::string path() const { return folder / "a.glb"; }
  float time_s(std::size_t frame) const {
    return static_cast<float>(recording.frames[frame].time_s);
  }
  // A body's look, and then its ornaments, with their nodes; at a frame.
  void eachMesh(std::size_t frame,
                const std::function<void(int node, const TriangleMesh& expected)>& visit) const {
    for (std::size_t b = 0; b < stage.bodies().bodyCount(); ++b) {
      const BodyId id(b);
      const BodyShape& shape = stage.bodies().shape(id);
      const std::span<const double> all = recording.frames[frame].bodies;
      const auto carried = [&](const TriangleMesh& mesh) {
        TriangleMesh out;
        CarriedMesh(shape, mesh).carry(stage.bodies().part(id, all), out);
        return out;
      };
      const std::string name = stage.body(id).name;
      visit(glb.node(name), carried(stage.look(id)));
      visit(glb.node(name + " ornament 0"), carried(stage.ornaments(id)[0]));
    }
  }

  sample::Folder folder;
  Stage stage;
  StageRecording recording;
  GlbReport report;
  PlayedGlb glb;
};

// What most tests look at.
const Film& tumbleFilm() {
  static const Film kFilm(tumble());
  return kFilm;
}
const Film& platesFilm() {
  static const Film kFilm(plates());
  return kFilm;
}

void expectSamePositions(const Film& film) {
  double largest_m = 0;
  for (std::size_t f = 0; f < film.recording.frames.size(); f += 3)
    film.eachMesh(f, [&](int node, const TriangleMesh& expected) {
      const Transform world = film.glb.world(node, film.time_s(f));
      const std::vector<Vec3> found = film.glb.blended(node, "POSITION", film.time_s(f));
      ASSERT_EQ(found.size(), expected.positions.size());
      for (std::size_t v = 0; v < found.size(); ++v)
        largest_m = std::max(largest_m,
                             (world.point(found[v]) - expected.positions[v].cast<double>()).norm());
    });
  EXPECT_LT(largest_m, 1e-5);
}

// How far vertices move within their body: nothing is proved by bodies that stay as they were.
double deformation_m(const Film& film, const std::string& name) {
  const int node = film.glb.node(name);
  const std::vector<Vec3> from = film.glb.blended(node, "POSITION", 0);
  double largest = 0;
  for (std::size_t f = 0; f < film.recording.frames.size(); f += 3) {
    const std::vector<Vec3> to = film.glb.blended(node, "POSITION", film.time_s(f));
    for (std::size_t v = 0; v < from.size(); ++v)
      largest = std::max(largest, (from[v] - to[v]).norm());
  }
  return largest;
}

TEST(SceneGlb, BodiesInSpaceAreWhereTheyWereAtEveryFrame) {
  const Film& film = tumbleFilm();
  EXPECT_EQ(film.report.framesKept, film.recording.frames.size());
  expectSamePositions(film);
  for (const char* name : {"affine", "bent", "free"}) EXPECT_GT(deformation_m(film, name), 3e-3);
  EXPECT_LE(film.glb.targetCount(film.glb.node("affine")), 12u);
}

TEST(SceneGlb, PlatesAreWhereTheyWereAtEveryFrame) {
  const Film& film = platesFilm();
  expectSamePositions(film);
  for (const char* name : {"plate0", "plate1", "plate2"})
    EXPECT_GT(deformation_m(film, name), 5e-4) << name;
  const int last = film.glb.node("plate2");
  for (const Vec3& p : film.glb.blended(last, "POSITION", 0)) EXPECT_NEAR(p.z(), 0.6, 0.05);
}

TEST(SceneGlb, WeightsStayBetweenZeroAndOneAndUseAllOfIt) {
  for (const Film* film : {&tumbleFilm(), &platesFilm()}) {
    for (const SceneBodyDef& body : film->stage.def().bodies) {
      std::vector<float> least, most;
      for (std::size_t f = 0; f < film->recording.frames.size(); ++f) {
        const std::vector<float> w = film->glb.weights(film->glb.node(body.name), film->time_s(f));
        if (f == 0) least = most = w;
        for (std::size_t i = 0; i < w.size(); ++i)
          least[i] = std::min(least[i], w[i]), most[i] = std::max(most[i], w[i]);
      }
      ASSERT_FALSE(least.empty()) << body.name;
      for (std::size_t i = 0; i < least.size(); ++i) {
        EXPECT_EQ(least[i], 0) << body.name;
        EXPECT_EQ(most[i], 1) << body.name;
      }
    }
  }
}

TEST(SceneGlb, NormalsAreThoseOfTheDeformedBodies) {
  constexpr double kMost_rad = 0.1;
  for (const Film* film : {&tumbleFilm(), &platesFilm()}) {
    double largest_rad = 0;
    for (std::size_t f = 0; f < film->recording.frames.size(); f += 5)
      film->eachMesh(f, [&](int node, const TriangleMesh& expected) {
        const Transform world = film->glb.world(node, film->time_s(f));
        const std::vector<Vec3> found = film->glb.blended(node, "NORMAL", film->time_s(f));
        for (std::size_t v = 0; v < found.size(); ++v) {
          const double cosine = world.vector(found[v].normalized())
                                    .dot(expected.normals[v].cast<double>().normalized());
          largest_rad = std::max(largest_rad, std::acos(std::clamp(cosine, -1.0, 1.0)));
        }
        for (const Vec3& n : film->glb.baseNormals(node)) ASSERT_NEAR(n.norm(), 1, 1e-5);
      });
    EXPECT_LT(largest_rad, kMost_rad) << film->stage.def().name;
  }
}

TEST(SceneGlb, PropsAndCharactersStandWhereTheyArePut) {
  const Film film(withDoll(), 0.2);
  const Transform stone = film.glb.world(film.glb.node("stone"), 0);
  EXPECT_NEAR((stone.translation_m - Vec3(4, 0.5, 6)).norm(), 0, 1e-6);
  EXPECT_NEAR((stone.rotation - film.stage.prop(0).frame(SolidId(0)).rotation).norm(), 0, 1e-6);
  const SceneCharacterDef& doll = film.stage.def().characters[0];
  const int node = film.glb.node("doll");
  EXPECT_EQ(film.glb.parentOf(node), -1);
  EXPECT_NEAR((film.glb.world(node, 0).translation_m - doll.position_m).norm(), 0, 1e-6);
  EXPECT_NEAR((film.glb.world(node, 0).rotation - placeOf(doll).rotation).norm(), 0, 1e-6);
  const int hip = film.glb.node("hip");
  EXPECT_EQ(film.glb.parentOf(hip), node);
  const Recording& recording = film.recording.characters[0];
  const std::size_t last = recording.frames.size() - 1;
  PosedSkeleton posed;
  Posture posture = doll.character->skeleton().restPosture();
  posture.values = recording.frames[last].posture;
  doll.character->skeleton().pose(posture, posed);
  const Vec3 expected = placeOf(doll).point(posed.joint_world[0].translation_m);
  EXPECT_NEAR((film.glb.world(hip, film.time_s(last)).translation_m - expected).norm(), 0, 1e-4);
  const std::vector<Vec3> skin = film.glb.blended(film.glb.node("skin"), "POSITION", 0);
  EXPECT_EQ(skin.size(), recording.skin.positions.size());
}

TEST(SceneGlb, StillScenesHaveNoAnimationAndBadRecordingsLeaveNoFile) {
  const sample::Folder folder;
  const Stage stage(tumble());
  StageRecording recording = record(stage, {.duration_s = 0.1});
  recording.frames.resize(1);
  writeSceneGlb(stage, recording, folder / "a.glb");
  const PlayedGlb glb(folder / "a.glb");
  EXPECT_EQ(glb.targetCount(glb.node("affine")), 0u);
  recording.frames.clear();
  EXPECT_THROW(writeSceneGlb(stage, recording, folder / "b.glb"), Error);
  EXPECT_EQ(folder.entryCount(), 1u);
}

// Runs a program on files made here; its complaints are the test's.
TEST(SceneGlb, KhronosValidatorFindsNothing) {
  const char* module = std::getenv("GLTF_VALIDATOR");
  if (!module || findProgram("node").empty()) {
    GTEST_SKIP() << "set GLTF_VALIDATOR to the folder of the npm package gltf-validator";
  }
  for (const SceneDef& def : {withDoll(), plates()}) {
    const Film film(def, 0.2);
    expectSuccess("node", {FASCIA_SOURCE_DIR "/tests/io/validate_gltf.js", module, film.path()});
  }
}

TEST(SceneGlb, BlenderReadsOurFrames) {
  if (findProgram("blender").empty()) GTEST_SKIP() << "Blender is not installed";
  const Film& film = tumbleFilm();
  std::string frames;
  for (std::size_t f = 0; f < film.recording.frames.size(); ++f)
    film.eachMesh(f, [&](int, const TriangleMesh& expected) {
      // Blender drops vertices that no triangle has, as of the seams at a solid's poles.
      std::vector<bool> used(expected.positions.size(), false);
      for (const auto& triangle : expected.triangles)
        for (const std::uint32_t v : triangle) used[v] = true;
      for (std::size_t v = 0; v < used.size(); ++v)
        if (used[v]) frames.append(reinterpret_cast<const char*>(&expected.positions[v]), 12);
    });
  writeFileWhole(film.folder / "frames.f32", frames);
  std::vector<std::string> arguments = {"--background",
                                        "--factory-startup",
                                        "--python-exit-code",
                                        "1",
                                        "--python",
                                        FASCIA_SOURCE_DIR "/tests/io/blender_readback.py",
                                        "--",
                                        film.path(),
                                        film.folder / "frames.f32",
                                        "30"};
  for (const SceneBodyDef& body : film.stage.def().bodies)
    for (const char* part : {"", " ornament 0"}) arguments.push_back(body.name + part);
  expectSuccess("blender", arguments);
}

}  // namespace
}  // namespace fascia
