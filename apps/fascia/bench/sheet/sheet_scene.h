#pragma once

#include <cstddef>

#include <fascia/math/types.h>

namespace fascia {

// A sheet over moving spheres, simple enough for every soft body engine: 2 m × 2 m and 1 kg, two
// opposite edges pinned 15 % closer than at rest, seven spheres that push it up and let it fall,
// gravity, no self-collision. y is up.
struct SheetScene {
  static constexpr int kSpheres = 7;
  static constexpr double kSphereRadius_m = 0.3;
  static constexpr double kSide_m = 2, kMass_kg = 1, kGravity_m_per_s2 = 9.81;
  static constexpr double kFrame_s = 1.0 / 60;

  int side = 32;  // points along an edge; point (i, j) lies at x ~ i, z ~ j

  double spacing_m() const { return kSide_m / (side - 1); }
  bool pinned(int j) const { return j == 0 || j == side - 1; }
  Vec3 start(int i, int j) const;  // sagging a little, not stretched
  static Vec3 sphereCenter(int sphere, double time_s);
  static Vec3 sphereVelocity(int sphere, double time_s);
};

// A sheet being simulated by some engine.
class SheetSolver {
 public:
  virtual ~SheetSolver() = default;
  virtual void advanceFrame() = 0;  // by SheetScene::kFrame_s
  virtual Vec3 position(int i, int j) const = 0;
};

// Medians over frames, of each frame's largest or 99th percentile.
struct SheetResult {
  double frame_s = 0;
  double fastFrame_s = 0;             // tenth percentile: what a busy machine does not disturb
  double stretch = 0, stretch99 = 0;  // of the edges along rows and columns: length / rest − 1, ≥ 0
  double penetration_m = 0;
  // Points that were not finite or had left the scene when they were looked at: those a skin would
  // have put back.
  std::size_t lost = 0;

  double realtimeRatio() const { return SheetScene::kFrame_s / frame_s; }
  double fastRatio() const { return SheetScene::kFrame_s / fastFrame_s; }
};

SheetResult measureSheet(const SheetScene& scene, SheetSolver& solver, int frames);

}  // namespace fascia
