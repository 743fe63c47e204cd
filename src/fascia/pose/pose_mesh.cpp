#include <fascia/pose/pose_mesh.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>

#include <fascia/base/assert.h>
#include <fascia/pose/point_grid.h>

namespace fascia {
namespace {

// Cotangents beyond these belong to slivers: smaller ones would leave points loose or pull the
// wrong way, larger ones make the factorisation stiff.
constexpr float kLeastWeight = 0.05f, kMostWeight = 3.f;
// Pieces that lie so close to one another at rest (eyes in heads, clothes on bodies), as a share of
// the figure's size, and whose weights differ by less than kAlike, move together by edges of this
// weight. Farther: a sleeve would hang on the hip. More alike: belts come off.
constexpr float kVirtualReach = 0.02f, kAlike = 0.5f, kVirtualWeight = 0.7f;
// A point without area of its own still needs a mass: this share of the mean.
constexpr float kLeastArea = 1e-3f;

struct HalfEdge {
  std::uint32_t from, to;
  float weight;
};

// Area, normals and cotangent weights of all triangles.
std::vector<HalfEdge> addTriangles(PoseMesh& mesh) {
  std::vector<HalfEdge> edges;
  edges.reserve(6 * mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3f across =
        (mesh.rest[t[1]] - mesh.rest[t[0]]).cross(mesh.rest[t[2]] - mesh.rest[t[0]]);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t i = t[k], j = t[(k + 1) % 3], l = t[(k + 2) % 3];
      const Eigen::Vector3f a = mesh.rest[i] - mesh.rest[l], b = mesh.rest[j] - mesh.rest[l];
      const float cotangent = 0.5f * a.dot(b) / std::max(1e-12f, a.cross(b).norm());
      edges.push_back({i, j, cotangent});
      edges.push_back({j, i, cotangent});
      mesh.area_m2[i] += across.norm() / 6;
      mesh.normal[i] += across;
    }
  }
  return edges;
}

// Pieces that hang together by triangles: a number per point.
std::vector<std::uint32_t> piecesOf(const PoseMesh& mesh) {
  std::vector<std::uint32_t> piece(mesh.size());
  std::iota(piece.begin(), piece.end(), 0u);
  const auto root = [&](std::uint32_t i) {
    while (piece[i] != i) i = piece[i] = piece[piece[i]];
    return i;
  };
  for (const auto& t : mesh.triangles) {
    piece[root(t[0])] = root(t[1]);
    piece[root(t[1])] = root(t[2]);
  }
  for (std::uint32_t i = 0; i < piece.size(); ++i) piece[i] = root(i);
  return piece;
}

void addVirtualEdges(const PoseMesh& mesh, const std::vector<std::uint32_t>& piece,
                     std::span<const PointWeights> weights, std::vector<HalfEdge>& edges) {
  if (std::adjacent_find(piece.begin(), piece.end(), std::not_equal_to<>()) == piece.end()) return;
  const float reach = kVirtualReach * mesh.size_m;
  const PointGrid grid(mesh.rest, reach);
  for (std::uint32_t i = 0; i < mesh.size(); ++i) {
    float nearest = reach * reach;
    std::uint32_t best = i;
    grid.visitNear(mesh.rest[i], [&](std::uint32_t j) {
      if (piece[i] == piece[j]) return;
      const float squared = (mesh.rest[i] - mesh.rest[j]).squaredNorm();
      if (squared >= nearest || weightDistance(weights[i], weights[j]) >= kAlike) return;
      nearest = squared;
      best = j;
    });
    if (best == i) continue;
    edges.push_back({i, best, kVirtualWeight});
    edges.push_back({best, i, kVirtualWeight});
  }
}

// Normals of unit length that point out of their piece, also where its triangles are inside out.
void orientNormals(const std::vector<std::uint32_t>& piece, PoseMesh& mesh) {
  std::vector<Eigen::Vector3f> middle(mesh.size(), Eigen::Vector3f::Zero());
  std::vector<float> count(mesh.size(), 0.f), volume(mesh.size(), 0.f);
  for (std::size_t i = 0; i < mesh.size(); ++i) middle[piece[i]] += mesh.rest[i], ++count[piece[i]];
  for (const auto& t : mesh.triangles) {
    const std::uint32_t p = piece[t[0]];
    const Eigen::Vector3f center = middle[p] / count[p];
    volume[p] +=
        (mesh.rest[t[0]] - center).dot((mesh.rest[t[1]] - center).cross(mesh.rest[t[2]] - center));
  }
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const float length = mesh.normal[i].norm(), sign = volume[piece[i]] < 0 ? -1.f : 1.f;
    mesh.normal[i] =
        length > 0 ? Eigen::Vector3f(sign / length * mesh.normal[i]) : Eigen::Vector3f(0, 1, 0);
  }
}

// Sorted by point, each edge once in either direction.
void storeEdges(std::vector<HalfEdge> found, PoseMesh& mesh) {
  FASCIA_ASSERT(
      std::ranges::all_of(
          found, [&](const HalfEdge& e) { return e.from < mesh.size() && e.to < mesh.size(); }),
      "edges join points");
  std::stable_sort(found.begin(), found.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return a.from < b.from || (a.from == b.from && a.to < b.to);
  });
  mesh.firstEdge.assign(mesh.size() + 1, 0);
  mesh.edge_m.assign(mesh.size(), 0.f);
  for (std::size_t k = 0, next; k < found.size(); k = next) {
    float weight = 0;
    for (next = k;
         next < found.size() && found[next].from == found[k].from && found[next].to == found[k].to;
         ++next)
      weight += found[next].weight;
    mesh.edges.push_back({found[k].to, std::clamp(weight, kLeastWeight, kMostWeight)});
    ++mesh.firstEdge[found[k].from + 1];
    mesh.edge_m[found[k].from] += (mesh.rest[found[k].from] - mesh.rest[found[k].to]).norm();
  }
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    if (mesh.firstEdge[i + 1] > 0) mesh.edge_m[i] /= static_cast<float>(mesh.firstEdge[i + 1]);
    mesh.firstEdge[i + 1] += mesh.firstEdge[i];
  }
}

}  // namespace

PoseMesh makePoseMesh(const PoseSource& source) {
  FASCIA_ASSERT(source.weights.size() == source.points.size(), "every point has weights");
  PoseMesh mesh;
  mesh.rest.assign(source.points.begin(), source.points.end());
  mesh.triangles.assign(source.triangles.begin(), source.triangles.end());
  mesh.normal.assign(mesh.size(), Eigen::Vector3f::Zero());
  mesh.area_m2.assign(mesh.size(), 0.f);
  Box box;
  for (const Eigen::Vector3f& p : mesh.rest) box.add(p.cast<double>());
  mesh.size_m = box.empty() ? 1.f : std::max(1e-6f, static_cast<float>(box.size().norm()));
  std::vector<HalfEdge> edges = addTriangles(mesh);
  const std::vector<std::uint32_t> piece = piecesOf(mesh);
  addVirtualEdges(mesh, piece, source.weights, edges);
  orientNormals(piece, mesh);
  storeEdges(std::move(edges), mesh);
  mesh.piece = piece;
  const double total = std::accumulate(mesh.area_m2.begin(), mesh.area_m2.end(), 0.0);
  const double points = std::max<double>(1, static_cast<double>(mesh.size()));
  const float least =
      std::max(1e-12f * mesh.size_m * mesh.size_m, kLeastArea * static_cast<float>(total / points));
  for (float& area : mesh.area_m2) area = std::max(area, least);
  FASCIA_ASSERT(mesh.firstEdge.back() == mesh.edges.size(), "every edge starts at a point");
  return mesh;
}

float weightDistance(const PointWeights& a, const PointWeights& b) {
  const auto share = [](const PointWeights& w, std::uint16_t joint) {
    float sum = 0;
    for (std::size_t k = 0; k < PointWeights::kMost; ++k)
      if (w.joint[k] == joint) sum += w.weight[k];
    return sum;
  };
  float common = 0;  // both sum to 1
  for (std::size_t k = 0; k < PointWeights::kMost; ++k)
    if (a.weight[k] > 0) common += std::min(a.weight[k], share(b, a.joint[k]));
  return 2 - 2 * std::min(1.f, common);
}

std::vector<float> wayAlongEdges(const PoseMesh& mesh, std::span<const std::uint32_t> from,
                                 float most_m) {
  FASCIA_ASSERT(areBelow(from, mesh.size()), "a way starts at points");
  using Entry = std::pair<float, std::uint32_t>;
  std::vector<float> way(mesh.size(), std::numeric_limits<float>::max());
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const std::uint32_t i : from) queue.push({way[i] = 0, i});
  while (!queue.empty()) {
    const auto [so, i] = queue.top();
    queue.pop();
    if (so > way[i] || so > most_m) continue;
    for (const PoseMesh::Edge& e : mesh.around(i)) {
      const float further = so + (mesh.rest[i] - mesh.rest[e.to]).norm();
      if (further < way[e.to]) queue.push({way[e.to] = further, e.to});
    }
  }
  return way;
}

void forClusters(const PoseMesh& mesh, std::span<std::uint32_t> points, std::size_t most,
                 const std::function<void(std::span<const std::uint32_t>)>& add) {
  if (points.size() <= most) {
    if (!points.empty()) add(points);
    return;
  }
  Box box;
  for (const std::uint32_t i : points) box.add(mesh.rest[i].cast<double>());
  Eigen::Index axis;
  box.size().maxCoeff(&axis);
  const auto middle = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
  std::nth_element(points.begin(), middle, points.end(), [&](std::uint32_t p, std::uint32_t q) {
    const float a = mesh.rest[p][axis], b = mesh.rest[q][axis];
    return a < b || (a == b && p < q);
  });
  forClusters(mesh, points.first(points.size() / 2), most, add);
  forClusters(mesh, points.subspan(points.size() / 2), most, add);
}

void smoothAlongEdges(const PoseMesh& mesh, int passes, std::vector<float>& values) {
  std::vector<float> before;
  for (int pass = 0; pass < passes; ++pass) {
    before = values;
    for (std::size_t i = 0; i < mesh.size(); ++i) {
      const auto around = mesh.around(i);
      float sum = before[i];
      for (const PoseMesh::Edge& e : around) sum += before[e.to];
      values[i] = sum / static_cast<float>(1 + around.size());
    }
  }
}

}  // namespace fascia
