#pragma once

#include <optional>

#include <fascia/field/field.h>

namespace fascia {

// A place and what a solid says about it: within the distance over the field's Lipschitz bound
// nothing of it is met, and near its surface it is a plane.
struct Nearness {
  Vec3 place_m = Vec3::Zero();
  double distance_m = 0;
  Vec3 normal = Vec3::UnitY();
};

// Goes along a straight way by steps no longer than the solid is far (sphere tracing, Hart 1996),
// up to where it comes within the margin: so nothing is too thin or too fast. Starts from what is
// known of the beginning. Nothing: the way leads past.
std::optional<Nearness> trace(const DistanceField& field, SolidId solid, const Nearness& start,
                              const Vec3& way, double margin_m);

}  // namespace fascia
