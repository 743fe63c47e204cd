#pragma once

#include <vector>

#include <fascia/deformable/body/body.h>
#include <fascia/deformable/surfaces/body_surface.h>

namespace fascia {

// Points of a body's surface that are to stay outside of everything else.
struct ContactPoints {
  std::vector<Vec3> X_m;    // undeformed
  Eigen::MatrixXd weights;  // shapeCount × points: column i is s(X_i)
  double area_m2 = 0;       // of the undeformed surface, for each

  std::size_t size() const { return X_m.size(); }
};

// At most `count` vertices of the surface's mesh: first the outermost in 26 directions, which are
// corners if there are any, then always the farthest from those taken (Gonzalez 1985). In two
// dimensions those of the outline, in the plane z = 0.
ContactPoints makeContactPoints(const BodyShape& shape, const BodySurface& surface,
                                std::size_t count);

}  // namespace fascia
