#include <benchmark/benchmark.h>

#include <cmath>

#include <fascia/base/parallel.h>
#include <fascia/math/types.h>
#include <fascia/skin/self_contact/self_contact.h>

namespace fascia {
namespace {

constexpr float kInterval_s = 1.f / 60;

// Limbs side by side, as fingers or thighs are: tubes along z, each a piece of skin of its own.
struct Limbs {
  static constexpr double kRadius_m = 0.05, kLength_m = 0.8;

  VectorArray rest, position, velocity;
  PointModel points;
  PointSurroundings around;
  SelfContactModel model;
  SelfContact contact;
  int limbs, columns, rows;

  Limbs(int limbCount, int columnCount, int rowCount)
      : limbs(limbCount), columns(columnCount), rows(rowCount) {
    rest = place(3 * kRadius_m);
    points.mass.assign(rest.size(), 0.001f);
    points.free.assign(rest.size(), 1.f);
    around.resize(rest.size());
    std::vector<PointBlock> blocks;
    for (std::size_t k = 0; k < rest.size(); k += PointBlock::kCapacity)
      blocks.push_back({k, static_cast<std::uint32_t>(
                               std::min<std::size_t>(PointBlock::kCapacity, rest.size() - k))});
    model = prepareSelfContact(triangles(), rest, blocks, 0.002f);
    contact = SelfContact(model);
  }

  VectorArray place(double spacing_m) const {
    VectorArray r(static_cast<std::size_t>(limbs * rows * columns));
    std::size_t k = 0;
    for (int limb = 0; limb < limbs; ++limb)
      for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i, ++k) {
          const double a = 2 * kPi * i / columns;
          r.x[k] = static_cast<float>(limb * spacing_m + kRadius_m * std::cos(a));
          r.y[k] = static_cast<float>(kRadius_m * std::sin(a));
          r.z[k] = static_cast<float>(kLength_m * j / (rows - 1));
        }
    return r;
  }
  std::vector<std::array<std::uint32_t, 3>> triangles() const {
    std::vector<std::array<std::uint32_t, 3>> out;
    const auto at = [&](int limb, int j, int i) {
      return static_cast<std::uint32_t>((limb * rows + j) * columns + i % columns);
    };
    for (int limb = 0; limb < limbs; ++limb)
      for (int j = 0; j + 1 < rows; ++j)
        for (int i = 0; i < columns; ++i) {
          const std::uint32_t a = at(limb, j, i), b = at(limb, j, i + 1),
                              c = at(limb, j + 1, i + 1), d = at(limb, j + 1, i);
          out.push_back({a, b, c});
          out.push_back({a, c, d});
        }
    return out;
  }
};

// spacing in per cent of the limbs' diameter: below 100 they press into each other.
void selfContact(benchmark::State& state, int limbs, int columns, int rows, int threads) {
  Limbs scene(limbs, columns, rows);
  const ThreadLimit limit(threads);
  const VectorArray start =
      scene.place(static_cast<double>(state.range(0)) * 0.02 * Limbs::kRadius_m);
  std::uint64_t contacts = 0;
  for (auto _ : state) {
    state.PauseTiming();
    scene.position = start;
    scene.velocity = VectorArray(start.size());
    scene.around.normal.fill(0.f);
    state.ResumeTiming();
    contacts =
        scene.contact.separate(scene.points, 0.005f, scene.position, scene.velocity, kInterval_s)
            .contacts;
    scene.contact.writeHalfSpaces(scene.position, scene.velocity, kInterval_s, scene.around);
  }
  state.counters["points"] = static_cast<double>(start.size());
  state.counters["contacts"] = static_cast<double>(contacts);
}
BENCHMARK_CAPTURE(selfContact, 8640_points, 4, 24, 90, 1)
    ->Arg(150)
    ->Arg(98)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(selfContact, 30000_points, 4, 50, 150, 2)
    ->Arg(150)
    ->Arg(98)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace fascia
