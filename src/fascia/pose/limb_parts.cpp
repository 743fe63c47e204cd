#include <fascia/pose/limb_parts.h>

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include <fascia/base/parallel.h>

namespace fascia {
namespace {

using Eigen::Vector3f;

constexpr std::size_t kLeastPoints = 12;
// A body must be at least so thick (share of the figure's size): thinner ones are wings, hair
// cards, straps. And its skin must have its shape up to this share of its radius: else its contacts
// would be dents where nothing touches.
constexpr float kLeastRadius = 0.004f, kMostResidual = 0.2f;
// Joints closer than this share of the figure's size do not make a bone.
constexpr float kLeastBone = 0.003f;
// Range of the local radius, shares of the figure's size.
constexpr float kThinnest = 0.003f, kThickest = 0.12f;
constexpr int kRadiusPasses = 10;

std::vector<char> jointsThatCarrySkin(const PoseSource& source, const LimbParts& parts) {
  std::vector<char> carries(source.joints.size(), 0);
  for (std::size_t j = carries.size(); j-- > 0;) {
    if (!parts.skin[j].empty()) carries[j] = 1;
    if (carries[j] && source.joints[j].parent >= 0)
      carries[static_cast<std::size_t>(source.joints[j].parent)] = 1;
  }
  return carries;
}

struct Segment {
  Vector3f from, to;
};

// A hub's: along the longest principal axis of its skin, through the middle.
Segment principalSegment(std::span<const Vector3f> skin, const Vector3f& middle) {
  Eigen::Matrix3f spread = Eigen::Matrix3f::Zero();
  for (const Vector3f& x : skin) spread += (x - middle) * (x - middle).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver(spread);
  const Vector3f axis = solver.eigenvectors().col(2);
  const float count = static_cast<float>(skin.size());
  const float along = std::sqrt(std::max(0.f, solver.eigenvalues()[2]) / count);
  const float across =
      std::sqrt(std::max(0.f, solver.eigenvalues()[0] + solver.eigenvalues()[1]) / count / 2);
  const float half = std::max(0.f, 1.5f * (along - across));
  return {middle - half * axis, middle + half * axis};
}

// A last bone's (head, fingertip): from its joint through its skin, so far that the end is round.
Segment endSegment(std::span<const Vector3f> skin, const Vector3f& middle, const Vector3f& joint) {
  const Vector3f off = middle - joint;
  const Vector3f axis = off.norm() > 1e-6f ? Vector3f(off.normalized()) : Vector3f::UnitY();
  std::vector<float> along, away;
  for (const Vector3f& x : skin) {
    along.push_back((x - joint).dot(axis));
    away.push_back((x - joint - along.back() * axis).norm());
  }
  std::sort(along.begin(), along.end());
  std::sort(away.begin(), away.end());
  const float far = along[along.size() * 95 / 100], radius = away[away.size() / 2];
  return {joint, joint + std::max(0.2f * far, far - radius) * axis};
}

LimbPart fitPart(const std::vector<Vector3f>& skin, const Vector3f& joint,
                 const std::vector<Vector3f>& children) {
  if (skin.size() < kLeastPoints) return {};
  Vector3f middle = Vector3f::Zero();
  for (const Vector3f& x : skin) middle += x;
  middle /= static_cast<float>(skin.size());
  const Segment segment = children.size() == 1 ? Segment{joint, children.front()}
                          : children.empty()   ? endSegment(skin, middle, joint)
                                               : principalSegment(skin, middle);
  return LimbPart(skin, segment.from, segment.to);
}

void fitAll(const PoseSource& source, const PoseMesh& mesh, LimbParts& parts,
            std::vector<LimbPart>& shapes) {
  const std::vector<char> carries = jointsThatCarrySkin(source, parts);
  const std::size_t count = source.joints.size();
  std::vector<std::vector<Vector3f>> children(count);
  for (std::size_t k = 0; k < count; ++k) {
    const int parent = source.joints[k].parent;
    if (parent < 0 || !carries[k]) continue;
    const auto p = static_cast<std::size_t>(parent);
    if ((parts.origin_m[k] - parts.origin_m[p]).norm() > kLeastBone * mesh.size_m)
      children[p].push_back(parts.origin_m[k]);
  }
  parallelFor(count, [&](std::size_t j) {
    std::vector<Vector3f> skin;
    for (const std::uint32_t i : parts.skin[j]) skin.push_back(mesh.rest[i]);
    parts.hub[j] = children[j].size() > 1;
    shapes[j] = fitPart(skin, parts.origin_m[j], children[j]);
    if (shapes[j].meanRadius_m() >= kLeastRadius * mesh.size_m &&
        shapes[j].residual(skin) <= kMostResidual)
      parts.part[j] = shapes[j];
  });
}

// Skin without a body of its own (fins, cards) still has a thickness: that of a small limb.
void measureSkin(const PoseMesh& mesh, std::span<const PointWeights> weights,
                 std::span<const LimbPart> shapes, LimbParts& parts) {
  parts.own_m.assign(mesh.size(), 0.f);
  parts.radius_m.assign(mesh.size(), 0.02f * mesh.size_m);
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const LimbPart& shape = shapes[parts.home[i]];
    if (!shape.exists()) continue;
    parts.own_m[i] = shape.distance(mesh.rest[i]);
    // Between two limbs the thinner one counts: chests do not even out armpits.
    float inverse = 0, total = 0;
    for (std::size_t k = 0; k < PointWeights::kMost; ++k) {
      const LimbPart& other = shapes[weights[i].joint[k]];
      if (weights[i].weight[k] <= 0 || !other.exists()) continue;
      inverse +=
          weights[i].weight[k] / std::clamp(other.distanceFromSegment(mesh.rest[i]),
                                            kThinnest * mesh.size_m, kThickest * mesh.size_m);
      total += weights[i].weight[k];
    }
    parts.radius_m[i] = total / inverse;
  }
  smoothAlongEdges(mesh, kRadiusPasses, parts.radius_m);
}

}  // namespace

bool LimbParts::meetInCrease(std::size_t a, std::size_t b) const {
  if (a > b) std::swap(a, b);
  const int above = parent[b];
  const auto hasShortBody = [&](int j) {
    const LimbPart& p = part[static_cast<std::size_t>(j)];
    return !p.exists() || p.length_m() < 1.2f * p.meanRadius_m();
  };
  const bool follows = above == static_cast<int>(a);
  const bool overOne = above >= 0 && !follows && hasShortBody(above) &&
                       parent[static_cast<std::size_t>(above)] == static_cast<int>(a);
  if (!follows && !overOne) return false;
  const Vector3f toA = part[a].middle_m() - origin_m[b], toB = part[b].middle_m() - origin_m[b];
  return toA.dot(toB) <= 0.4f * toA.norm() * toB.norm();
}

int LimbParts::bodyAbove(std::size_t joint) const {
  int j = parent[joint];
  while (j >= 0 && !part[static_cast<std::size_t>(j)].exists())
    j = parent[static_cast<std::size_t>(j)];
  return j;
}

LimbParts makeLimbParts(const PoseSource& source, const PoseMesh& mesh) {
  const std::size_t count = source.joints.size();
  LimbParts parts;
  parts.part.resize(count);
  parts.hub.assign(count, 0);
  parts.skin.resize(count);
  for (const RigJoint& j : source.joints) {
    parts.parent.push_back(j.parent);
    parts.origin_m.push_back(j.rest_world.translation_m.cast<float>());
  }
  for (std::uint32_t i = 0; i < mesh.size(); ++i) {
    const std::uint32_t home = source.weights[i].joint[0];
    parts.home.push_back(home);
    parts.place.push_back(static_cast<std::uint32_t>(parts.skin[home].size()));
    parts.skin[home].push_back(i);
  }
  std::vector<LimbPart> shapes(count);
  fitAll(source, mesh, parts, shapes);
  measureSkin(mesh, source.weights, shapes, parts);
  return parts;
}

}  // namespace fascia
