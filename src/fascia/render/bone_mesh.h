#pragma once

#include <fascia/geometry/triangle_mesh.h>
#include <fascia/skeleton/skeleton.h>

namespace fascia {

// Every bone of a posed skeleton in one mesh: a shaft with knobs from each parent to its child, and
// a ball at each joint. Has the same triangles in every posture of the same skeleton, also where a
// bone has no length.
TriangleMesh boneMesh(const Skeleton& skeleton, const PosedSkeleton& posed);

}  // namespace fascia
