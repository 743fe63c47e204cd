#include <fascia/pose/base_pose.h>

#include <algorithm>
#include <cmath>
#include <map>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>

namespace fascia {
namespace {

using Eigen::Vector3f;

constexpr float kSigma = 0.1f;  // width of the similarity of weights
// Where the polynomial (1 - d²/reach²)³ that stands for exp(-d²/σ²) ends.
constexpr float kReach2 = 3.f * kSigma * kSigma;
constexpr float kLeastProduct = 1e-4f;  // of two weights that count as shared

// The share of a weight pair on the first of two joints, p / (p + q), and what else of a triangle
// its similarity needs.
struct PairTriangle {
  float p, q;  // mean weights of the two joints
  float area_m2;
  Vector3f middle;
};
using Pair = std::pair<std::uint32_t, std::uint32_t>;

std::map<Pair, std::vector<PairTriangle>> trianglesByPair(const PoseSource& source,
                                                          const PoseMesh& mesh) {
  std::map<Pair, std::vector<PairTriangle>> byPair;
  std::vector<std::pair<std::uint32_t, float>> shares;
  for (const auto& t : mesh.triangles) {
    shares.clear();
    for (const std::uint32_t point : t)
      for (std::size_t k = 0; k < PointWeights::kMost; ++k) {
        const PointWeights& w = source.weights[point];
        if (w.weight[k] <= 0) continue;
        const auto same = [&](const auto& s) { return s.first == w.joint[k]; };
        auto found = std::find_if(shares.begin(), shares.end(), same);
        if (found == shares.end()) found = shares.insert(shares.end(), {w.joint[k], 0.f});
        found->second += w.weight[k] / 3;
      }
    std::sort(shares.begin(), shares.end());
    const Vector3f a = mesh.rest[t[0]], b = mesh.rest[t[1]], c = mesh.rest[t[2]];
    const float area = 0.5f * (b - a).cross(c - a).norm();
    for (std::size_t i = 0; i < shares.size(); ++i)
      for (std::size_t j = i + 1; j < shares.size(); ++j)
        if (shares[i].second * shares[j].second > kLeastProduct)
          byPair[{shares[i].first, shares[j].first}].push_back(
              {shares[i].second, shares[j].second, area, (a + b + c) / 3});
  }
  return byPair;
}

// Le & Hodgins' similarity: Σ over pairs of w_p w_q t_p t_q exp(-(w_p t_q - w_q t_p)²/σ²).
Vector3f centerOf(const PointWeights& w, const Vector3f& rest,
                  const std::map<Pair, std::vector<PairTriangle>>& byPair) {
  Vector3f sum = Vector3f::Zero();
  float total = 0;
  for (std::size_t a = 0; a < PointWeights::kMost; ++a)
    for (std::size_t b = 0; b < PointWeights::kMost; ++b) {
      if (w.joint[a] >= w.joint[b] || w.weight[a] * w.weight[b] < kLeastProduct) continue;
      const auto found = byPair.find({w.joint[a], w.joint[b]});
      if (found == byPair.end()) continue;
      for (const PairTriangle& t : found->second) {
        const float d = w.weight[a] * t.q - w.weight[b] * t.p;
        const float near = 1 - d * d / kReach2;
        if (near <= 0) continue;
        const float similarity = w.weight[a] * w.weight[b] * t.p * t.q * near * near * near;
        sum += t.area_m2 * similarity * t.middle;
        total += t.area_m2 * similarity;
      }
    }
  return total > 1e-14f ? Vector3f(sum / total) : rest;
}

}  // namespace

BasePose::BasePose(const PoseSource& source, const PoseMesh& mesh) {
  FASCIA_ASSERT(source.weights.size() == mesh.size(), "every point has weights");
  const auto byPair = trianglesByPair(source, mesh);
  rest_.resize(mesh.size());
  center_.resize(mesh.size());
  parallelFor((mesh.size() + 255) / 256, [&](std::size_t chunk) {
    const std::size_t end = std::min(mesh.size(), 256 * chunk + 256);
    for (std::size_t i = 256 * chunk; i < end; ++i) {
      rest_[i] = wide(mesh.rest[i]);
      center_[i] = wide(centerOf(source.weights[i], mesh.rest[i], byPair));
    }
  });
  firstInfluence_.push_back(0);
  for (const PointWeights& w : source.weights) {
    for (std::size_t k = 0; k < PointWeights::kMost; ++k)
      if (w.weight[k] > 0) influences_.push_back({w.joint[k], w.weight[k]});
    firstInfluence_.push_back(static_cast<std::uint32_t>(influences_.size()));
  }
}

void BasePose::place(std::span<const JointMotion> joints, std::size_t begin, std::size_t end,
                     std::span<Vector4f> position, std::span<Vector4f> turn,
                     std::span<WideRotation> rotation) const {
  FASCIA_ASSERT(begin <= end && end <= rest_.size(), "the points exist");
  FASCIA_ASSERT(position.size() >= end && turn.size() >= end && rotation.size() >= end,
                "a place for each point");
  for (std::size_t i = begin; i < end; ++i) {
    const Influence* k = &influences_[firstInfluence_[i]];
    const Influence* last = influences_.data() + firstInfluence_[i + 1];
    FASCIA_ASSERT(k < last && k->joint < joints.size(), "a joint carries the point");
    const JointMotion& heaviest = joints[k->joint];
    if (last - k == 1) {
      position[i] = heaviest.point(rest_[i]);
      turn[i] = heaviest.turn;
      rotation[i] = heaviest.rotation;
      continue;
    }
    Vector4f quaternion = Vector4f::Zero(), center = Vector4f::Zero();
    for (; k != last; ++k) {
      const JointMotion& joint = joints[k->joint];
      quaternion += (joint.turn.dot(heaviest.turn) < 0 ? -k->weight : k->weight) * joint.turn;
      center += k->weight * joint.point(center_[i]);
    }
    turn[i] = quaternion / std::sqrt(std::max(1e-20f, quaternion.squaredNorm()));
    rotation[i] = rotationOf(turn[i]);
    position[i] = center + rotation[i] * (rest_[i] - center_[i]);
  }
}

}  // namespace fascia
