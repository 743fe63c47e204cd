#include <fascia/skin/surface/surface_mesh.h>

#include <algorithm>
#include <cmath>

#include <fascia/geometry/remesh.h>
#include <fascia/skin/surface/solid_union.h>

namespace fascia {
namespace {

// Of the figure's size: edges where nobody says otherwise.
constexpr double kUsualEdge = 1.0 / 40;
constexpr double kLongestEdge = 1.0 / 8;
constexpr double kCoarseLook = 1.0 / 64;
// Cubes of this share of an edge find what triangles of that size can show.
constexpr double kCellOfEdge = 0.6;

double areaOf(const TriangleMesh& mesh) {
  double twice = 0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3f a = mesh.positions[t[1]] - mesh.positions[t[0]],
                          b = mesh.positions[t[2]] - mesh.positions[t[0]];
    twice += double{a.cross(b).norm()};
  }
  return 0.5 * twice;
}

double sizeOf(const DistanceField& flesh) {
  Box box;
  for (std::size_t s = 0; s < flesh.solidCount(); ++s)
    box.add(flesh.bounds(SolidId(static_cast<std::int64_t>(s))));
  return std::max(1e-6, box.size().norm());
}

}  // namespace

double surfaceEdge_m(const DistanceField& flesh, const SkinSurfaceDef& def) {
  const double size = sizeOf(flesh);
  return std::min(def.edge_m.value_or(kUsualEdge * size), kLongestEdge * size);
}

bool isTooFine(const DistanceField& flesh, const SkinSurfaceDef& def, double fat_m) {
  const ImplicitSurface surface = unionOfSolids(flesh, {fat_m, def.blend_m});
  const double area = areaOf(isoSurface(surface, kCoarseLook * surface.bounds_m.size().norm()));
  // Six even triangles around a point: √3/2 edge² each.
  const double least_m = RemeshOptions{}.finest * surfaceEdge_m(flesh, def);
  return area > kMostSurfacePoints * 0.866 * least_m * least_m;
}

TriangleMesh surfaceOfSolids(const DistanceField& flesh, const SkinSurfaceDef& def, double fat_m) {
  const ImplicitSurface surface = unionOfSolids(flesh, {fat_m, def.blend_m});
  RemeshOptions options;
  options.edge_m = surfaceEdge_m(flesh, def);
  return remeshed(surface, isoSurface(surface, kCellOfEdge * options.edge_m), options);
}

std::vector<PointWeights> sharesOfJoints(const Flesh& flesh, const DistanceField& posed,
                                         std::size_t joints, const VectorArray& points,
                                         std::size_t count, double reach_m) {
  std::vector<std::vector<float>> least(joints, std::vector<float>(count, 3e38f));
  std::vector<float> distance(count);
  VectorArray normal(count);
  for (std::size_t s = 0; s < flesh.solidCount(); ++s) {
    const SolidId id(static_cast<std::int64_t>(s));
    posed.evaluate(id, view(points, 0, count), distance.data(), view(normal, 0, count));
    std::vector<float>& own = least[flesh.joint(id).index()];
    for (std::size_t i = 0; i < count; ++i) own[i] = std::min(own[i], distance[i]);
  }
  std::vector<PointWeights> out(count);
  std::vector<std::pair<float, std::uint16_t>> order(joints);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < joints; ++j)
      order[j] = {least[j][i], static_cast<std::uint16_t>(j)};
    const std::size_t most = std::min(PointWeights::kMost, joints);
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(most),
                      order.end());
    double sum = 0;
    std::array<double, PointWeights::kMost> share{};
    for (std::size_t k = 0; k < most; ++k) {
      const double behind = double{order[k].first - order[0].first};
      share[k] = std::pow(std::max(0.0, 1 - behind / reach_m), 2);
      sum += share[k];
    }
    for (std::size_t k = 0; k < most && share[k] > 0; ++k) {
      out[i].joint[k] = order[k].second;
      out[i].weight[k] = static_cast<float>(share[k] / sum);
    }
  }
  return out;
}

}  // namespace fascia
