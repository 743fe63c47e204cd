#pragma once

#include <vector>

#include <fascia/render/camera.h>

#include "compare/places.h"
#include "compare/sides.h"

namespace fascia {

// How far the figure has gone on the floor at every frame, from the first on: what the camera goes
// along with. Smooth, so that steps do not shake it; zeros if the figure stays about where it is.
std::vector<Vec3> pathOf(Sides& sides);

// The same of points given at even intervals, smoothed by a bell of this standard deviation; a
// straight path at constant speed stays one up to its ends.
std::vector<Vec3> smoothPath(std::span<const Vec3> path, double deviation_frames);

// A camera that goes with the figure and, on a turntable, once around it.
class MainView {
 public:
  // reach: of both sides over all frames, as seen from the moving camera.
  MainView(const CameraSpec& spec, const Reach& reach, bool turntable);

  // turn: [0, 1] of the way around.
  Camera camera(double aspect, double turn, const Vec3& gone) const;
  // From the camera's target to it.
  Vec3 towards() const;

 private:
  CameraSpec spec_;
  Reach reach_;
  bool turntable_;
};

// The camera of a closer look.
Camera closeView(const Place& place, const Vec3& middle);

// Where a camera shows a point in a picture of this aspect: x to the right and y down, both in
// [0, 1] inside of it. And how large a length there is, in picture heights.
struct Seen {
  double x, y, height_per_m;
};
Seen seenBy(const Camera& camera, double aspect, const Vec3& point);

}  // namespace fascia
