#pragma once

#include <array>

#include <fascia/base/aligned.h>
#include <fascia/field/field.h>
#include <fascia/skin/grid/grid_layout.h>

namespace fascia {

// One end ring of the tube in world space, rest posture.
struct EndRing {
  Vec3 center_m = Vec3::Zero();
  Vec3 axis = Vec3::UnitY();  // unit, pointing out of the body
  double radius_m = 0.01;
};

struct WrapOptions {
  double fat_m = 0.01;  // distance kept from the flesh
  double cling = 0.3;   // [0, 1]: 0 spans hollows like a stocking, 1 follows every valley
};

// Where the ray from `origin` along `axis` leaves the flesh for the last time, plus `clearance_m`.
Vec3 exitPoint(const DistanceField& field, const Vec3& origin, const Vec3& axis,
               double clearance_m);

// Shrink-wrap (Turner & Gobbetti 1998, §6.2): a sphere around the flesh whose two end rows are the
// rings contracts under tension until it rests on the flesh. Coarse to fine, so that the cost is
// linear in points. Columns run right-handed around the tube's axis (bottom → top) seen from
// outside, starting at the back (−z), so that u = ½ is the front. Returns positions in storage
// order, pads filled.
VectorArray shrinkWrap(const DistanceField& field, const GridLayout& layout, const EndRing& bottom,
                       const EndRing& top, const WrapOptions& options);

// The same for a figure that the straight tube does not hold: an arc, a snake. Leads a tube along
// the way through the flesh from one ring to the other (flesh_path.h), just outside of the flesh
// around it, before it contracts. Columns keep to the front as they do there, turned along the way
// by no more than the ends ask for.
VectorArray wrapAlongFlesh(const DistanceField& field, const GridLayout& layout,
                           const EndRing& bottom, const EndRing& top, const WrapOptions& options);

// Points of a ring, `columns` of them, as the end rows of shrinkWrap.
Vec3 ringPoint(const EndRing& ring, const Vec3& upAxis, double u);

}  // namespace fascia
