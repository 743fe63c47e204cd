#pragma once

#include <memory>
#include <string_view>

#include <fascia/skin/skin.h>

namespace fascia {

// One interval of a skin's life, as SkinStepper sees it: everything that acts on the points is
// constant or linear in time.
struct StepInterval {
  const PointSurroundings* around = nullptr;
  double duration_s = 0;
  int steps = 1;
};

// A time stepping scheme under comparison, for the library's membrane, tissue, drag, gravity and
// contact half spaces (not for bending). All of them are written in plain scalar code of the same
// care, so that their costs compare; the product's leapfrog is the only one with SIMD kernels.
class Scheme {
 public:
  virtual ~Scheme() = default;
  virtual void run(const StepInterval& interval, VectorArray& position, VectorArray& velocity) = 0;
};

std::unique_ptr<Scheme> makeScalarLeapfrog(const Skin& skin);
// Extended position-based dynamics with small steps (Macklin et al. 2019): one pass per step.
std::unique_ptr<Scheme> makeXpbd(const Skin& skin);
// Vertex block descent (Chen et al. 2024): `passes` over the four colours of the grid per step.
std::unique_ptr<Scheme> makeBlockDescent(const Skin& skin, int passes);

}  // namespace fascia
