#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include <fascia/baking/morph_basis.h>
#include <fascia/base/parallel.h>
#include <fascia/io/rig_import/rig_import.h>
#include <fascia/rig/dual_quaternion.h>

namespace fascia {
namespace {

constexpr std::size_t kFrames = 60;

// The human of the shared assets, walking, with joints that bulge and a skin that ripples: more
// than any simulation asks of a bake.
struct RipplingHuman {
  RiggedModel model;
  std::vector<std::vector<Transform>> bones;
  PointFrames frames;

  explicit RipplingHuman(const std::string& path) : model(readRiggedModel(path)) {
    DualQuaternionBlend blend(model);
    std::size_t walk = 0;
    while (walk + 1 < model.motions.size() && model.motions[walk].name != "Walk_Loop") ++walk;
    std::vector<Transform> world;
    std::vector<Eigen::Vector3f> normals;
    for (std::size_t f = 0; f < kFrames; ++f) {
      const double time = static_cast<double>(f) / 60;
      poseRig(model, static_cast<int>(walk), time, world);
      restToFrame(model, world, bones.emplace_back());
      std::vector<Eigen::Vector3f>& points = frames.emplace_back(model.points_m.size());
      blend.deform(bones.back(), points);
      computeNormals(points, model.triangles, normals);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const auto phase = static_cast<double>(8 * model.points_m[i].y());
        points[i] += static_cast<float>(0.005 * std::sin(phase + 9 * time)) * normals[i];
      }
    }
  }
};

// Null without the shared assets.
const RipplingHuman* human() {
  static const std::unique_ptr<RipplingHuman> kHuman = [] {
    const char* given = std::getenv("FASCIA_ASSETS");
    const std::filesystem::path folder =
        given ? std::filesystem::path(given)
              : std::filesystem::path(FASCIA_SOURCE_DIR) / "../shared/assets";
    const std::filesystem::path file = folder / "mesh2motion-cc0/human-base-animations.glb";
    return std::filesystem::exists(file) ? std::make_unique<RipplingHuman>(file.string()) : nullptr;
  }();
  return kHuman.get();
}

void decomposeHuman(benchmark::State& state) {
  const RipplingHuman* h = human();
  if (!h) return state.SkipWithError("the shared assets are not here");
  const ThreadLimit one(1);
  DecompositionOptions options;
  options.helperBones = static_cast<int>(state.range(0));
  for (auto _ : state) {
    const SkinningDecomposition found = decomposeSkinning(
        h->model.points_m, h->model.triangles, h->model.weights, h->bones, h->frames, options);
    state.counters["rms_percent"] = 100 * found.rms_m / h->model.height_m();
  }
}
BENCHMARK(decomposeHuman)->Arg(0)->Arg(20)->Arg(40)->Iterations(1)->Unit(benchmark::kSecond);

void findHumanMorphs(benchmark::State& state) {
  const RipplingHuman* h = human();
  if (!h) return state.SkipWithError("the shared assets are not here");
  const ThreadLimit one(1);
  MorphOptions options;
  options.targets = static_cast<int>(state.range(0));
  for (auto _ : state) {
    const MorphBasis found =
        findMorphBasis(h->model.points_m, h->model.weights, h->bones, h->frames, options);
    state.counters["rms_percent"] = 100 * found.rms_m / h->model.height_m();
  }
}
BENCHMARK(findHumanMorphs)->Arg(8)->Arg(16)->Arg(32)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace
}  // namespace fascia
