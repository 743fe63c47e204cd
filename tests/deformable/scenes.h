#pragma once

#include <string>

#include <fascia/deformable/solve/body_stepper.h>

#include "bodies.h"

// Systems for the tests.
namespace fascia::test {

inline const Vec3 kLinkSize_m{0.2, 0.04, 0.04};

inline BodyShapePtr makeLink(const BodyMaterial& material = {}, double density = 1000) {
  return makeBar(makeAffineBasis(3), material, kLinkSize_m, density);
}

inline Vec3 linkEnd(double side) {
  return {0.5 * side * kLinkSize_m.x(), 0, 0};
}

// Bars in a row along x, each attached to the one before, the first nailed at the origin.
inline std::unique_ptr<BodySystem> makeChain(int links, OdeState& state,
                                             const BodyMaterial& material = {},
                                             const BodySettings& settings = {}) {
  BodyModel model;
  const BodyShapePtr link = makeLink(material);
  for (int i = 0; i < links; ++i) model.add(link);
  auto system = std::make_unique<BodySystem>(std::move(model), settings);
  state = system->model().restState();
  for (int i = 0; i < links; ++i) {
    const Vec3 center((i + 0.5) * kLinkSize_m.x(), 0, 0);
    system->model().place(BodyId(i), {Mat3::Identity(), center}, state);
    const BodyPoint start{BodyId(i), linkEnd(-1)};
    if (i == 0) {
      system->hold(makeNail("nail", start, Vec3::Zero()));
    } else {
      const BodyPoint before{BodyId(i - 1), linkEnd(1)};
      system->hold(makeAttachment("hinge " + std::to_string(i), before, start));
    }
  }
  return system;
}

}  // namespace fascia::test
