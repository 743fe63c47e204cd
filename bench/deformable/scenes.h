#pragma once

#include <memory>
#include <string>

#include <fascia/deformable/solve/body_stepper.h>

// Systems of bars that are measured: 0.2 m × 0.1 m × 0.1 m, 2 kg, affine.
namespace fascia {

inline const Vec3 kBar_m{0.2, 0.1, 0.1};
inline constexpr double kBarDensity_kg_per_m3 = 1000;
inline constexpr BodyMaterial kFirm{.rigidity_Pa = 1e4, .volume_Pa = 1e4};

struct BodyScene {
  std::unique_ptr<BodySystem> system;
  OdeState state;
};

BodyShapePtr makeBarShape(const BodyMaterial& material, double density_kg_per_m3);
Vec3 barEnd(double side);  // -1 or 1

enum class Layout { chain, tree };
struct SceneOptions {
  int bodies = 10;
  Layout layout = Layout::chain;
  int chainLength = 0;  // chains of so many bodies hang side by side; 0 = one chain
  BodyMaterial material = kFirm;
  Vec3 gravity_m_per_s2{0, -9.81, 0};
  bool constantJacobian = true;  // false: constraints pretend not to be linear
};

// A chain leaves its nail along x, horizontally; a tree's bars branch in threes. All at rest.
BodyScene makeScene(const SceneOptions& options);

}  // namespace fascia
