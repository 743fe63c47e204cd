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

struct View {
  Vec3 forward, right, up;
  double tanX, tanY;  // of half the angles of view, less the margin

  View(const Camera& camera, double aspect)
      : forward(camera.forward()),
        right(forward.cross(camera.up).normalized()),
        up(right.cross(forward)),
        tanX(std::tan(0.5 * camera.vertical_fov_rad) / kMargin * aspect),
        tanY(std::tan(0.5 * camera.vertical_fov_rad) / kMargin) {}
};

// The distance from the target at which all points are in view.
double fittingDistance(std::span<const Vec3> points, const Vec3& target, const View& view) {
  double distance = 0;
  for (const Vec3& p : points) {
    const Vec3 d = p - target;
    const double depth = -d.dot(view.forward);
    distance = std::max(distance, depth + std::max(std::abs(d.dot(view.right)) / view.tanX,
                                                   std::abs(d.dot(view.up)) / view.tanY));
  }
  return distance;
}

// The target moved across the view until the points stand in the picture's middle. A move changes
// the distance at which they fit, and with it how far perspective spreads them: hence the passes.
Vec3 centred(std::span<const Vec3> points, Vec3 target, const View& view) {
  constexpr int kPasses = 8;
  for (int pass = 0; pass < kPasses; ++pass) {
    const double distance = fittingDistance(points, target, view);
    Box seen;  // slopes to the right and up
    for (const Vec3& p : points) {
      const Vec3 d = p - target;
      const double depth = std::max(distance + d.dot(view.forward), 1e-9);
      seen.add(Vec3(d.dot(view.right), d.dot(view.up), 0) / depth);
    }
    target += distance * (seen.center().x() * view.right + seen.center().y() * view.up);
  }
  return target;
}

Camera framePoints(const CameraSpec& spec, std::span<const Vec3> points, const Vec3& center,
                   bool recentre, double aspect) {
  Camera camera;
  camera.vertical_fov_rad = spec.vertical_fov_rad;
  camera.target_m = spec.target_m.value_or(center);
  if (spec.eye_m) {
    camera.eye_m = *spec.eye_m;
  } else {
    const Vec3 direction = directionFrom(spec);
    camera.eye_m = camera.target_m + direction;
    // Seen from straight above, the character's front (+z) points down the picture.
    if (std::abs(direction.y()) > 0.999) camera.up = Vec3(0, 0, -1);
    const View view(camera, aspect);
    if (recentre && !spec.target_m) camera.target_m = centred(points, camera.target_m, view);
    const double fit = fittingDistance(points, camera.target_m, view);
    camera.eye_m = camera.target_m + direction * spec.distance_m.value_or(std::max(fit, 1e-3));
  }
  if (camera.forward().cross(camera.up).norm() < 1e-3) camera.up = Vec3(0, 0, -1);
  return camera;
}

// Where the lattice of a cube's surface lies, five points along each edge.
const std::vector<Vec3>& latticeDirections() {
  static const std::vector<Vec3> directions = [] {
    std::vector<Vec3> out;
    for (int x = -2; x <= 2; ++x)
      for (int y = -2; y <= 2; ++y)
        for (int z = -2; z <= 2; ++z)
          if (std::max({std::abs(x), std::abs(y), std::abs(z)}) == 2)
            out.push_back(Vec3(x, y, z).normalized());
    return out;
  }();
  return directions;
}

std::array<Vec3, 8> corners(const Box& box) {
  std::array<Vec3, 8> out;
  for (std::size_t i = 0; i < 8; ++i)
    out[i] = Vec3(i & 1 ? box.low.x() : box.high.x(), i & 2 ? box.low.y() : box.high.y(),
                  i & 4 ? box.low.z() : box.high.z());
  return out;
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

void Reach::add(const Vec3& point) {
  if (!point.allFinite()) return;
  const std::vector<Vec3>& directions = latticeDirections();
  const bool first = box_.empty();
  box_.add(point);
  for (std::size_t i = 0; i < kDirections; ++i)
    if (first || directions[i].dot(point) > directions[i].dot(extremes_[i])) extremes_[i] = point;
}

void Reach::add(const Box& box) {
  if (box.empty()) return;
  for (const Vec3& corner : corners(box)) add(corner);
}

std::span<const Vec3> Reach::extremes() const {
  return box_.empty() ? std::span<const Vec3>() : std::span<const Vec3>(extremes_);
}

Camera frameReach(const CameraSpec& spec, const Reach& reach, double aspect) {
  if (reach.empty()) return frameBox(spec, {}, aspect);
  return framePoints(spec, reach.extremes(), reach.box().center(), true, aspect);
}

Camera frameBox(const CameraSpec& spec, const Box& bounds, double aspect) {
  const Box box = bounds.empty() ? Box{Vec3::Constant(-0.5), Vec3::Constant(0.5)} : bounds;
  return framePoints(spec, corners(box), box.center(), false, aspect);
}

}  // namespace fascia
