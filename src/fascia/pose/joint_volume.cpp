#include <fascia/pose/joint_volume.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>
#include <fascia/rig/joint_meaning.h>

namespace fascia {
namespace {

using Eigen::Vector3f;

constexpr float kAround = 2.4f;  // how far around a joint, in its radii
constexpr float kInside = 0.7f;  // how much more comes out on the flesh's side than evenly
constexpr float kBlended = 4;
constexpr float kStill = 0.2f, kTurned = 0.8f;  // rad
constexpr float kMost = 0.3f;                   // of a joint's volume that may come or go
constexpr float kNothing = 1e-5f;
constexpr float kSkinDepth = 0.35f;  // radii below its part's surface: no skin but what is inside

float weightOf(const PointWeights& w, int joint) {
  float sum = 0;
  for (std::size_t k = 0; k < PointWeights::kMost; ++k)
    if (w.joint[k] == joint) sum += w.weight[k];
  return sum;
}

// 0 for joints that are as at rest, 1 where they bend or twist by more than a trifle.
float turnGate(const Vector4f& a, const Vector4f& b) {
  const float angle = 2 * std::acos(std::min(1.f, std::abs(a.dot(b))));
  return smoothStep((angle - kStill) / (kTurned - kStill));
}

float volumeSeenFrom(const Vector4f& center,
                     std::span<const std::array<std::uint32_t, 3>> triangles,
                     std::span<const Vector4f> position) {
  FASCIA_ASSERT(center.allFinite(), "one sees from somewhere");
  float sum = 0;
  for (const auto& t : triangles) {
    const Vector4f a = position[t[0]] - center, b = position[t[1]] - center,
                   c = position[t[2]] - center;
    sum += a.dot(b.cross3(c));
  }
  return sum / 6;
}

// Mean distance from the joint of the skin that both of its sides carry; 0: there is hardly any.
float jointRadius(const PoseSource& source, const PoseMesh& mesh, const LimbParts& parts,
                  std::size_t joint, int bodyAbove) {
  const float near = 3 * parts.part[joint].meanRadius_m();
  float sum = 0, count = 0;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const float away = (mesh.rest[i] - parts.origin_m[joint]).norm();
    if (away >= near) continue;
    const PointWeights& w = source.weights[i];
    float above = weightOf(w, bodyAbove);
    if (parts.parent[joint] != bodyAbove) above += weightOf(w, parts.parent[joint]);
    if (above <= 0.1f || weightOf(w, static_cast<int>(joint)) <= 0.1f) continue;
    sum += away;
    ++count;
  }
  return count < 4 ? 0 : sum / count;
}

// Per point the share of its weight that does not belong to the head and what hangs on it: on a
// skull no flesh comes out.
std::vector<float> offSkull(const PoseSource& source) {
  const std::vector<JointMeaning> meanings = guessMeanings(source.joints);
  std::vector<char> skull;
  for (std::size_t j = 0; j < source.joints.size(); ++j) {
    const int parent = source.joints[j].parent;
    skull.push_back(meanings[j].part == BodyPart::head ||
                    (parent >= 0 && skull[static_cast<std::size_t>(parent)]));
  }
  std::vector<float> share;
  for (const PointWeights& w : source.weights) {
    share.push_back(1);
    for (std::size_t k = 0; k < PointWeights::kMost; ++k)
      if (w.weight[k] > 0 && skull[w.joint[k]]) share.back() -= w.weight[k];
    share.back() = std::max(0.f, share.back());
  }
  return share;
}

}  // namespace

bool JointVolume::choose(const PoseSource& source, const PoseMesh& mesh, const LimbParts& parts,
                         std::size_t joint, Joint& out, std::vector<float>& bump) {
  FASCIA_ASSERT(joint < parts.part.size() && source.weights.size() == mesh.size(),
                "the joint exists");
  const int above = parts.bodyAbove(joint);
  if (above < 0 || !parts.part[joint].exists()) return false;
  const auto parent = static_cast<std::size_t>(above);
  if (!parts.meetInCrease(parent, joint)) return false;
  const bool atHub = parts.hub[parent] != 0;
  const float radius = jointRadius(source, mesh, parts, joint, above);
  if (radius <= 0) return false;
  const Vector3f center = parts.origin_m[joint], toParent = parts.origin_m[parent] - center;
  out.joint = static_cast<std::uint32_t>(joint);
  out.parent = static_cast<std::uint32_t>(above);
  out.center_m = wide(center);
  const bool limb = !atHub && toParent.norm() >= 0.5f * radius;
  out.limbParent = limb ? wide(toParent.normalized()) : Vector4f::Zero();
  out.limbJoint = limb ? wide(parts.part[joint].axis()) : Vector4f::Zero();
  // Skin of armpits and groins belongs to what carries the shoulder and the hip, and to the next.
  std::vector<char> mine(parts.part.size(), 0);
  mine[joint] = mine[static_cast<std::size_t>(parts.parent[joint])] = 1;
  int body = above;
  for (int steps = 0; steps < 3 && body >= 0; ++steps) {
    mine[static_cast<std::size_t>(body)] = 1;
    body = parts.bodyAbove(static_cast<std::size_t>(body));
  }
  bump.assign(mesh.size(), -1.f);
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const std::size_t home = parts.home[i];
    const float away = (mesh.rest[i] - center).norm() / (kAround * radius);
    if (!mine[home] || away >= 1 ||
        parts.own_m[i] <= -kSkinDepth * std::max(1e-6f, parts.part[home].meanRadius_m()))
      continue;
    bump[i] = smoothStep(1.2f * (1 - away));
    // Around hips and chests only what the bend itself deforms: else thighs get saddle bags.
    if (atHub) bump[i] *= smoothStep(kBlended * (1 - source.weights[i].weight[0]));
  }
  for (const auto& t : mesh.triangles)
    if (bump[t[0]] >= 0 && bump[t[1]] >= 0 && bump[t[2]] >= 0) {
      out.triangles.push_back(t);
      const Vector3f a = mesh.rest[t[0]] - center, b = mesh.rest[t[1]] - center,
                     c = mesh.rest[t[2]] - center;
      out.rest_m3 += a.dot(b.cross(c)) / 6;
    }
  return out.rest_m3 > 0.3f * radius * radius * radius;
}

// Smooths the bump and its product with each component of the normal, apart for the parent's and
// the joint's side.
void JointVolume::prepare(const PoseSource& source, const PoseMesh& mesh, const SkinSpread& spread,
                          std::span<const float> keep, std::span<const float> bump, Joint& out) {
  FASCIA_ASSERT(keep.size() == mesh.size() && bump.size() == mesh.size(), "a share for each point");
  const std::size_t count = mesh.size();
  std::vector<float> even(count, 0.f), field[2][3];
  for (auto& side : field)
    for (std::vector<float>& f : side) f.assign(count, 0.f);
  out.totalByParent = out.totalByJoint = Vector3f::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    if (bump[i] <= 0) continue;
    const float amount = bump[i] * keep[i] * mesh.area_m2[i];
    const float ofJoint = weightOf(source.weights[i], static_cast<int>(out.joint));
    even[i] = amount;
    out.total += bump[i] * mesh.area_m2[i];
    for (int a = 0; a < 3; ++a) {
      field[0][a][i] = kInside * (1 - ofJoint) * amount * mesh.normal[i][a];
      field[1][a][i] = kInside * ofJoint * amount * mesh.normal[i][a];
      out.totalByParent[a] +=
          kInside * (1 - ofJoint) * bump[i] * mesh.area_m2[i] * mesh.normal[i][a];
      out.totalByJoint[a] += kInside * ofJoint * bump[i] * mesh.area_m2[i] * mesh.normal[i][a];
    }
  }
  SupernodalCholesky::Scratch scratch;
  spread.spread(even, scratch);
  for (auto& side : field) spread.spread(side[0], side[1], side[2], scratch);
  const float most = *std::max_element(even.begin(), even.end());
  for (std::uint32_t i = 0; i < count; ++i)
    if (even[i] > 1e-3f * most)
      out.reach.push_back({i, even[i], Vector3f(field[0][0][i], field[0][1][i], field[0][2][i]),
                           Vector3f(field[1][0][i], field[1][1][i], field[1][2][i])});
}

JointVolume::JointVolume(const PoseSource& source, const PoseMesh& mesh, const LimbParts& parts,
                         const SkinSpread& spread, std::span<const float> dial) {
  std::vector<float> keep = offSkull(source);
  FASCIA_ASSERT(keep.size() == dial.size(), "a dial for each point");
  for (std::size_t i = 0; i < keep.size(); ++i) keep[i] *= dial[i];
  std::vector<Joint> all(source.joints.size());
  std::vector<char> chosen(all.size(), 0);
  parallelFor(all.size(), [&](std::size_t j) {
    std::vector<float> bump;
    if (!choose(source, mesh, parts, j, all[j], bump)) return;
    prepare(source, mesh, spread, keep, bump, all[j]);
    chosen[j] = 1;
  });
  for (std::size_t j = 0; j < all.size(); ++j)
    if (chosen[j]) joints_.push_back(std::move(all[j]));
}

void JointVolume::restore(std::span<const JointMotion> motion, std::span<const Vector4f> position,
                          std::span<float> along) const {
  FASCIA_ASSERT(along.size() == position.size(), "a way for each point");
  for (const Joint& j : joints_) {
    const JointMotion &parent = motion[j.parent], &own = motion[j.joint];
    FASCIA_ASSERT(j.rest_m3 > 0, "a joint has a volume");
    const float turned = turnGate(parent.turn, own.turn);
    if (turned <= 0) continue;
    const float volume = volumeSeenFrom(own.point(j.center_m), j.triangles, position);
    const float lost =
        turned * std::clamp(j.rest_m3 - volume, -kMost * j.rest_m3, kMost * j.rest_m3);
    if (std::abs(lost) < kNothing * j.rest_m3) continue;
    // What is missing comes out on the inner side of the bend; what is too much goes in on the
    // outer.
    const float side = lost > 0 ? 1.f : -1.f;
    const Vector4f in = side * (parent.rotation * j.limbParent + own.rotation * j.limbJoint);
    const Vector3f byParent = narrow(parent.rotation.back(in)),
                   byJoint = narrow(own.rotation.back(in));
    const float total = j.total + byParent.dot(j.totalByParent) + byJoint.dot(j.totalByJoint);
    const float share = lost / std::max(0.1f * j.total, total);
    for (const Reach& r : j.reach)
      along[r.point] +=
          share * std::max(0.f, r.even + byParent.dot(r.byParent) + byJoint.dot(r.byJoint));
  }
}

}  // namespace fascia
