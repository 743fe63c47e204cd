#include <fascia/pose/shell_nesting.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fascia/base/parallel.h>
#include <fascia/pose/point_grid.h>

namespace fascia {
namespace {

// How far a point sees others, in mean edges, within shares of the figure's size: less lumps, more
// blurs what the stages did.
constexpr float kReachEdges = 2, kLeastReach = 0.004f, kMostReach = 0.012f;
// A piece with more of the area than this is the skin; the others (eyes, teeth, buttons) are tied
// to it by PoseMesh's edges.
constexpr float kOneSkin = 0.6f;
// Points so close without an edge between them are lips of a slit.
constexpr float kSlit = 1e-4f;
// The share of what a point sees that other pieces must have until it goes with all of them.
constexpr float kAmong = 0.15f;
constexpr int kFadePasses = 6;
constexpr float kLeastNested = 0.01f;
constexpr std::size_t kShellChunk = 256;

Vector4f linearBlend(std::span<const JointMotion> motion, const Vector4f& rest,
                     const PointWeights& weights) {
  Vector4f sum = Vector4f::Zero();
  for (std::size_t k = 0; k < PointWeights::kMost && weights.weight[k] > 0; ++k)
    sum += weights.weight[k] * motion[weights.joint[k]].point(rest);
  return sum;
}

// Where the mesh is cut though it hangs together elsewhere: panels, mouths.
std::vector<char> slitPoints(const PoseMesh& mesh, const PointGrid& grid) {
  std::vector<char> slit(mesh.size(), 0);
  const float most = kSlit * mesh.size_m;
  for (std::uint32_t i = 0; i < mesh.size(); ++i)
    grid.visitNear(mesh.rest[i], [&](std::uint32_t j) {
      if (j == i || (mesh.rest[i] - mesh.rest[j]).squaredNorm() >= most * most) return;
      for (const PoseMesh::Edge& e : mesh.around(i))
        if (e.to == j) return;
      slit[i] = 1;
    });
  return slit;
}

// The largest piece's share of the area.
float largestPiece(const PoseMesh& mesh) {
  std::vector<float> area(mesh.size(), 0.f);
  float total = 0;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    area[mesh.piece[i]] += mesh.area_m2[i];
    total += mesh.area_m2[i];
  }
  return area.empty() ? 1 : *std::max_element(area.begin(), area.end()) / total;
}

template <class Visit>
void visitAround(const PoseMesh& mesh, const PointGrid& grid, float reach_m, std::uint32_t i,
                 const Visit& visit) {
  grid.visitNear(mesh.rest[i], [&](std::uint32_t j) {
    const float near = 1 - (mesh.rest[i] - mesh.rest[j]).squaredNorm() / (reach_m * reach_m);
    if (near > 0) visit(j, near * near * mesh.area_m2[j]);
  });
}

// Per point, how much it goes with all around it: 0 … 1, fading along the skin.
std::vector<float> shareOf(const PoseMesh& mesh, const PointGrid& grid, float reach_m,
                           std::span<const char> rigid) {
  const std::vector<char> slit = slitPoints(mesh, grid);
  std::vector<float> share(mesh.size());
  for (std::uint32_t i = 0; i < mesh.size(); ++i) {
    float total = 0, others = 0;
    visitAround(mesh, grid, reach_m, i, [&](std::uint32_t j, float weight) {
      total += weight;
      if (mesh.piece[j] != mesh.piece[i]) others += weight;
    });
    share[i] = slit[i] ? 1 : smoothStep(others / (kAmong * total));
  }
  std::vector<float> faded = share;
  smoothAlongEdges(mesh, kFadePasses, faded);
  for (std::size_t i = 0; i < mesh.size(); ++i)
    share[i] = rigid[i] ? 0 : std::max(share[i], std::min(1.f, 2 * faded[i]));
  return share;
}

}  // namespace

ShellNesting::ShellNesting(const PoseSource& source, const PoseMesh& mesh,
                           std::span<const char> rigid) {
  if (largestPiece(mesh) > kOneSkin) return;
  const float edge = std::accumulate(mesh.edge_m.begin(), mesh.edge_m.end(), 0.f) /
                     static_cast<float>(std::max<std::size_t>(1, mesh.size()));
  const float reach =
      std::clamp(kReachEdges * edge, kLeastReach * mesh.size_m, kMostReach * mesh.size_m);
  const PointGrid grid(mesh.rest, reach);
  constexpr auto kUnseen = static_cast<std::uint32_t>(-1);
  std::vector<std::uint32_t> seenAs(mesh.size(), kUnseen);
  const auto see = [&](std::uint32_t i) {
    if (seenAs[i] == kUnseen) {
      seenAs[i] = static_cast<std::uint32_t>(seen_.size());
      seen_.push_back({i, wide(mesh.rest[i]), source.weights[i]});
    }
    return seenAs[i];
  };
  const std::vector<float> share = shareOf(mesh, grid, reach, rigid);
  std::vector<std::pair<std::uint32_t, float>> around;
  for (std::uint32_t i = 0; i < mesh.size(); ++i) {
    if (share[i] < kLeastNested) continue;
    around.clear();
    float total = 0;
    visitAround(mesh, grid, reach, i, [&](std::uint32_t j, float weight) {
      around.push_back({j, weight});
      total += weight;
    });
    points_.push_back({see(i), share[i], static_cast<std::uint32_t>(neighbours_.size()),
                       static_cast<std::uint32_t>(around.size())});
    for (const auto& [j, weight] : around) neighbours_.push_back({see(j), weight / total});
  }
}

void ShellNesting::nest(std::span<const JointMotion> motion, std::span<Vector4f> position,
                        Scratch& scratch) const {
  if (points_.empty()) return;
  scratch.added.resize(seen_.size());
  parallelFor((seen_.size() + kShellChunk - 1) / kShellChunk, [&](std::size_t chunk) {
    const std::size_t end = std::min(seen_.size(), kShellChunk * (chunk + 1));
    for (std::size_t s = kShellChunk * chunk; s < end; ++s) {
      const Seen& seen = seen_[s];
      scratch.added[s] = position[seen.point] - linearBlend(motion, seen.rest, seen.weights);
    }
  });
  parallelFor((points_.size() + kShellChunk - 1) / kShellChunk, [&](std::size_t chunk) {
    const std::size_t end = std::min(points_.size(), kShellChunk * (chunk + 1));
    for (std::size_t k = kShellChunk * chunk; k < end; ++k) {
      const Point& p = points_[k];
      Vector4f mean = Vector4f::Zero();
      for (std::uint32_t n = p.firstNeighbour; n < p.firstNeighbour + p.neighbours; ++n)
        mean += neighbours_[n].weight * scratch.added[neighbours_[n].seen];
      position[seen_[p.seen].point] += p.share * (mean - scratch.added[p.seen]);
    }
  });
}

}  // namespace fascia
