#include <fascia/render/camera.h>

#include <algorithm>
#include <cmath>

namespace fascia {
namespace {

constexpr double kMargin = 1.06;  // smaller crops moving limbs, larger wastes the picture

Vec3 directionFrom(const CameraSpec& spec) {
  const double e = spec.elevation_rad, a = spec.azimuth_rad;
  return {std::cos(e) * std::sin(a), std::sin(e), std::cos(e) * std::cos(a)};
}

// The distance from the box's centre along `direction` at which all eight corners are in view.
double fittingDistance(const Box& box, const Vec3& target, const Camera& camera, double aspect) {
  const Vec3 forward = camera.forward();
  const Vec3 right = forward.cross(camera.up).normalized();
  const Vec3 up = right.cross(forward);
  const double tanY = std::tan(0.5 * camera.vertical_fov_rad) / kMargin, tanX = tanY * aspect;
  double distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p(corner & 1 ? box.high.x() : box.low.x(), corner & 2 ? box.high.y() : box.low.y(),
                 corner & 4 ? box.high.z() : box.low.z());
    const Vec3 d = p - target;
    const double depth = -d.dot(forward);
    distance = std::max(
        distance, depth + std::max(std::abs(d.dot(right)) / tanX, std::abs(d.dot(up)) / tanY));
  }
  return distance;
}

}  // namespace

Eigen::Matrix4f viewFromWorld(const Camera& camera) {
  const Vec3 back = -camera.forward();
  const Vec3 right = camera.up.cross(back).normalized();
  const Vec3 up = back.cross(right);
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.block<1, 3>(0, 0) = right.transpose();
  m.block<1, 3>(1, 0) = up.transpose();
  m.block<1, 3>(2, 0) = back.transpose();
  m.block<3, 1>(0, 3) = -(m.block<3, 3>(0, 0) * camera.eye_m);
  return m.cast<float>();
}

Eigen::Matrix4f clipFromView(const Camera& camera, double aspect, double near_m, double far_m) {
  const double f = 1 / std::tan(0.5 * camera.vertical_fov_rad);
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  m(0, 0) = f / aspect;
  m(1, 1) = f;
  m(2, 2) = (far_m + near_m) / (near_m - far_m);
  m(2, 3) = 2 * far_m * near_m / (near_m - far_m);
  m(3, 2) = -1;
  return m.cast<float>();
}

Camera frameBox(const CameraSpec& spec, const Box& bounds, double aspect) {
  const Box box = bounds.empty() ? Box{Vec3::Constant(-0.5), Vec3::Constant(0.5)} : bounds;
  Camera camera;
  camera.vertical_fov_rad = spec.vertical_fov_rad;
  camera.target_m = spec.target_m.value_or(box.center());
  if (spec.eye_m) {
    camera.eye_m = *spec.eye_m;
  } else {
    const Vec3 direction = directionFrom(spec);
    camera.eye_m = camera.target_m + direction;
    // Seen from straight above, the character's front (+z) points down the picture.
    if (std::abs(direction.y()) > 0.999) camera.up = Vec3(0, 0, -1);
    const double fit = fittingDistance(box, camera.target_m, camera, aspect);
    camera.eye_m = camera.target_m + direction * spec.distance_m.value_or(std::max(fit, 1e-3));
  }
  if (camera.forward().cross(camera.up).norm() < 1e-3) camera.up = Vec3(0, 0, -1);
  return camera;
}

}  // namespace fascia
