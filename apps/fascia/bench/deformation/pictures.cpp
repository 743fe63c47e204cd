#include "bench/deformation/pictures.h"

#include <algorithm>
#include <cmath>

#include <fascia/geometry/visibility.h>
#include <fascia/io/picture/image.h>

namespace fascia {
namespace {

constexpr int kSide = 420, kGap = 6;  // pixels

// Clay shows shape; red shows where the surface passes through itself.
std::vector<Drawable> drawables(const RiggedModel& model, const Judge& judge,
                                const std::vector<Eigen::Vector3f>& points) {
  std::vector<bool> crosses(model.triangles.size(), false);
  for (const CrossingPair& pair : judge.crossingsOf(points))
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

// Directions spread evenly over a sphere, from above to a little below the horizon (a spiral of
// Fibonacci's): people look at things from there.
std::vector<Vec3> directions() {
  constexpr int kCount = 120;
  constexpr double kLowest = -0.35;
  const double golden = kPi * (3 - std::sqrt(5.0));
  std::vector<Vec3> all;
  for (int i = 0; i < kCount; ++i) {
    const double y = 1 - (1 - kLowest) * (i + 0.5) / kCount;
    const double r = std::sqrt(1 - y * y);
    all.emplace_back(r * std::cos(golden * i), y, r * std::sin(golden * i));
  }
  return all;
}

}  // namespace

PosePictures::PosePictures(const RiggedModel& model, const JointPose& pose,
                           const HingeRegion& region, const Judge& judge)
    : model_(model), pose_(pose), region_(region), judge_(judge) {}

// Where the product of two things is largest: how much of the joint is seen, and how much of the
// turn (a bend along its axis, a twist across it). A little of the first is better than nothing.
Vec3 PosePictures::bestSide(const std::vector<Eigen::Vector3f>& points) const {
  std::vector<bool> isNear(points.size(), false), chosen;
  for (const std::uint32_t p : region_.pointsNearJoint) isNear[p] = true;
  for (const auto& t : model_.triangles)
    chosen.push_back(isNear[t[0]] && isNear[t[1]] && isNear[t[2]]);
  Vec3 best = Vec3::UnitZ();
  double most = 0;
  for (const Vec3& towards : directions()) {
    const double along = std::abs(towards.dot(pose_.axis));
    const double seen = pose_.twist ? std::sqrt(std::max(0.0, 1 - along * along)) : along;
    const double front = 1 + 0.1 * towards.z();  // of equal sides the one that people know
    const double score =
        front * seen * seen * visibleArea(model_.triangles, points, chosen, towards);
    if (score > most) most = score, best = towards;
  }
  return best;
}

Camera PosePictures::camera(const std::vector<Eigen::Vector3f>& points) const {
  const std::vector<std::uint32_t>& near = region_.pointsNearJoint;
  Vec3 mean = model_.joints[pose_.joint].rest_world.translation_m;
  std::vector<double> distance;
  if (!near.empty()) mean.setZero();
  for (const std::uint32_t p : near)
    mean += points[p].cast<double>() / static_cast<double>(near.size());
  distance.reserve(near.size());
  for (const std::uint32_t p : near) distance.push_back((points[p].cast<double>() - mean).norm());
  // Without the farthest tenth: a few stray weights at a foot would make a knee tiny.
  std::sort(distance.begin(), distance.end());
  const double most_m = distance.empty() ? 0 : distance[distance.size() * 9 / 10];
  Camera camera;
  camera.target_m = mean;
  const double reach_m = std::max(1.15 * most_m, 0.03 * model_.size_m());
  const double distance_m = 1.5 * reach_m / std::tan(0.5 * camera.vertical_fov_rad);
  const Vec3 from = bestSide(points);
  camera.eye_m = camera.target_m + distance_m * from;
  if (std::abs(from.y()) > 0.95) camera.up = -Vec3::UnitZ();
  return camera;
}

void PosePictures::add(Renderer& renderer, const std::vector<Eigen::Vector3f>& points) {
  if (pictures_.empty()) camera_ = camera(points);
  Scene scene;
  scene.camera = camera_;
  scene.drawables = drawables(model_, judge_, points);
  const Vec3 back = camera_.eye_m - camera_.target_m;
  scene.studio.azimuth_rad = static_cast<float>(std::atan2(back.x(), back.z()));
  pictures_.push_back(renderer.render(scene, kSide, kSide));
}

void PosePictures::write(const std::string& path) const {
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
