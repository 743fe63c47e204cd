#include <benchmark/benchmark.h>

#include <string>

#include <fascia/io/documents/character_file.h>
#include <fascia/skin/contact/flesh_contact.h>
#include <fascia/skin/grid/grid_skin.h>
#include <fascia/skin/grid/grid_stepper.h>
#include <fascia/skin/grid/wrap.h>

namespace fascia {
namespace {

BuildOptions gridOf(int columns, int rows) {
  BuildOptions options;
  options.columns = columns, options.rows = rows;
  return options;
}

// An example character's skin in its rest posture, at rest.
struct Scene {
  Character character;
  CharacterState state;

  Scene(const std::string& name, int columns, int rows)
      : character(loadCharacter(FASCIA_SOURCE_DIR "/examples/" + name + ".fascia.json",
                                gridOf(columns, rows))),
        state(initialState(character, character.source(-1))) {}
  const Skin& skin() const { return *character.skin(); }
};

constexpr const char* kSpheres = "penguin";         // 7 spheres
constexpr const char* kSuperellipsoids = "wombat";  // 5 superellipsoids, 2 spheres, 1 cylinder

void countPoints(benchmark::State& state, const Skin& skin, int steps = 1) {
  using benchmark::Counter;
  const double points =
      static_cast<double>(state.iterations()) * steps * static_cast<double>(skin.pointCount());
  state.counters["s_per_point"] = Counter(points, Counter::kIsRate | Counter::kInvert);
}

void membraneForces(benchmark::State& state) {
  const Scene scene(kSpheres, static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const Skin& skin = scene.skin();
  VectorArray force(skin.grid()->layout().storage());
  SweepScratch scratch;
  scratch.resize(skin.grid()->layout());
  for (auto _ : state) {
    gridForces(skin.grid()->layout(), skin.grid()->elastic().coefficients(),
               scene.state.skin.position, force, scratch);
    benchmark::ClobberMemory();
  }
  countPoints(state, skin);
}
BENCHMARK(membraneForces)->Args({64, 16})->Args({200, 50});

// Whole steps: membrane, tissue, gravity, drag, half spaces, integration.
void leapfrogSteps(benchmark::State& state) {
  constexpr int kSteps = 16;
  const Scene scene(kSpheres, static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const Skin& skin = scene.skin();
  const SkinState& start = scene.state.skin;
  StepCoefficients coefficients;
  prepareStep(skin.points(), skin.contactResponse(), skin.defaultStep_s(), coefficients);
  const SweepModel model{
      &skin.grid()->layout(),
      &skin.grid()->elastic().coefficients(),
      {&skin.points(), &coefficients, &start.surroundings, nullptr, {0.f, -9.81f, 0.f}}};
  GridStepper stepper(skin.grid()->layout());
  VectorArray position = start.position, velocity = start.velocity;
  for (auto _ : state) {
    state.PauseTiming();
    position = start.position, velocity = start.velocity;
    state.ResumeTiming();
    stepper.run(model, 0, kSteps, position, velocity);
    benchmark::ClobberMemory();
  }
  countPoints(state, skin, kSteps);
}
BENCHMARK(leapfrogSteps)->Args({64, 16})->Args({200, 50})->Args({640, 160});

void contact(benchmark::State& state, const char* name) {
  const Scene scene(name, 64, 16);
  const Skin& skin = scene.skin();
  const SkinState& start = scene.state.skin;
  FleshContact flesh(skin.blocks());
  PointSurroundings around = start.surroundings;
  VectorArray position = start.position, velocity = start.velocity;
  const auto reach_m = static_cast<float>(0.02 * skin.size_m());
  for (auto _ : state) {
    state.PauseTiming();
    position = start.position, velocity = start.velocity;
    state.ResumeTiming();
    benchmark::DoNotOptimize(
        flesh.project(scene.state.flesh, skin.points(), reach_m, 0.f, position, velocity, around));
  }
  countPoints(state, skin);
}
BENCHMARK_CAPTURE(contact, spheres, kSpheres);
BENCHMARK_CAPTURE(contact, superellipsoids, kSuperellipsoids);

void stepCoefficients(benchmark::State& state) {
  const Scene scene(kSpheres, 64, 16);
  StepCoefficients coefficients;
  for (auto _ : state) {
    prepareStep(scene.skin().points(), scene.skin().contactResponse(), scene.skin().defaultStep_s(),
                coefficients);
    benchmark::ClobberMemory();
  }
  countPoints(state, scene.skin());
}
BENCHMARK(stepCoefficients);

void wrap(benchmark::State& state, const char* name) {
  const Scene scene(name, 64, 16);
  const SkinDef& def = *scene.character.def().skin;
  const GridLayout& g = scene.skin().grid()->layout();
  const auto ring = [&](int row, double up) {
    const VectorArray& rest = scene.skin().restPosition();
    EndRing out{Vec3::Zero(), Vec3(0, up, 0), 0.01};
    for (int i = 0; i < g.columns; ++i) {
      const std::size_t k = g.at(i, row);
      out.center_m += Vec3(rest.x[k], rest.y[k], rest.z[k]) / g.columns;
    }
    return out;
  };
  const EndRing bottom = ring(0, -1), top = ring(g.rows - 1, 1);
  for (auto _ : state)
    benchmark::DoNotOptimize(
        shrinkWrap(scene.state.flesh, g, bottom, top, {def.fat.thickness_m, def.grid.cling}));
  countPoints(state, scene.skin());
}
BENCHMARK_CAPTURE(wrap, spheres, kSpheres)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(wrap, superellipsoids, kSuperellipsoids)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fascia
