#include "bench/sheet/sheet_scene.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <vector>

namespace fascia {
namespace {

constexpr double kSlack = 0.85, kSag_m = 0.05;
constexpr double kSwing_m = 0.5, kSwing_hz = 0.5;
// The spheres' swing grows to its full size in this time.
constexpr double kFadeIn_s = 1;
// Frames before anything is measured: the swing is full and periodic by then.
constexpr int kSheetWarmFrames = 120;
constexpr int kSheetMeasureEvery = 6;
constexpr double kFarAway_m = 10;

double medianOfFrames(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double swingPhase(int sphere, double time_s) {
  return 2 * kPi * kSwing_hz * time_s + 2 * kPi * sphere / SheetScene::kSpheres;
}

// The stretch of all edges of one frame.
std::vector<double> stretches(const SheetScene& scene, const SheetSolver& solver) {
  std::vector<double> all;
  all.reserve(2 * static_cast<std::size_t>(scene.side) * static_cast<std::size_t>(scene.side));
  const auto add = [&](const Vec3& a, const Vec3& b) {
    all.push_back(std::max(0.0, (b - a).norm() / scene.spacing_m() - 1));
  };
  for (int j = 0; j < scene.side; ++j) {
    for (int i = 0; i < scene.side; ++i) {
      const Vec3 p = solver.position(i, j);
      if (i + 1 < scene.side) add(p, solver.position(i + 1, j));
      if (j + 1 < scene.side) add(p, solver.position(i, j + 1));
    }
  }
  return all;
}

double deepest(const SheetScene& scene, const SheetSolver& solver, double time_s) {
  std::array<Vec3, SheetScene::kSpheres> centers;
  for (int s = 0; s < SheetScene::kSpheres; ++s)
    centers[static_cast<std::size_t>(s)] = SheetScene::sphereCenter(s, time_s);
  double depth = 0;
  for (int j = 0; j < scene.side; ++j)
    for (int i = 0; i < scene.side; ++i)
      for (const Vec3& center : centers)
        depth =
            std::max(depth, SheetScene::kSphereRadius_m - (solver.position(i, j) - center).norm());
  return depth;
}

}  // namespace

Vec3 SheetScene::start(int i, int j) const {
  const double x = -0.5 * kSide_m + i * spacing_m(), z = -0.5 * kSide_m + j * spacing_m();
  return {x, -kSag_m * std::cos(kPi * z / kSide_m), kSlack * z};
}

Vec3 SheetScene::sphereCenter(int sphere, double time_s) {
  const double angle = 2 * kPi * (sphere - 1) / (kSpheres - 1), ring_m = sphere == 0 ? 0 : 0.6;
  const double swing_m = kSwing_m * std::min(1.0, time_s / kFadeIn_s);
  return {ring_m * std::cos(angle), -0.5 + swing_m * std::sin(swingPhase(sphere, time_s)),
          ring_m * std::sin(angle)};
}

Vec3 SheetScene::sphereVelocity(int sphere, double time_s) {
  const double phase = swingPhase(sphere, time_s);
  double up = 2 * kPi * kSwing_hz * std::min(1.0, time_s / kFadeIn_s) * std::cos(phase);
  if (time_s < kFadeIn_s) up += std::sin(phase) / kFadeIn_s;
  return {0, kSwing_m * up, 0};
}

SheetResult measureSheet(const SheetScene& scene, SheetSolver& solver, int frames) {
  std::vector<double> frame_s, largest, nearlyLargest, depth_m;
  SheetResult result;
  const auto strays = [&](int i, int j) {
    return !(solver.position(i, j).cwiseAbs().maxCoeff() < kFarAway_m);
  };
  for (int f = 0; f < kSheetWarmFrames + frames; ++f) {
    const auto begin = std::chrono::steady_clock::now();
    solver.advanceFrame();
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
    if (f < kSheetWarmFrames) continue;
    frame_s.push_back(spent.count());
    if (f % kSheetMeasureEvery != 0) continue;
    std::vector<double> all = stretches(scene, solver);
    for (int j = 0; j < scene.side; ++j)
      for (int i = 0; i < scene.side; ++i) result.lost += strays(i, j) ? 1 : 0;
    const auto rank = static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(all.size()));
    std::nth_element(all.begin(), all.begin() + rank, all.end());
    nearlyLargest.push_back(all[static_cast<std::size_t>(rank)]);
    largest.push_back(*std::max_element(all.begin(), all.end()));
    depth_m.push_back(deepest(scene, solver, (f + 1) * SheetScene::kFrame_s));
  }
  result.frame_s = medianOfFrames(frame_s);
  std::ranges::sort(frame_s);
  result.fastFrame_s = frame_s[frame_s.size() / 10];
  result.stretch = medianOfFrames(largest);
  result.stretch99 = medianOfFrames(nearlyLargest);
  result.penetration_m = medianOfFrames(depth_m);
  return result;
}

}  // namespace fascia
