#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <fascia/math/types.h>

namespace fascia {

// A pinhole camera. Looks from eye to target; y is up unless said otherwise.
struct Camera {
  Vec3 eye_m{0, 1, 5};
  Vec3 target_m{0, 1, 0};
  Vec3 up{0, 1, 0};
  double vertical_fov_rad = radians(28);  // (0, π)
  double near_m = 0, far_m = 0;           // 0 = chosen from the scene

  Vec3 forward() const { return (target_m - eye_m).normalized(); }
};

// Right-handed view space: x right, y up, looking along -z.
Eigen::Matrix4f viewFromWorld(const Camera& camera);
// OpenGL clip space of a symmetric frustum.
Eigen::Matrix4f clipFromView(const Camera& camera, double aspect, double near_m, double far_m);

// What a person asks for: a direction to look from, framed automatically, or an explicit eye.
// Characters face +z: azimuth 0 looks at the face, 90° at the character's left side (from +x).
struct CameraSpec {
  double azimuth_rad = radians(32);   // the three-quarter front view
  double elevation_rad = radians(9);  // [-89°, 90°]
  std::optional<double> distance_m;   // none = so that everything fits
  std::optional<Vec3> eye_m;          // overrides azimuth, elevation and distance
  std::optional<Vec3> target_m;       // none = the middle of what is framed
  double vertical_fov_rad = radians(28);
};

// "front", "side", "back", "top", "three-quarter", or settings such as "az=30,el=15",
// "side,dist=4,fov=40", "eye=1,2,3;target=0,1,0". Angles in degrees, lengths in metres.
// Throws Error that lists every fault and says what is allowed.
CameraSpec parseCamera(std::string_view text);

// What points reach, seen from many sides: tighter than a box around what lies or stands aslant.
class Reach {
 public:
  void add(const Vec3& point);  // ignored unless finite
  void add(const Box& box);
  bool empty() const { return box_.empty(); }
  const Box& box() const { return box_; }
  // The farthest points in each of the directions looked at; some repeat.
  std::span<const Vec3> extremes() const;

 private:
  static constexpr std::size_t kDirections = 98;  // of a cube's lattice: 13° apart or less
  Box box_;
  std::array<Vec3, kDirections> extremes_;
};

// The camera of a spec such that all that is reached (over the whole motion) fits a picture of this
// aspect, and stands in its middle.
Camera frameReach(const CameraSpec& spec, const Reach& reach, double aspect);

// The camera of a spec such that `bounds` (over the whole motion) fits a picture of this aspect.
Camera frameBox(const CameraSpec& spec, const Box& bounds, double aspect);

}  // namespace fascia
