#include <fascia/pose/limb_contact.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>

namespace fascia {
namespace {

using Eigen::Vector3f;

// Joints bend a crease between these angles (rad).
constexpr float kStraight = 0.3f, kBent = 0.9f;
// Kept between two sides, in radii of the other limb.
constexpr float kGap = 0.02f;
// What overlaps at rest by more than this share of the radius is not skin that meets.
constexpr float kMostOverlap = 0.15f;
// A limb that is driven right through another is the motion's business: between these depths, in
// radii of the thinner limb, a contact lets go as a whole.
constexpr float kHolds = 1, kLetsGo = 2.4f;
// How far a contact may move a point, in local radii.
constexpr float kFarthest = 0.8f;
constexpr int kPushes = 2;
// The last word.
constexpr int kContactPasses = 4;
constexpr std::uint8_t kContactRings = 5;  // 1: hit points
// Skin near a contact takes part in it: by this factor less from point to point.
constexpr float kInfluence = 0.6f;

}  // namespace

void LimbContact::measureBend(std::span<const JointMotion> motion, std::span<float> bend) const {
  FASCIA_ASSERT(bend.size() <= motion.size() && bend.size() <= parts_->part.size(),
                "a bend for each joint");
  for (std::size_t j = 0; j < bend.size(); ++j) {
    bend[j] = 0;
    const int above = parts_->bodyAbove(j);
    if (above < 0 || !parts_->part[j].exists()) continue;
    const Vector4f axis = wide(parts_->part[j].axis());
    const float cosine =
        (motion[static_cast<std::size_t>(above)].rotation * axis).dot(motion[j].rotation * axis);
    bend[j] =
        smoothStep((std::acos(std::clamp(cosine, -1.f, 1.f)) - kStraight) / (kBent - kStraight));
  }
}

// Bounds in a pose: which limbs come near which, and which clusters of their skin.
void LimbContact::cull(std::span<const JointMotion> motion, std::span<const float> bend,
                       std::span<const Vector4f> position, Scratch& scratch) const {
  FASCIA_ASSERT(position.size() == rest_.size() && scratch.pairGate.size() == pairs_.size(),
                "the pose is of this skin");
  const auto reachOf = [](const LimbPart& p) { return 0.5f * p.length_m() + p.greatestRadius_m(); };
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const Pair& pair = pairs_[k];
    const LimbPart &a = parts_->part[pair.a], &b = parts_->part[pair.b];
    const Vector4f apart =
        motion[pair.a].point(wide(a.middle_m())) - motion[pair.b].point(wide(b.middle_m()));
    const float reach = reachOf(a) + reachOf(b);
    const bool bent = bend[pair.bending] > 0;
    scratch.pairGate[k] = bent && apart.squaredNorm() < reach * reach ? 1.f : 0.f;
  }
  parallelFor(clusters_.size(), [&](std::size_t c) {
    const Cluster& cluster = clusters_[c];
    FASCIA_ASSERT(!cluster.points.empty() && cluster.home < pairsOf_.size(),
                  "a cluster holds points of a part");
    std::vector<std::uint32_t>& near = scratch.near[c];
    near.clear();
    Vector4f middle = Vector4f::Zero();
    for (const std::uint32_t i : cluster.points) middle += position[i];
    middle /= static_cast<float>(cluster.points.size());
    float squared = 0;
    for (const std::uint32_t i : cluster.points)
      squared = std::max(squared, (position[i] - middle).squaredNorm());
    const float radius = std::sqrt(squared);
    for (const std::uint32_t k : pairsOf_[cluster.home]) {
      if (scratch.pairGate[k] <= 0) continue;
      const LimbPart& b = parts_->part[pairs_[k].b];
      const Vector3f at = narrow(motion[pairs_[k].b].pointBack(middle));
      if (b.distanceFromSegment(at) < b.greatestRadius_m() + radius) near.push_back(k);
    }
  });
}

// The limb that a point, at x, has sunk into farthest.
LimbContact::Hit LimbContact::find(std::span<const JointMotion> motion,
                                   std::span<const std::uint32_t> near, std::uint32_t point,
                                   const Vector4f& x) const {
  FASCIA_ASSERT(point < parts_->home.size() && x.allFinite(), "a point is somewhere");
  Hit best;
  const std::uint32_t home = parts_->home[point];
  const Vector4f normal = motion[home].rotation * normal_[point];
  float own = 0;
  Vector4f ownAway = Vector4f::Zero();
  bool haveOwn = false;
  for (const std::uint32_t k : near) {
    const Pair& pair = pairs_[k];
    const LimbPart& b = parts_->part[pair.b];
    const Vector3f at = narrow(motion[pair.b].pointBack(x));
    if (b.distanceFromSegment(at) >= b.greatestRadius_m()) continue;
    Vector3f away;
    const float other = b.distance(at, away);
    if (other >= 0) continue;
    const float radius = b.meanRadius_m();
    const float overlap = overlap_m_[pair.overlap + parts_->place[point]];
    if (overlap > kMostOverlap * radius) continue;
    if (!haveOwn) {
      Vector3f mine;
      own = parts_->part[home].distance(narrow(motion[home].pointBack(x)), mine);
      ownAway = motion[home].rotation * wide(mine);
      haveOwn = true;
    }
    const float depth = own - other - overlap - noise_m_;
    if (depth <= 0) continue;
    const Vector4f otherAway = motion[pair.b].rotation * wide(away);
    const Vector4f gradient = ownAway - otherAway;
    const float slope = gradient.norm();
    if (slope < 0.15f) continue;
    // Depth grows along the gradient, the skin looks that way, and not away from the other limb
    // (or buttocks would dent); deep enough to be real; where the other limb has skin.
    const float gate =
        smoothStep((slope - 0.15f) / 0.5f) * smoothStep(normal.dot(gradient) / slope / 0.3f) *
        smoothStep(-other / (0.02f * radius)) * smoothStep((0.6f - normal.dot(otherAway)) / 0.6f) *
        (1 - smoothStep(overlap / (kMostOverlap * radius))) * smoothStep(1.4f * b.confidence(at));
    if (depth * gate > best.depth_m * best.gate) best = {static_cast<std::int32_t>(k), depth, gate};
  }
  return best;
}

Vector4f LimbContact::pushOut(std::span<const JointMotion> motion, const Pair& pair,
                              std::uint32_t point, const Vector4f& x, float share,
                              float depth_m) const {
  FASCIA_ASSERT(point < parts_->radius_m.size() && share >= 0, "a point is pushed outward");
  const LimbPart &a = parts_->part[pair.a], &b = parts_->part[pair.b];
  const float gap = kGap * b.meanRadius_m() * smoothStep(depth_m / (0.1f * b.meanRadius_m()));
  const float overlap = overlap_m_[pair.overlap + parts_->place[point]];
  Vector4f to = x;
  for (int push = 0; push < kPushes; ++push) {
    Vector3f mine, theirs;
    const float own = a.distance(narrow(motion[pair.a].pointBack(to)), mine);
    const float other = b.distance(narrow(motion[pair.b].pointBack(to)), theirs);
    const float depth = own - other - overlap + gap;
    if (depth <= 0) break;
    const Vector4f gradient =
        motion[pair.a].rotation * wide(mine) - motion[pair.b].rotation * wide(theirs);
    to -= share * depth / std::max(0.25f, gradient.squaredNorm()) * gradient;
  }
  const float way = (to - x).norm(), most = kFarthest * parts_->radius_m[point];
  return way > most ? Vector4f(x + most / way * (to - x)) : to;
}

void LimbContact::findHits(std::span<const JointMotion> motion, std::span<const Vector4f> position,
                           Scratch& scratch) const {
  parallelFor(clusters_.size(), [&](std::size_t c) {
    if (scratch.near[c].empty()) return;
    for (const std::uint32_t i : clusters_[c].points)
      scratch.hit[i] = find(motion, scratch.near[c], i, position[i]);
  });
}

// Which contacts count as a whole: both sides must be hit (one-sided hits are faults of the fit),
// and not too deep.
void LimbContact::gatePairs(std::span<const float> bend, Scratch& scratch) const {
  FASCIA_ASSERT(
      scratch.pairDepth.size() == pairs_.size() && scratch.pairGate.size() == pairs_.size(),
      "a gate for each pair");
  std::fill(scratch.pairDepth.begin(), scratch.pairDepth.end(), 0.f);
  for (const LimbContact::Hit& hit : scratch.hit) {
    if (hit.pair < 0) continue;
    float& depth = scratch.pairDepth[static_cast<std::size_t>(hit.pair)];
    depth = std::max(depth, hit.depth_m * hit.gate);
  }
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const Pair& pair = pairs_[k];
    const float own = scratch.pairDepth[k];
    const float theirs =
        pair.mirror < 0 ? 0 : scratch.pairDepth[static_cast<std::size_t>(pair.mirror)];
    const float deepest = std::max(own, theirs);
    const float radius =
        std::min(parts_->part[pair.a].meanRadius_m(), parts_->part[pair.b].meanRadius_m());
    scratch.pairGate[k] =
        deepest <= 0
            ? 0
            : bend[pair.bending] * smoothStep(8 * std::min(own, theirs) / (deepest + 1e-9f)) *
                  (1 - smoothStep((deepest / radius - kHolds) / (kLetsGo - kHolds)));
  }
}

void LimbContact::meet(std::span<const JointMotion> motion, std::span<const float> bend,
                       std::span<Vector4f> position, std::span<Vector4f> turn,
                       std::span<WideRotation> rotation, Scratch& scratch) const {
  FASCIA_ASSERT(position.size() == rest_.size() && turn.size() == rest_.size() &&
                    rotation.size() == rest_.size(),
                "the pose is of this skin");
  scratch.hit.assign(rest_.size(), {});
  scratch.touched = false;
  scratch.pairDepth.resize(pairs_.size());
  scratch.pairGate.resize(pairs_.size());
  scratch.near.resize(clusters_.size());
  cull(motion, bend, position, scratch);
  findHits(motion, position, scratch);
  gatePairs(bend, scratch);
  scratch.touched = false;
  for (std::uint32_t i = 0; i < rest_.size(); ++i) {
    Hit& hit = scratch.hit[i];
    if (hit.pair < 0) continue;
    hit.gate *= scratch.pairGate[static_cast<std::size_t>(hit.pair)];
    if (hit.gate <= 1e-3f) {
      hit.pair = -1;
      continue;
    }
    const Pair& pair = pairs_[static_cast<std::size_t>(hit.pair)];
    const float rigid = smoothStep(hit.depth_m / (0.4f * parts_->radius_m[i])) * hit.gate;
    const Vector4f carried = motion[pair.a].point(rest_[i]);
    position[i] = pushOut(motion, pair, i, position[i] + rigid * (carried - position[i]), hit.gate,
                          hit.depth_m);
    const Vector4f& home = motion[pair.a].turn;
    turn[i] =
        ((1 - rigid) * turn[i] + (home.dot(turn[i]) < 0 ? -rigid : rigid) * home).normalized();
    rotation[i] = rotationOf(turn[i]);
    scratch.touched = true;
  }
}

// Hit points and the rings around them.
void LimbContact::spreadActive(Scratch& scratch) const {
  FASCIA_ASSERT(scratch.hit.size() == rest_.size(), "contacts were found for each point");
  scratch.ring.assign(rest_.size(), 0);
  scratch.active.clear();
  for (std::uint32_t i = 0; i < rest_.size(); ++i)
    if (scratch.hit[i].pair >= 0) {
      scratch.ring[i] = 1;
      scratch.active.push_back(i);
    }
  std::size_t begin = 0;
  for (std::uint8_t ring = 2; ring <= kContactRings; ++ring) {
    const std::size_t end = scratch.active.size();
    for (; begin < end; ++begin) {
      const std::uint32_t i = scratch.active[begin];
      for (std::uint32_t q = firstEdge_[i]; q < firstEdge_[i + 1]; ++q) {
        const std::uint32_t j = edges_[q].to;
        if (scratch.ring[j]) continue;
        scratch.ring[j] = ring;
        scratch.active.push_back(j);
      }
    }
  }
  scratch.influence.resize(rest_.size());
  scratch.influenceNext.resize(rest_.size());
  for (const std::uint32_t i : scratch.active)
    scratch.influence[i] = scratch.ring[i] == 1 ? scratch.hit[i].gate : 0;
  for (int pass = 0; pass < kContactRings - 1; ++pass) {
    for (const std::uint32_t i : scratch.active) {
      float most = 0;
      for (std::uint32_t q = firstEdge_[i]; q < firstEdge_[i + 1]; ++q)
        if (scratch.ring[edges_[q].to]) most = std::max(most, scratch.influence[edges_[q].to]);
      scratch.influenceNext[i] = std::max(scratch.influence[i], kInfluence * most);
    }
    for (const std::uint32_t i : scratch.active) scratch.influence[i] = scratch.influenceNext[i];
  }
}

void LimbContact::finish(std::span<const JointMotion> motion,
                         std::span<const WideRotation> rotation, std::span<Vector4f> position,
                         Scratch& scratch) const {
  if (!scratch.touched) return;
  spreadActive(scratch);
  FASCIA_ASSERT(position.size() == rest_.size() && rotation.size() == rest_.size(),
                "the pose is of this skin");
  scratch.before.resize(rest_.size());
  scratch.next.resize(rest_.size());
  for (const std::uint32_t i : scratch.active) {
    scratch.before[i] = position[i];
    for (std::uint32_t q = firstEdge_[i]; q < firstEdge_[i + 1]; ++q)
      scratch.before[edges_[q].to] = position[edges_[q].to];
  }
  // Hit points towards the rotated rest shape, by their gate; others give way with their
  // neighbours.
  const auto relaxed = [&](std::uint32_t i) -> Vector4f {
    Vector4f moved = Vector4f::Zero(), sum = Vector4f::Zero(), turned = Vector4f::Zero(),
             own = Vector4f::Zero();
    float total = 1e-9f;
    const float hit = scratch.ring[i] == 1 ? scratch.hit[i].gate : 0;
    for (std::uint32_t q = firstEdge_[i]; q < firstEdge_[i + 1]; ++q) {
      const Edge& e = edges_[q];
      const float w = e.weighted.w();
      total += w;
      moved += w * (position[e.to] - scratch.before[e.to]);
      if (hit <= 0) continue;
      sum += w * position[e.to];
      turned += rotation[e.to] * e.weighted;
      own += e.weighted;
    }
    const Vector4f along = scratch.before[i] + moved / total - position[i];
    if (hit <= 0) return position[i] + 0.4f * along;
    const Vector4f smooth = (sum + 0.5f * (turned + rotation[i] * own)) / total - position[i];
    return position[i] + (1 - hit) * 0.4f * along + hit * 0.3f * smooth;
  };
  const auto project = [&](std::uint32_t i, const Vector4f& x) -> Vector4f {
    const std::int32_t cluster = clusterOf_[i];
    if (scratch.ring[i] >= kContactRings || cluster < 0) return x;
    const std::vector<std::uint32_t>& near = scratch.near[static_cast<std::size_t>(cluster)];
    if (near.empty()) return x;
    const Hit hit = find(motion, near, i, x);
    if (hit.pair < 0) return x;
    const float gate =
        scratch.influence[i] * hit.gate * scratch.pairGate[static_cast<std::size_t>(hit.pair)];
    return pushOut(motion, pairs_[static_cast<std::size_t>(hit.pair)], i, x, gate,
                   std::max(hit.depth_m, scratch.hit[i].depth_m));
  };
  constexpr std::size_t kChunk = 64;
  const std::size_t count = scratch.active.size();
  for (int pass = 0; pass < kContactPasses; ++pass) {
    parallelFor((count + kChunk - 1) / kChunk, [&](std::size_t chunk) {
      const std::size_t end = std::min(count, kChunk * (chunk + 1));
      for (std::size_t k = kChunk * chunk; k < end; ++k) {
        const std::uint32_t i = scratch.active[k];
        scratch.next[i] = project(i, relaxed(i));
      }
    });
    for (const std::uint32_t i : scratch.active) position[i] = scratch.next[i];
  }
}

}  // namespace fascia
