#include <fascia/skin/self_contact_search.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/parallel.h>
#include <fascia/geometry/closest_point.h>

namespace fascia {
namespace {

// Groups handed to a thread at once.
constexpr std::size_t kGroupsPerTask = 32;
constexpr std::size_t kChunksPerTask = 64;
// Cosine of the normals of a point and of the surface above which they do not face each other:
// beside a crease or on an edge of a limb, not opposite.
constexpr float kFacing = 0.2f;
// The deepest points must face the surface that they came through this clearly: what came out at
// the other side of a limb must not be pulled through its flanks.
constexpr float kFacingDeep = -0.5f;
// A point that is farther beside a triangle than above or below it has nothing to do with it. Near
// the surface, in gaps, directions mean little.
constexpr float kLeastSlope = 0.5f, kAnySlope = 0.25f;
// Corners' unit normals that cancel each other say nothing about the surface between them.
constexpr float kLeastNormal = 0.5f;

Eigen::Vector3f get(const VectorArray& a, std::size_t k) {
  return {a.x[k], a.y[k], a.z[k]};
}

template <class Task>
void forEachInTasks(std::size_t count, std::size_t perTask, const Task& task) {
  parallelFor((count + perTask - 1) / perTask, [&](std::size_t t) {
    const std::size_t end = std::min(count, (t + 1) * perTask);
    for (std::size_t i = t * perTask; i < end; ++i) task(i);
  });
}

// Whether any two directions of the cones are nearer to each other than acos(kMayFace): the sum of
// the half angles and of the axes' angle stays below.
bool neverFace(const NormalCone& a, const NormalCone& b) {
  if (a.cosine <= 0 || b.cosine <= 0) return false;
  const auto sine = [](float c) { return std::sqrt(std::max(0.f, 1 - c * c)); };
  const float sineA = sine(a.cosine), sineB = sine(b.cosine);
  const float cosineSum = a.cosine * b.cosine - sineA * sineB;
  if (cosineSum <= kMayFace) return false;
  const float sineSum = sineA * b.cosine + a.cosine * sineB;
  const float cosineRest = kMayFace * cosineSum + sine(kMayFace) * sineSum;
  const float between = a.axis[0] * b.axis[0] + a.axis[1] * b.axis[1] + a.axis[2] * b.axis[2];
  return between > cosineRest;
}

// The box over the whole interval, seen from the mean motion.
Box sweptBox(const MotionBounds& m, const Vec3& mean, double interval_s, double margin_m) {
  Box box;
  for (int a = 0; a < 3; ++a) {
    box.low[a] = m.low[a] + std::min(0.0, m.slowest[a] - mean[a]) * interval_s - margin_m;
    box.high[a] = m.high[a] + std::max(0.0, m.fastest[a] - mean[a]) * interval_s + margin_m;
  }
  return box;
}

bool nearOnSurface(const SelfContactModel& model, std::uint32_t point, std::uint32_t triangle) {
  const std::span<const std::uint32_t> near = model.nearPoints[point];
  for (const std::uint32_t corner : model.triangle(triangle))
    if (std::find(near.begin(), near.end(), corner) != near.end()) return true;
  return false;
}

}  // namespace

SurfaceSearch::SurfaceSearch(const SelfContactModel& model)
    : model_(&model), frame_(model), groups_(model.groups.size()), boxes_(model.groups.size()) {}

void SurfaceSearch::update(const VectorArray& position, const VectorArray& velocity,
                           float interval_s) {
  interval_s_ = interval_s;
  const SelfContactModel& m = *model_;
  forEachInTasks(groups_.size(), kGroupsPerTask, [&](std::size_t g) {
    groups_[g] = updateGroup(m, g, position, velocity, frame_);
  });
  forEachInTasks(m.fans.size(), kChunksPerTask,
                 [&](std::size_t chunk) { updateNormals(m, chunk, frame_); });
  meanVelocity_.setZero();
  for (const MotionBounds& g : groups_)
    for (int a = 0; a < 3; ++a) meanVelocity_[a] += 0.5 * (g.slowest[a] + g.fastest[a]);
  meanVelocity_ /= static_cast<double>(std::max<std::size_t>(1, groups_.size()));
  for (std::size_t g = 0; g < groups_.size(); ++g)
    boxes_[g] = sweptBox(groups_[g], meanVelocity_, interval_s, 0);
  tree_.itemCount() == boxes_.size() ? tree_.refit(boxes_) : tree_.build(boxes_);
}

void SurfaceSearch::search(std::size_t block, const Query& query, const Visit& visit) const {
  const PointBlock& b = model_->blocks[block];
  PointLanes lanes;
  std::array<Candidate, kMostCandidates> candidates;
  const MotionBounds points = loadLanes(b, query.position, query.velocity, frame_, lanes);
  const float range = std::max(query.ahead_m, query.depthScale * model_->deepest_m);
  const Box box = sweptBox(points, meanVelocity_, interval_s_, range);
  tree_.visit([&](const Box& other) { return meets(box, other); },
              [&](std::uint32_t g) {
                PairReach reach;
                if (!meet(points, groups_[g], query, reach)) return;
                const std::size_t count =
                    findCandidates(*model_, g, frame_, lanes, reach, candidates);
                for (std::size_t c = 0; c < count; ++c) {
                  const auto point = static_cast<std::uint32_t>(b.first + candidates[c].lane);
                  Touch touch;
                  touch.group = g;
                  if (touches(point, candidates[c].triangle, reach, query.position, touch))
                    visit(touch);
                }
              });
}

// How a block and a group can meet; false: not at all.
bool SurfaceSearch::meet(const MotionBounds& points, const MotionBounds& group, const Query& query,
                         PairReach& out) const {
  if (neverFace(points.normals, group.normals)) return false;
  const float range = std::max(query.ahead_m, query.depthScale * model_->deepest_m);
  float way = 0;
  for (int a = 0; a < 3; ++a) {
    // Relative to the group the points go from `back` to `on`.
    const float back = std::min(0.f, (points.slowest[a] - group.fastest[a]) * interval_s_);
    const float on = std::max(0.f, (points.fastest[a] - group.slowest[a]) * interval_s_);
    out.low[a] = points.low[a] + back - range;
    out.high[a] = points.high[a] + on + range;
    if (out.low[a] > group.high[a] || out.high[a] < group.low[a]) return false;
    out.above[a] = on + range;
    out.below[a] = range - back;
    way += std::max(on, -back) * std::max(on, -back);
  }
  out.ahead_m = query.ahead_m + std::sqrt(way);
  out.depthScale = query.depthScale;
  return true;
}

bool SurfaceSearch::touches(std::uint32_t point, std::uint32_t triangle, const PairReach& reach,
                            const VectorArray& position, Touch& out) const {
  if (nearOnSurface(*model_, point, triangle)) return false;
  const auto corners = model_->triangle(triangle);
  const Vec3 p = get(position, point).cast<double>();
  const TrianglePoint nearest = closestPointOnTriangle(p, get(position, corners[0]).cast<double>(),
                                                       get(position, corners[1]).cast<double>(),
                                                       get(position, corners[2]).cast<double>());
  out.point = point, out.triangle = triangle;
  out.weights = nearest.weights.cast<float>();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  for (int c = 0; c < 3; ++c)
    normal += out.weights[c] * get(frame_.normal, corners[static_cast<std::size_t>(c)]);
  const float length = normal.norm();
  if (!(length > kLeastNormal)) return false;
  out.normal = normal / length;
  const Eigen::Vector3f way = (p - nearest.position).cast<float>();
  out.distance_m = way.dot(out.normal);
  out.nearest_m = way.norm();
  if (std::abs(out.distance_m) < kLeastSlope * out.nearest_m &&
      out.nearest_m > kAnySlope * model_->gap_m)
    return false;
  const float depth = out.nearest_m / (reach.depthScale * model_->depth_m[triangle]);
  if (out.distance_m < 0 ? !(depth <= 1) : !(out.distance_m <= reach.ahead_m)) return false;
  out.facing = out.normal.dot(get(frame_.normal, point));
  out.facingLimit = out.distance_m < 0 ? kFacing + depth * (kFacingDeep - kFacing) : kFacing;
  return out.facing < out.facingLimit;
}

}  // namespace fascia
