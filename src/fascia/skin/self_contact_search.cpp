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
// So near to the surface, in gaps, it does not matter whether a point is beside a triangle.
constexpr float kAnySlope = 0.25f;
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

float sine(float cosine) {
  return std::sqrt(std::max(0.f, 1 - cosine * cosine));
}

// Cosine of the angle to a cone's axis below which a direction is nearer than acos(kMayFace) to all
// of the cone; 2 if there is none.
float cosineNever(const NormalCone& cone) {
  if (cone.cosine <= kMayFace) return 2;
  return kMayFace * cone.cosine + sine(kMayFace) * sine(cone.cosine);
}

// Whether every direction of a cone is nearer to the axis than `cosine`.
bool within(const NormalCone& cone, const float* axis, float cosine) {
  if (cosine > 1 || cone.cosine <= cosine) return false;
  const float between = axis[0] * cone.axis[0] + axis[1] * cone.axis[1] + axis[2] * cone.axis[2];
  return between > cosine * cone.cosine + sine(cosine) * sine(cone.cosine);
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

std::uint32_t lanesBelow(std::uint32_t count) {
  return count >= 32 ? ~0u : (1u << count) - 1;
}

std::uint32_t lanesLeftAlone(const SelfContactModel& model, std::size_t block,
                             std::uint32_t group) {
  const std::span<const SelfContactModel::LeftAlone> list = model.leftAlone[block];
  const auto found = std::lower_bound(
      list.begin(), list.end(), group,
      [](const SelfContactModel::LeftAlone& l, std::uint32_t g) { return l.group < g; });
  return found != list.end() && found->group == group ? found->lanes : 0u;
}

bool nearOnSurface(const SelfContactModel& model, std::uint32_t point, std::uint32_t triangle) {
  const std::span<const std::uint32_t> near = model.nearPoints[point];
  for (const std::uint32_t corner : model.triangle(triangle))
    if (std::find(near.begin(), near.end(), corner) != near.end()) return true;
  return false;
}

}  // namespace

SurfaceSearch::SurfaceSearch(const SelfContactModel& model)
    : model_(&model),
      frame_(model),
      groups_(model.groups.size()),
      boxes_(model.groups.size()),
      tree_(model.tree) {}

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
  tree_.refit(boxes_);
}

void SurfaceSearch::search(std::size_t block, const Query& query, const Visit& visit) const {
  const PointBlock& b = model_->blocks[block];
  PointLanes lanes;
  std::array<Candidate, kMostCandidates> candidates;
  const MotionBounds points = loadLanes(b, query.position, query.velocity, frame_, lanes);
  const float range = std::max(query.ahead_m, query.depthScale * model_->deepest_m);
  const Box box = sweptBox(points, meanVelocity_, interval_s_, range);
  const auto lookAt = [&](std::uint32_t group) {
    PairReach reach;
    if (!meet(points, group, query, reach)) return;
    reach.lanes = ~lanesLeftAlone(*model_, block, group) & lanesBelow(b.count);
    const std::size_t count =
        findCandidates(*model_, group, frame_, reach, query.nearestOnly, lanes, candidates);
    for (std::size_t c = 0; c < count; ++c) {
      const auto [lane, triangle, least_m] = candidates[c];
      if (least_m > lanes.nearest_m[lane]) continue;
      Touch touch;
      touch.point = static_cast<std::uint32_t>(b.first) + lane;
      touch.triangle = triangle, touch.group = group;
      if (touches(query, touch)) visit(touch);
    }
  };
  tree_.visit([&](const Box& other) { return meets(box, other); }, lookAt);
}

// How a block and a group can meet; false: not at all.
bool SurfaceSearch::meet(const MotionBounds& points, std::uint32_t group, const Query& query,
                         PairReach& out) const {
  const MotionBounds& other = groups_[group];
  std::copy_n(points.normals.axis, 3, out.axis);
  out.cosineNever = cosineNever(points.normals);
  if (within(other.normals, out.axis, out.cosineNever)) return false;
  const float range = std::max(query.ahead_m, query.depthScale * model_->groups[group].deepest_m);
  for (int a = 0; a < 3; ++a) {
    out.low[a] =
        points.low[a] + std::min(0.f, (points.slowest[a] - other.fastest[a]) * interval_s_);
    out.high[a] =
        points.high[a] + std::max(0.f, (points.fastest[a] - other.slowest[a]) * interval_s_);
    if (out.low[a] - range > other.high[a] || out.high[a] + range < other.low[a]) return false;
  }
  out.ahead_m = query.ahead_m;
  out.interval_s = interval_s_;
  out.depthScale = query.depthScale;
  return true;
}

// Completes a touch of its point, triangle and group; false: there is none.
bool SurfaceSearch::touches(const Query& query, Touch& touch) const {
  if (nearOnSurface(*model_, touch.point, touch.triangle)) return false;
  const auto corners = model_->triangle(touch.triangle);
  const auto corner = [&](std::size_t c) -> Vec3 {
    return get(query.position, corners[c]).cast<double>();
  };
  const Vec3 p = get(query.position, touch.point).cast<double>();
  const TrianglePoint nearest = closestPointOnTriangle(p, corner(0), corner(1), corner(2));
  touch.weights = nearest.weights.cast<float>();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  for (int c = 0; c < 3; ++c)
    normal += touch.weights[c] * get(frame_.normal, corners[static_cast<std::size_t>(c)]);
  const float length = normal.norm();
  if (!(length > kLeastNormal)) return false;
  touch.normal = normal / length;
  const Eigen::Vector3f way = (p - nearest.position).cast<float>();
  touch.distance_m = way.dot(touch.normal);
  touch.nearest_m = way.norm();
  const float aside_m = (way - touch.distance_m * touch.normal).norm();
  if (aside_m > kSteepest * std::abs(touch.distance_m) &&
      touch.nearest_m > kAnySlope * model_->gap_m)
    return false;
  const bool behind = touch.distance_m < 0;
  const float depth = touch.nearest_m / (query.depthScale * model_->depth_m[touch.triangle]);
  if (behind && !(depth <= 1)) return false;
  touch.facing = touch.normal.dot(get(frame_.normal, touch.point));
  touch.facingLimit = behind ? kFacing + depth * (kFacingDeep - kFacing) : kFacing;
  return touch.facing < touch.facingLimit;
}

}  // namespace fascia
