#include <algorithm>
#include <array>
#include <map>
#include <set>

#include <fascia/pose/limb_contact.h>

namespace fascia {
namespace {

using Eigen::Vector3f;

// Skin so far below its own limb's surface, in radii, is an inner layer (teeth, eyes) and meets
// nobody.
constexpr float kInner = 0.4f;
// Points of a piece on another limb that are more than its rim.
constexpr std::size_t kLeastOfPiece = 12;
constexpr float kNobody = 1e9f;
constexpr std::size_t kClusterPoints = 32;

// Bones whose skin hangs together, both ways: only that folds in a crease. The shells of a doll's
// joints turn inside of each other instead.
std::set<std::array<std::uint32_t, 2>> seamsOf(const PoseMesh& mesh, const LimbParts& parts) {
  std::set<std::array<std::uint32_t, 2>> seams;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = parts.home[t[k]], b = parts.home[t[(k + 1) % 3]];
      if (a != b) seams.insert({a, b}), seams.insert({b, a});
    }
  // Skin of a short bone between two makes no seam of theirs, but their skin still meets.
  const auto direct = seams;
  for (const auto& [a, middle] : direct)
    for (const auto& [other, b] : direct)
      if (other == middle && a != b) seams.insert({a, b});
  return seams;
}

}  // namespace

LimbContact::LimbContact(const PoseSource& source, const PoseMesh& mesh,
                         std::shared_ptr<const LimbParts> parts, std::span<const char> rigid)
    : parts_(std::move(parts)), noise_m_(2e-6f * mesh.size_m) {
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    rest_.push_back(wide(mesh.rest[i]));
    normal_.push_back(wide(mesh.normal[i]));
  }
  pairsOf_.resize(source.joints.size());
  findPairs(source, mesh);
  findClusters(mesh, rigid);
  storeEdges(mesh);
}

void LimbContact::findPairs(const PoseSource& source, const PoseMesh& mesh) {
  std::map<std::array<std::uint32_t, 2>, std::int32_t> found;
  const std::set<std::array<std::uint32_t, 2>> seams = seamsOf(mesh, *parts_);
  const auto count = static_cast<std::uint32_t>(source.joints.size());
  for (std::uint32_t a = 0; a < count; ++a)
    for (std::uint32_t b = 0; b < count; ++b) {
      if (a == b || !parts_->part[a].exists() || !parts_->part[b].exists()) continue;
      if (parts_->hub[a] || parts_->hub[b])
        continue;  // one body is too simple for a hip or a chest
      if (!parts_->meetInCrease(a, b) || !seams.contains({a, b})) continue;
      if (addPair(source, mesh, a, b)) found[{a, b}] = static_cast<std::int32_t>(pairs_.size()) - 1;
    }
  for (Pair& pair : pairs_) {
    const auto mirror = found.find({pair.b, pair.a});
    if (mirror != found.end()) pair.mirror = mirror->second;
  }
}

// False where the two overlap at rest too much to tell a touch from the rest shape.
bool LimbContact::addPair(const PoseSource& source, const PoseMesh& mesh, std::uint32_t a,
                          std::uint32_t b) {
  const LimbPart &own = parts_->part[a], &other = parts_->part[b];
  // Only a piece that goes on over the other limb folds against it; a panel turns inside of others.
  std::map<std::uint32_t, std::size_t> onOther;
  for (const std::uint32_t i : parts_->skin[b]) ++onOther[mesh.piece[i]];
  std::vector<float> overlaps;
  std::size_t clear = 0, bad = 0;
  for (const std::uint32_t i : parts_->skin[a]) {
    const float distance = other.distance(mesh.rest[i]);
    const float overlap = distance < 0 ? std::max(0.f, parts_->own_m[i] - distance) : 0.f;
    if (source.weights[i].weight[0] > 0.8f) {
      ++clear;
      if (overlap > 0.1f * other.meanRadius_m()) ++bad;
    }
    const auto goesOn = onOther.find(mesh.piece[i]);
    const bool alone = goesOn == onOther.end() || goesOn->second < kLeastOfPiece;
    overlaps.push_back(alone || parts_->own_m[i] < -kInner * own.meanRadius_m() ? kNobody
                                                                                : overlap);
  }
  if (clear == 0 || 10 * bad > clear) return false;
  pairsOf_[a].push_back(static_cast<std::uint32_t>(pairs_.size()));
  pairs_.push_back({a, b, -1, std::max(a, b), static_cast<std::uint32_t>(overlap_m_.size())});
  overlap_m_.insert(overlap_m_.end(), overlaps.begin(), overlaps.end());
  return true;
}

void LimbContact::findClusters(const PoseMesh& mesh, std::span<const char> rigid) {
  clusterOf_.assign(mesh.size(), -1);
  for (std::uint32_t a = 0; a < pairsOf_.size(); ++a) {
    if (pairsOf_[a].empty()) continue;
    std::vector<std::uint32_t> skin = parts_->skin[a];
    std::erase_if(skin, [&](std::uint32_t i) { return rigid[i] != 0; });
    forClusters(mesh, skin, kClusterPoints, [&](std::span<const std::uint32_t> points) {
      for (const std::uint32_t i : points)
        clusterOf_[i] = static_cast<std::int32_t>(clusters_.size());
      clusters_.push_back({a, {points.begin(), points.end()}});
    });
  }
}

void LimbContact::storeEdges(const PoseMesh& mesh) {
  firstEdge_.push_back(0);
  for (std::uint32_t i = 0; i < mesh.size(); ++i) {
    for (const PoseMesh::Edge& e : mesh.around(i)) {
      Vector4f weighted = wide(e.weight * (mesh.rest[i] - mesh.rest[e.to]));
      weighted.w() = e.weight;
      edges_.push_back({weighted, e.to});
    }
    firstEdge_.push_back(static_cast<std::uint32_t>(edges_.size()));
  }
}

}  // namespace fascia
