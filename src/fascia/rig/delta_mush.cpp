#include <fascia/rig/delta_mush.h>

#include <algorithm>

#include <fascia/geometry/triangle_mesh.h>

namespace fascia {
DeltaMush::DeltaMush(const RiggedModel& model, const DeltaMushOptions& options)
    : options_(options),
      blend_(model),
      triangles_(model.triangles),
      smooth_(model.points_m),
      before_(model.points_m.size()),
      normals_(model.points_m.size()) {
  findNeighbours(model);
  smooth();
  computeNormals(smooth_, triangles_, normals_);
  delta_.resize(model.points_m.size());
  for (std::size_t p = 0; p < delta_.size(); ++p)
    delta_[p] = frame(p).transpose() * (model.points_m[p] - smooth_[p]);
}

void DeltaMush::findNeighbours(const RiggedModel& model) {
  const std::vector<std::array<std::uint32_t, 2>> edges = edgesBothWays(model.triangles);
  const std::size_t count = model.points_m.size();
  std::vector<bool> open(count, false);
  for (auto it = edges.begin(); it != edges.end();) {
    const auto next = std::upper_bound(it, edges.end(), *it);
    if (next - it == 1) open[(*it)[0]] = true;
    it = next;
  }
  tangentTo_.resize(count);
  firstNeighbour_.assign(1, 0);
  auto it = edges.begin();
  for (std::uint32_t p = 0; p < count; ++p) {
    tangentTo_[p] = it != edges.end() && (*it)[0] == p ? (*it)[1] : p;
    for (; it != edges.end() && (*it)[0] == p; ++it)
      if (!open[p] && (neighbours_.size() == firstNeighbour_[p] || neighbours_.back() != (*it)[1]))
        neighbours_.push_back((*it)[1]);
    firstNeighbour_.push_back(static_cast<std::uint32_t>(neighbours_.size()));
  }
}

void DeltaMush::smooth() {
  for (int i = 0; i < options_.iterations; ++i) {
    before_.swap(smooth_);
    for (std::size_t p = 0; p < smooth_.size(); ++p) {
      const std::uint32_t first = firstNeighbour_[p], last = firstNeighbour_[p + 1];
      smooth_[p] = before_[p];
      if (first == last) continue;
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      for (std::uint32_t n = first; n < last; ++n) sum += before_[neighbours_[n]];
      smooth_[p] += options_.step * (sum / static_cast<float>(last - first) - before_[p]);
    }
  }
}

Eigen::Matrix3f DeltaMush::frame(std::size_t point) const {
  const Eigen::Vector3f& normal = normals_[point];
  const Eigen::Vector3f third = normal.cross(smooth_[tangentTo_[point]] - smooth_[point]);
  if (!(third.squaredNorm() > 0)) return Eigen::Matrix3f::Identity();  // degenerate: no frame
  Eigen::Matrix3f axes;
  axes.col(0) = normal;
  axes.col(2) = third.normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

void DeltaMush::deform(std::span<const Transform> motion, std::span<Eigen::Vector3f> points) {
  blend_.deform(motion, smooth_);
  smooth();
  computeNormals(smooth_, triangles_, normals_);
  for (std::size_t p = 0; p < points.size(); ++p) points[p] = smooth_[p] + frame(p) * delta_[p];
}

}  // namespace fascia
