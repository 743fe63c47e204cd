#pragma once

#include <fascia/deformable/constraint/constraint.h>
#include <fascia/deformable/constraint/cubic_segment.h>

namespace fascia {

// An attachment of points that are not at one place yet: x_a − x_b = gap(t), which is to shrink to
// nothing. An attachment would close the gap in a single step, at whatever speed that takes.
ConstraintPtr makeClosingAttachment(std::string name, const BodyPoint& a, const BodyPoint& b,
                                    const CubicSegment& gap);

// `path`, and a gap beside it that shrinks to nothing.
PointPath pathBeside(PointPath path, const CubicSegment& gap);

}  // namespace fascia
