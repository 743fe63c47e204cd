#include <fascia/pose/limb_press.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>

namespace fascia {
namespace {

using Eigen::Vector3f;

constexpr std::size_t kPatchPoints = 32;
// Softer than this on the mean a limb gives way at all; and a point of it.
constexpr float kLeastSoftLimb = 0.15f, kLeastSoftSkin = 0.02f;
// Kept between the two, and how near at rest is a touch already, in radii of the soft limb.
constexpr float kPressMargin = 0.02f, kTouching = 0.6f;
// Depths in radii of the soft limb, between which a contact lets go, and how far flesh gives way.
constexpr float kPressHolds = 0.05f, kPressLetsGo = 0.8f, kPressFarthest = 0.25f;
// How far from the bone, in radii, what presses is wholly on this side of it.
constexpr float kThisSide = 0.15f;
// Where a dent has faded out: so many edges and depths beyond its core.
constexpr float kFadeEdges = 3, kFadeDepths = 1.5f;
// How far beyond its ends a limb takes its neighbours' skin along, in radii.
constexpr float kBeyond = 1;
// Points that press stand so far apart, in edges of what they press on.
constexpr float kPressSpacing = 1.0f;

const LimbPress::FourTouches kNoTouches = [] {
  const Eigen::Array4f zero = Eigen::Array4f::Zero();
  return LimbPress::FourTouches{zero, zero, zero, zero, zero, zero + 1};
}();

// Whether skin of the two belongs together by itself: one carries the other within two bones.
bool hangTogether(std::span<const int> above, std::uint32_t a, std::uint32_t b) {
  const auto within = [&](std::uint32_t from, std::uint32_t to) {
    int j = static_cast<int>(from);
    for (int steps = 0; steps < 2 && j >= 0; ++steps) {
      j = above[static_cast<std::size_t>(j)];
      if (j == static_cast<int>(to)) return true;
    }
    return false;
  };
  return within(a, b) || within(b, a);
}

// The first of the points in each cube.
std::vector<std::uint32_t> thinned(const PoseMesh& mesh, std::span<const std::uint32_t> points,
                                   float cube_m) {
  std::set<std::array<int, 3>> taken;
  std::vector<std::uint32_t> kept;
  for (const std::uint32_t i : points) {
    std::array<int, 3> cube;
    for (int a = 0; a < 3; ++a)
      cube[static_cast<std::size_t>(a)] = static_cast<int>(std::floor(mesh.rest[i][a] / cube_m));
    if (taken.insert(cube).second) kept.push_back(i);
  }
  return kept;
}

}  // namespace

LimbPress::LimbPress(const PoseSource& source, const PoseMesh& mesh,
                     std::shared_ptr<const LimbParts> parts, std::span<const float> softness)
    : parts_(std::move(parts)), softness_(softness.begin(), softness.end()) {
  FASCIA_ASSERT(parts_ && softness_.size() == mesh.size(), "a softness for each point");
  const auto joints = static_cast<std::uint32_t>(source.joints.size());
  for (std::uint32_t j = 0; j < joints; ++j) above_.push_back(parts_->bodyAbove(j));
  std::vector<Limb> all(joints);
  parallelFor(joints, [&](std::size_t b) {
    Limb& limb = all[b];
    limb = {static_cast<std::uint32_t>(b), 0, 0, {}, {}};
    if (!parts_->part[b].exists()) return;
    float soft = 0;
    for (const std::uint32_t i : parts_->skin[b]) {
      soft += softness_[i];
      limb.highest_m = std::max(limb.highest_m, parts_->own_m[i]);
      limb.core_m += mesh.edge_m[i];
    }
    const auto count = static_cast<float>(parts_->skin[b].size());
    if (soft < kLeastSoftLimb * count) return;
    limb.core_m /= count;
    for (std::uint32_t a = 0; a < joints; ++a)
      if (a != b && !hangTogether(above_, a, limb.joint)) addPressers(mesh, a, limb);
    if (!limb.pressers.empty()) addPatches(mesh, limb);
  });
  for (Limb& limb : all)
    if (!limb.patches.empty()) limbs_.push_back(std::move(limb));
}

void LimbPress::addPatches(const PoseMesh& mesh, Limb& limb) const {
  const float beyond = kBeyond * parts_->part[limb.joint].meanRadius_m();
  const std::vector<float> way = wayAlongEdges(mesh, parts_->skin[limb.joint], beyond);
  std::vector<std::uint32_t> points;
  for (std::uint32_t i = 0; i < mesh.size(); ++i)
    if (way[i] < beyond && softness_[i] >= kLeastSoftSkin) points.push_back(i);
  forClusters(mesh, points, kPatchPoints, [&](std::span<const std::uint32_t> cluster) {
    Patch patch{{}, {cluster.begin(), cluster.end()}, {}};
    for (const std::uint32_t i : cluster) {
      const Vector3f room = Vector3f::Constant(parts_->radius_m[i]);
      patch.box.extend(mesh.rest[i] - room).extend(mesh.rest[i] + room);
      patch.share.push_back(1 - smoothStep(way[i] / beyond));
    }
    limb.patches.push_back(std::move(patch));
  });
}

void LimbPress::addPressers(const PoseMesh& mesh, std::uint32_t joint, Limb& limb) const {
  const LimbPart& body = parts_->part[limb.joint];
  std::vector<std::uint32_t> points =
      thinned(mesh, parts_->skin[joint], kPressSpacing * limb.core_m);
  const auto clearOf = [&](std::uint32_t i) {
    return smoothStep((body.distance(mesh.rest[i]) - limb.highest_m) /
                      (kTouching * body.meanRadius_m()));
  };
  std::erase_if(points, [&](std::uint32_t i) { return clearOf(i) <= 0; });
  forClusters(mesh, points, kPatchPoints, [&](std::span<const std::uint32_t> cluster) {
    Presser presser{joint, Vector4f::Zero(), 0, {cluster.begin(), cluster.end()}, {}};
    for (const std::uint32_t i : cluster) {
      presser.middle += wide(mesh.rest[i]) / static_cast<float>(cluster.size());
      presser.clear.push_back(clearOf(i));
    }
    for (const std::uint32_t i : cluster)
      presser.radius_m = std::max(
          presser.radius_m, (wide(mesh.rest[i]) - presser.middle).norm() + parts_->radius_m[i]);
    limb.pressers.push_back(std::move(presser));
  });
}

void LimbPress::findTouches(const Limb& limb, std::span<const JointMotion> motion,
                            std::span<const Vector4f> position, Scratch::OfLimb& found) const {
  found.touches.clear();
  const LimbPart& body = parts_->part[limb.joint];
  const JointMotion& own = motion[limb.joint];
  const float within = std::max(limb.highest_m, 0.f) + kPressMargin * body.meanRadius_m();
  for (const Presser& presser : limb.pressers) {
    const Vector3f middle = narrow(own.pointBack(motion[presser.joint].point(presser.middle)));
    if (body.distanceFromSegment(middle) > body.greatestRadius_m() + within + presser.radius_m)
      continue;
    for (std::size_t k = 0; k < presser.points.size(); ++k) {
      const std::uint32_t i = presser.points[k];
      const Vector3f at = narrow(own.pointBack(position[i]));
      if (body.distanceFromSegment(at) > body.greatestRadius_m() + within) continue;
      const float height = body.distance(at);
      if (height >= within) continue;
      // Where the body is only a guess nothing touches it.
      const float gate = presser.clear[k] * smoothStep(1.4f * body.confidence(at));
      if (gate > 1e-3f) found.touches.push_back({at, height, gate, softness_[i], presser.joint});
    }
  }
}

// A limb lets go together with those that it hangs on and that hang on it: hands as a whole.
void LimbPress::letGo(const Limb& limb, Scratch::OfLimb& found) const {
  found.depth_m.assign(above_.size(), 0.f);
  for (const Touch& t : found.touches)
    found.depth_m[t.joint] = std::max(found.depth_m[t.joint], -t.gate * t.height_m);
  found.around_m = found.depth_m;
  for (std::size_t j = 0; j < above_.size(); ++j) {
    if (above_[j] < 0) continue;
    const auto above = static_cast<std::size_t>(above_[j]);
    found.around_m[j] = std::max(found.around_m[j], found.depth_m[above]);
    found.around_m[above] = std::max(found.around_m[above], found.depth_m[j]);
  }
  const float radius = parts_->part[limb.joint].meanRadius_m();
  for (Touch& t : found.touches)
    t.gate *= 1 - smoothStep((found.around_m[t.joint] / radius - kPressHolds) /
                             (kPressLetsGo - kPressHolds));
  std::erase_if(found.touches, [](const Touch& t) { return t.gate <= 1e-3f; });
}

float LimbPress::sinkOf(const Limb& limb, std::span<const FourTouches> touches, std::uint32_t point,
                        float fade_m, const Place& place) const {
  using Eigen::Array4f;
  const float soft = softness_[point], radius = parts_->part[limb.joint].meanRadius_m(),
              gap = kPressMargin * radius;
  const auto smooth = [](const Array4f& t) -> Array4f {
    const Array4f cut = t.max(0.f).min(1.f);
    return cut * cut * (3 - 2 * cut);
  };
  Array4f most = Array4f::Zero();
  for (const FourTouches& t : touches) {
    const Array4f depth = (place.height_m - t.height_m).max(0.f);
    const Array4f x = t.x - place.at.x(), y = t.y - place.at.y(), z = t.z - place.at.z();
    const Array4f along = x * place.away.x() + y * place.away.y() + z * place.away.z();
    const Array4f down = along + depth;  // from where the point comes to when it sinks as deep
    const Array4f beside = (x * x + y * y + z * z + down * down - along * along).max(0.f).sqrt();
    // Nothing beyond the bone presses on this side.
    const Array4f thisSide = smooth((place.fromBone_m + along) / (kThisSide * radius));
    const Array4f share = t.gate * thisSide * (soft / (soft + t.soft));
    most = most.max(share * (depth + gap * smooth(0.5f / gap * depth)) *
                    (1 - smooth((beside - limb.core_m) / fade_m)));
  }
  // As deep as it should, up to a limit.
  const float limit = kPressFarthest * radius * std::sqrt(soft);
  const float way = most.maxCoeff() / limit, squared = way * way;
  return limit * way / std::sqrt(std::sqrt(1 + squared * squared));
}

void LimbPress::giveWay(const Limb& limb, const JointMotion& own, std::span<Vector4f> position,
                        Scratch::OfLimb& found) const {
  const LimbPart& body = parts_->part[limb.joint];
  float deepest = 0;
  for (const Touch& t : found.touches)
    deepest = std::max(deepest, t.gate * (limb.highest_m - t.height_m));
  const float fade = kFadeEdges * limb.core_m + kFadeDepths * deepest;
  found.near.resize(limb.patches.size());
  parallelFor(limb.patches.size(), [&](std::size_t p) {
    const Patch& patch = limb.patches[p];
    const float reach = limb.core_m + fade + deepest;
    if (std::none_of(found.touches.begin(), found.touches.end(),
                     [&](const Touch& t) { return patch.box.exteriorDistance(t.at) < reach; }))
      return;
    std::array<Place, kPatchPoints> places;
    Eigen::AlignedBox3f box;
    float highest = -std::numeric_limits<float>::max();
    for (std::size_t k = 0; k < patch.points.size(); ++k) {
      Place& place = places[k];
      place.at = narrow(own.pointBack(position[patch.points[k]]));
      // Skin of neighbours may stand higher; what is clear at rest is clear of that as well.
      place.height_m = std::min(body.distance(place.at, place.away), limb.highest_m);
      place.fromBone_m = body.distanceFromSegment(place.at);
      highest = std::max(highest, place.height_m);
      box.extend(place.at);
    }
    std::vector<FourTouches>& near = found.near[p];
    near.clear();
    Eigen::Index lane = 3;
    for (const Touch& t : found.touches) {
      if (t.height_m >= highest || box.exteriorDistance(t.at) >= reach) continue;
      lane = (lane + 1) % 4;
      if (lane == 0) near.push_back(kNoTouches);
      FourTouches& four = near.back();
      four.x[lane] = t.at.x(), four.y[lane] = t.at.y(), four.z[lane] = t.at.z();
      four.height_m[lane] = t.height_m, four.gate[lane] = t.gate, four.soft[lane] = t.soft;
    }
    if (near.empty()) return;
    for (std::size_t k = 0; k < patch.points.size(); ++k) {
      const std::uint32_t j = patch.points[k];
      const float sink = patch.share[k] * sinkOf(limb, near, j, fade, places[k]);
      if (sink > 0) position[j] -= sink * (own.rotation * wide(places[k].away));
    }
  });
}

void LimbPress::press(std::span<const JointMotion> motion, std::span<Vector4f> position,
                      Scratch& scratch) const {
  scratch.limbs.resize(limbs_.size());
  parallelFor(limbs_.size(), [&](std::size_t n) {
    findTouches(limbs_[n], motion, position, scratch.limbs[n]);
    letGo(limbs_[n], scratch.limbs[n]);
  });
  // One after the other: at their ends they share skin.
  for (std::size_t n = 0; n < limbs_.size(); ++n)
    if (!scratch.limbs[n].touches.empty())
      giveWay(limbs_[n], motion[limbs_[n].joint], position, scratch.limbs[n]);
}

}  // namespace fascia
