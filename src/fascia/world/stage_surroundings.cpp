#include <fascia/world/stage_surroundings.h>

#include <fascia/math/ode/between.h>

namespace fascia {
namespace {

BodyField collidingBodies(const Stage& stage) {
  std::vector<BodySurfacePtr> surfaces(stage.surfaces().begin(), stage.surfaces().end());
  for (std::size_t b = 0; b < surfaces.size(); ++b)
    if (!stage.def().bodies[b].collides) surfaces[b] = nullptr;
  return {stage.bodies(), surfaces};
}

}  // namespace

StageSurroundings::StageSurroundings(const Stage& stage, const Transform& character)
    : bodies_(collidingBodies(stage)), placed_(all_, character.inverse()) {
  all_.add(bodies_);
  for (std::size_t i = 0; i < stage.def().props.size(); ++i) all_.add(stage.prop(i));
}

const Field& StageSurroundings::at(double time_s) {
  between(*from_, *to_, time_s, state_);
  bodies_.update(state_.r, state_.v);
  return placed_;
}

}  // namespace fascia
