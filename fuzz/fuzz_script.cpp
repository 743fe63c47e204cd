// Any bytes either are a script, which drives a puppet for some steps, or end with Error: within
// the limits, and with a puppet whose state stays finite.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include <fascia/base/error.h>
#include <fascia/deformable/solve/body_stepper.h>
#include <fascia/world/script.h>

namespace fascia {
namespace {

BodyShapePtr makeBar() {
  const Box box{Vec3(-0.2, -0.05, 0), Vec3(0.2, 0.05, 0)};
  return std::make_shared<BodyShape>(BodyDef{makeAffineBasis(2),
                                             boxMatter(2, box, 100, MatterDetail::of(1)),
                                             {.rigidity_Pa = 1e4, .volume_Pa = 1e4}});
}

BodyModel makeModel() {
  static const BodyShapePtr kBar = makeBar();
  BodyModel model;
  model.add(kBar), model.add(kBar);
  return model;
}

void play(const std::string& text) {
  BodySystem system(makeModel());
  OdeState state = system.model().restState();
  Puppet puppet(system, state,
                {{"a", BodyPoint{BodyId(0), Vec3(0.2, 0, 0)}},
                 {"b", BodyPoint{BodyId(1), Vec3(-0.2, 0, 0)}},
                 {"p", Vec3(1, 1, 0)}});
  BodyStepper stepper(system);
  ScriptLimits limits;
  limits.memory_bytes = 1u << 20, limits.instructions_per_update = 20000;
  limits.tasks = 20, limits.ties = 20;
  Script script(text, "fuzz.lua", 1, limits);
  constexpr double kStep_s = 0.05;
  for (int i = 0; i < 20 && !script.finished(); ++i) {
    script.update(puppet, kStep_s);
    puppet.update(kStep_s);
    stepper.step(kStep_s, state);
  }
  for (const double x : state.r)
    if (!std::isfinite(x)) std::abort();
}

}  // namespace
}  // namespace fascia

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    fascia::play({reinterpret_cast<const char*>(data), size});
  } catch (const fascia::Error&) {
  }
  return 0;
}
