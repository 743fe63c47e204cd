#include <fascia/pose/elastic_layer.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>

namespace fascia {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kBendsPerTask = 512;
// ℓ in local radii for tightness 0 and 1. Shorter than 0.25: folds cross again; longer than 0.8:
// twisted limbs lose a third of their volume.
constexpr float kLoose = 0.3f, kTight = 0.94f;
// How many ℓ away from any blend of weights the skin still moves.
constexpr float kFar = 2.5f;
// A residual of less than this share of an edge is rounding, not bending.
constexpr float kNoise = 2e-6f;

// Whether the base pose can bend the skin at a point: several joints move it or its neighbours.
bool isBlended(const PoseSource& source, const PoseMesh& mesh, const LimbParts& parts,
               std::size_t i) {
  if (source.weights[i].weight[1] > 0 && source.weights[i].weight[0] < 0.995f) return true;
  for (const PoseMesh::Edge& e : mesh.around(i))
    if (parts.home[e.to] != parts.home[i]) return true;
  return false;
}

std::vector<std::uint32_t> blendedPoints(const PoseSource& source, const PoseMesh& mesh,
                                         const LimbParts& parts) {
  std::vector<std::uint32_t> points;
  for (std::uint32_t i = 0; i < mesh.size(); ++i)
    if (isBlended(source, mesh, parts, i)) points.push_back(i);
  return points;
}

}  // namespace

ElasticLayer::ElasticLayer(const PoseSource& source, const PoseMesh& mesh, const LimbParts& parts,
                           std::span<const float> tightness, std::span<const char> rigid) {
  FASCIA_ASSERT(tightness.size() == mesh.size() && rigid.size() == mesh.size(),
                "a dial for each point");
  std::vector<float> smoothing_m(mesh.size());
  for (std::size_t i = 0; i < mesh.size(); ++i)
    smoothing_m[i] = (kLoose + (kTight - kLoose) * tightness[i]) * parts.radius_m[i];
  number(mesh, wayAlongEdges(mesh, blendedPoints(source, mesh, parts)), smoothing_m, rigid);
  storeEdges(mesh);
  factorize(mesh, smoothing_m);
}

void ElasticLayer::number(const PoseMesh& mesh, std::span<const float> way,
                          std::span<const float> smoothing_m, std::span<const char> rigid) {
  FASCIA_ASSERT(way.size() == mesh.size() && smoothing_m.size() == mesh.size(),
                "a length for each point");
  bentOf_.assign(mesh.size(), kNone);
  for (std::uint32_t i = 0; i < mesh.size(); ++i) {
    if (rigid[i] || way[i] >= kFar * smoothing_m[i] + 2 * mesh.edge_m[i]) continue;
    bentOf_[i] = static_cast<std::uint32_t>(solved_.size());
    solved_.push_back(i);
  }
  std::vector<std::uint32_t> all = solved_;
  for (const std::uint32_t i : solved_)
    for (const PoseMesh::Edge& e : mesh.around(i))
      if (bentOf_[e.to] == kNone) {
        bentOf_[e.to] = static_cast<std::uint32_t>(all.size());
        all.push_back(e.to);
      }
  for (const std::uint32_t i : all) {
    const float noise = kNoise * mesh.edge_m[i];
    bent_.push_back({Vector4f::Zero(), i, 1 / mesh.area_m2[i], noise * noise});
  }
}

void ElasticLayer::storeEdges(const PoseMesh& mesh) {
  firstEdge_.push_back(0);
  for (Point& p : bent_) {
    for (const PoseMesh::Edge& e : mesh.around(p.point)) {
      Edge edge{wide(e.weight * (mesh.rest[p.point] - mesh.rest[e.to])), e.to};
      p.weightedSum += edge.weighted;
      edge.weighted.w() = e.weight;
      edges_.push_back(edge);
    }
    firstEdge_.push_back(static_cast<std::uint32_t>(edges_.size()));
  }
}

// C M⁻¹ C + K of the solved points; others have u = 0.
void ElasticLayer::factorize(const PoseMesh& mesh, std::span<const float> smoothing_m) {
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<std::pair<std::uint32_t, double>> row;
  for (const Point& middle : bent_) {
    FASCIA_ASSERT(bentOf_[middle.point] < bent_.size(), "what bends is numbered");
    row.clear();
    double sum = 0;
    for (const PoseMesh::Edge& e : mesh.around(middle.point)) {
      sum += double{e.weight};
      row.push_back({bentOf_[e.to], -double{e.weight}});
    }
    row.push_back({bentOf_[middle.point], sum});
    std::erase_if(row, [&](const auto& entry) { return entry.first >= solved_.size(); });
    for (const auto& [i, a] : row)
      for (const auto& [j, b] : row)
        if (i >= j)
          entries.emplace_back(static_cast<int>(i), static_cast<int>(j),
                               a * b * double{middle.inverseArea});
  }
  for (std::uint32_t k = 0; k < solved_.size(); ++k) {
    const double l = double{smoothing_m[solved_[k]]};
    entries.emplace_back(static_cast<int>(k), static_cast<int>(k),
                         double{mesh.area_m2[solved_[k]]} / (l * l * l * l));
  }
  const auto n = static_cast<Eigen::Index>(solved_.size());
  SparseMatrix matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  // Lengths of 1 mm make entries of 1e6 and more: equations in units of the mean diagonal.
  if (!system_.factorize(matrix)) solved_.clear();
}

// The residuals e_i / A_i of bent points [begin, end).
void ElasticLayer::bend(std::span<const WideRotation> rotation, std::span<const Vector4f> position,
                        std::size_t begin, std::size_t end, FrameArray& residual) const {
  FASCIA_ASSERT(begin <= end && end <= bent_.size() && residual.size() == bent_.size(),
                "the points bend");
  FASCIA_ASSERT(rotation.size() == position.size() && position.size() == bentOf_.size(),
                "the pose is of this skin");
  for (std::size_t k = begin; k < end; ++k) {
    const Point& p = bent_[k];
    Vector4f turned = rotation[p.point] * p.weightedSum, apart = Vector4f::Zero();
    const Vector4f& here = position[p.point];
    for (std::uint32_t q = firstEdge_[k]; q < firstEdge_[k + 1]; ++q) {
      const Edge& e = edges_[q];
      turned += rotation[e.to] * e.weighted;
      apart += e.weighted.w() * (here - position[e.to]);
    }
    const Vector4f bent = 0.5f * turned - apart;
    residual[k] = bent.squaredNorm() > p.noise ? Vector4f(p.inverseArea * bent) : Vector4f::Zero();
  }
}

void ElasticLayer::relax(std::span<const WideRotation> rotation, std::span<Vector4f> position,
                         Scratch& scratch) const {
  if (solved_.empty()) return;
  FASCIA_ASSERT(rotation.size() == position.size() && position.size() == bentOf_.size(),
                "the pose is of this skin");
  scratch.residual.resize(bent_.size());
  for (std::vector<float>* a : {&scratch.x, &scratch.y, &scratch.z}) a->resize(solved_.size());
  parallelFor((bent_.size() + kBendsPerTask - 1) / kBendsPerTask, [&](std::size_t chunk) {
    bend(rotation, position, kBendsPerTask * chunk,
         std::min(bent_.size(), kBendsPerTask * (chunk + 1)), scratch.residual);
  });
  parallelFor((solved_.size() + kBendsPerTask - 1) / kBendsPerTask, [&](std::size_t chunk) {
    const std::size_t end = std::min(solved_.size(), kBendsPerTask * (chunk + 1));
    for (std::size_t k = kBendsPerTask * chunk; k < end; ++k) {
      Vector4f sum = Vector4f::Zero();
      for (std::uint32_t q = firstEdge_[k]; q < firstEdge_[k + 1]; ++q) {
        const std::uint32_t to = bentOf_[edges_[q].to];
        sum += edges_[q].weighted.w() * (scratch.residual[k] - scratch.residual[to]);
      }
      scratch.x[k] = sum.x(), scratch.y[k] = sum.y(), scratch.z[k] = sum.z();
    }
  });
  system_.solve(scratch.x, scratch.y, scratch.z, scratch.solver);
  FASCIA_ASSERT(areFinite(scratch.x) && areFinite(scratch.y) && areFinite(scratch.z),
                "the solution is finite");
  for (std::size_t k = 0; k < solved_.size(); ++k)
    position[solved_[k]] += Vector4f(scratch.x[k], scratch.y[k], scratch.z[k], 0);
}

}  // namespace fascia
