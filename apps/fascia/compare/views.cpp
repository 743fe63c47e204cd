#include "compare/views.h"

#include <algorithm>
#include <cmath>

namespace fascia {
namespace {

constexpr double kSmooth_s = 0.3;  // shorter: steps shake the camera; longer: it lags
constexpr double kStays = 0.3;     // of the figure's size: less of a way needs no following
constexpr int kTurns = 16;         // directions that a turntable's camera must fit
constexpr double kCloseFov_rad = radians(28);

Vec3 turnedAbout(const Vec3& p, const Vec3& axis, double angle_rad) {
  return axis + Eigen::AngleAxisd(angle_rad, Vec3::UnitY()) * (p - axis);
}

// What is reached on a full turn about the middle.
Reach revolved(const Reach& reach) {
  Reach out;
  const Vec3 axis = reach.box().center();
  for (int i = 0; i < kTurns; ++i)
    for (const Vec3& p : reach.extremes()) out.add(turnedAbout(p, axis, 2 * kPi * i / kTurns));
  return out;
}

}  // namespace

std::vector<Vec3> smoothPath(std::span<const Vec3> path, double deviation_frames) {
  const auto count = static_cast<std::ptrdiff_t>(path.size());
  const auto at = [&](std::ptrdiff_t i) -> Vec3 {  // beyond an end: turned about it
    const std::ptrdiff_t end = i < 0 ? 0 : count - 1;
    if (i >= 0 && i < count) return path[static_cast<std::size_t>(i)];
    const std::ptrdiff_t mirrored = std::clamp<std::ptrdiff_t>(2 * end - i, 0, count - 1);
    return 2 * path[static_cast<std::size_t>(end)] - path[static_cast<std::size_t>(mirrored)];
  };
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(3 * deviation_frames));
  std::vector<Vec3> smooth;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    Vec3 sum = Vec3::Zero();
    double weights = 0;
    for (std::ptrdiff_t k = -reach; k <= reach; ++k) {
      const double t = static_cast<double>(k) / std::max(deviation_frames, 1e-9);
      const double weight = std::exp(-0.5 * t * t);
      sum += weight * at(i + k);
      weights += weight;
    }
    smooth.push_back(sum / weights);
  }
  return smooth;
}

std::vector<Vec3> pathOf(Sides& sides) {
  std::vector<Vec3> path;
  Box floor;
  for (std::size_t f = 0; f < sides.frameCount(); ++f) {
    const Vec3 middle = sides.middle(f);
    path.emplace_back(middle.x(), 0, middle.z());
    floor.add(path.back());
  }
  if (path.size() < 2 || floor.size().norm() < kStays * sides.model().size_m())
    return std::vector<Vec3>(path.size(), Vec3::Zero());
  const double interval_s =
      (sides.time_s(path.size() - 1) - sides.time_s(0)) / static_cast<double>(path.size() - 1);
  std::vector<Vec3> smooth = smoothPath(path, kSmooth_s / std::max(interval_s, 1e-6));
  const Vec3 start = smooth.front();
  for (Vec3& p : smooth) p -= start;
  return smooth;
}

MainView::MainView(const CameraSpec& spec, const Reach& reach, bool turntable)
    : spec_(spec), reach_(turntable ? revolved(reach) : reach), turntable_(turntable) {}

Camera MainView::camera(double aspect, double turn, const Vec3& gone) const {
  Camera camera = frameReach(spec_, reach_, aspect);
  if (turntable_) {
    const double angle_rad = 2 * kPi * turn;
    camera.eye_m = turnedAbout(camera.eye_m, camera.target_m, angle_rad);
    camera.up = Eigen::AngleAxisd(angle_rad, Vec3::UnitY()) * camera.up;
  }
  camera.eye_m += gone;
  camera.target_m += gone;
  return camera;
}

Vec3 MainView::towards() const {
  return -frameReach(spec_, reach_, 1).forward();
}

Camera closeView(const Place& place, const Vec3& middle) {
  Camera camera;
  camera.vertical_fov_rad = kCloseFov_rad;
  camera.target_m = middle;
  camera.eye_m = middle + place.radius_m / std::tan(0.5 * kCloseFov_rad) * place.towards;
  return camera;
}

Seen seenBy(const Camera& camera, double aspect, const Vec3& point) {
  const Eigen::Vector3d view =
      (viewFromWorld(camera).cast<double>() * point.homogeneous()).head<3>();
  const double depth = std::max(-view.z(), 1e-9);
  const double perHeight = 0.5 / (std::tan(0.5 * camera.vertical_fov_rad) * depth);
  return {0.5 + view.x() * perHeight / aspect, 0.5 - view.y() * perHeight, perHeight};
}

}  // namespace fascia
