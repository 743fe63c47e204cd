#include "bench/deformation/pictures.h"

#include <algorithm>
#include <cmath>

#include <fascia/io/image.h>
#include <fascia/measure/deformation.h>

namespace fascia {
namespace {

constexpr int kSide = 420, kGap = 6;  // pixels

// Clay shows shape; red shows where the surface passes through itself.
std::vector<Drawable> drawables(const RiggedModel& model,
                                const std::vector<Eigen::Vector3f>& points) {
  std::vector<bool> crosses(model.triangles.size(), false);
  for (const CrossingPair& pair : findCrossings(model.triangles, points))
    crosses[pair.first] = crosses[pair.second] = true;
  std::vector<Drawable> parts(2);
  for (Drawable& part : parts) {
    part.mesh.positions = points;
    computeNormals(points, model.triangles, part.mesh.normals);
    part.material.roughness = 0.6f;
  }
  parts[0].material.color = Rgb(0.80f, 0.74f, 0.68f);
  parts[1].material.color = Rgb(0.85f, 0.16f, 0.12f);
  for (std::size_t t = 0; t < crosses.size(); ++t)
    parts[crosses[t] ? 1 : 0].mesh.triangles.push_back(model.triangles[t]);
  if (parts[1].mesh.triangles.empty()) parts.pop_back();
  return parts;
}

}  // namespace

BendPictures::BendPictures(const RiggedModel& model, const Hinge& hinge)
    : model_(model), hinge_(hinge), region_(regionOf(model, hinge)) {}

// Along the hinge's axis, from outside, above or in front rather than through the body.
Camera BendPictures::camera(const std::vector<Eigen::Vector3f>& points) const {
  Vec3 mean = Vec3::Zero();
  for (const std::uint32_t p : region_.pointsNearJoint) mean += points[p].cast<double>();
  mean /= std::max(1.0, static_cast<double>(region_.pointsNearJoint.size()));
  double reach_m = 0;
  for (const std::uint32_t p : region_.pointsNearJoint)
    reach_m = std::max(reach_m, (points[p].cast<double>() - mean).norm());
  const Vec3 outside(1, 0.5, 0.25);
  const Vec3 from = hinge_.axis.dot(outside) < 0 ? Vec3(-hinge_.axis) : hinge_.axis;
  Camera camera;
  camera.target_m = mean;
  const double distance_m = 1.5 * reach_m / std::tan(0.5 * camera.vertical_fov_rad);
  camera.eye_m = mean + distance_m * from;
  if (std::abs(from.y()) > 0.8) camera.up = -Vec3::UnitZ();
  return camera;
}

void BendPictures::add(Renderer& renderer, const std::vector<Eigen::Vector3f>& points) {
  if (pictures_.empty()) camera_ = camera(points);
  Scene scene;
  scene.camera = camera_;
  scene.drawables = drawables(model_, points);
  const Vec3 back = camera_.eye_m - camera_.target_m;
  scene.studio.azimuth_rad = static_cast<float>(std::atan2(back.x(), back.z()));
  pictures_.push_back(renderer.render(scene, kSide, kSide));
}

void BendPictures::write(const std::string& path) const {
  Image row;
  const int count = static_cast<int>(pictures_.size());
  row.width = count * kSide + (count - 1) * kGap;
  row.height = kSide;
  row.rgba.assign(4 * static_cast<std::size_t>(row.width) * kSide, 255);
  for (int i = 0; i < count; ++i)
    for (int y = 0; y < kSide; ++y) {
      const std::uint8_t* from = pictures_[static_cast<std::size_t>(i)].at(0, y);
      const std::size_t to = static_cast<std::size_t>(y) * static_cast<std::size_t>(row.width) +
                             static_cast<std::size_t>(i * (kSide + kGap));
      std::copy(from, from + 4 * kSide, row.rgba.begin() + static_cast<std::ptrdiff_t>(4 * to));
    }
  writePng(row, path);
}

}  // namespace fascia
