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

// A rig of the shared assets in one of its motions, with joints that bulge and a skin that ripples:
// more than any simulation asks of a bake.
struct RipplingRig {
  RiggedModel model;
  std::vector<std::vector<Transform>> bones;
  PointFrames frames;

  RipplingRig(const std::string& path, const std::string& motion) : model(readRiggedModel(path)) {
    DualQuaternionBlend blend(model);
    std::size_t number = 0;
    while (number + 1 < model.motions.size() && model.motions[number].name != motion) ++number;
    std::vector<Transform> world;
    std::vector<Eigen::Vector3f> normals;
    for (std::size_t f = 0; f < kFrames; ++f) {
      const double time = static_cast<double>(f) / 60;
      poseRig(model, static_cast<int>(number), time, world);
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
std::unique_ptr<RipplingRig> ripplingRig(const std::string& name, const std::string& motion) {
  const char* given = std::getenv("FASCIA_ASSETS");
  const std::filesystem::path folder =
      given ? std::filesystem::path(given)
            : std::filesystem::path(FASCIA_SOURCE_DIR) / "../shared/assets";
  const std::filesystem::path file = folder / "mesh2motion-cc0" / (name + "-animations.glb");
  return std::filesystem::exists(file) ? std::make_unique<RipplingRig>(file.string(), motion)
                                       : nullptr;
}

const RipplingRig* human() {
  static const std::unique_ptr<RipplingRig> kHuman = ripplingRig("human-base", "Walk_Loop");
  return kHuman.get();
}

const RipplingRig* fox() {
  static const std::unique_ptr<RipplingRig> kFox = ripplingRig("fox", "Death");
  return kFox.get();
}

void decompose(benchmark::State& state, const RipplingRig* rig,
               const DecompositionOptions& options) {
  if (!rig) return state.SkipWithError("the shared assets are not here");
  const ThreadLimit one(1);
  for (auto _ : state) {
    const SkinningDecomposition found =
        decomposeSkinning(rig->model.points_m, rig->model.triangles, rig->model.weights, rig->bones,
                          rig->frames, options);
    state.counters["rms_percent"] = 100 * found.rms_m / rig->model.height_m();
    state.counters["max_percent"] = 100 * found.max_m / rig->model.height_m();
    state.counters["helpers"] = static_cast<double>(found.helpers.size());
  }
}

DecompositionOptions withHelpers(benchmark::State& state) {
  DecompositionOptions options;
  options.helperBones = static_cast<int>(state.range(0));
  return options;
}

void decomposeHuman(benchmark::State& state) {
  decompose(state, human(), withHelpers(state));
}
BENCHMARK(decomposeHuman)->Arg(0)->Arg(20)->Arg(40)->Iterations(1)->Unit(benchmark::kSecond);

void decomposeFox(benchmark::State& state) {
  decompose(state, fox(), withHelpers(state));
}
BENCHMARK(decomposeFox)->Arg(20)->Arg(50)->Arg(100)->Iterations(1)->Unit(benchmark::kSecond);

void findHumanMorphs(benchmark::State& state) {
  const RipplingRig* h = human();
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
