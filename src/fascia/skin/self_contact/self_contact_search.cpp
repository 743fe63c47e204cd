#include <fascia/skin/self_contact/self_contact_search.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/parallel.h>

namespace fascia {
namespace {

// Groups handed to a thread at once.
constexpr std::size_t kGroupsPerTask = 32;
constexpr std::size_t kChunksPerTask = 64;
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

// The points of a patch that may touch a group at all, bit by bit.
std::uint32_t lanesFor(const SelfContactModel& model, std::size_t patch, std::uint32_t group) {
  const std::uint32_t count = model.patches[patch].count;
  const std::uint32_t used = count >= 32 ? ~0u : (1u << count) - 1;
  const std::span<const SelfContactModel::LeftAlone> list = model.leftAlone[patch];
  const auto found = std::lower_bound(
      list.begin(), list.end(), group,
      [](const SelfContactModel::LeftAlone& l, std::uint32_t g) { return l.group < g; });
  return found != list.end() && found->group == group ? used & ~found->lanes : used;
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

void SurfaceSearch::search(std::size_t patch, const Query& query, PointLanes& lanes,
                           const Visit& visit) const {
  const MotionBounds points =
      loadLanes(*model_, patch, query.position, query.velocity, frame_, lanes);
  const float range = std::max(query.ahead_m, query.depthScale * model_->deepest_m);
  const Box box = sweptBox(points, meanVelocity_, interval_s_, range);
  const auto lookAt = [&](std::uint32_t group) {
    PairReach reach;
    if (!meet(points, group, query, reach)) return;
    reach.lanes = lanesFor(*model_, patch, group);
    const auto tell = [&](const Touch& touch) { visit(group, touch); };
    findTouches(*model_, patch, group, query.position, frame_, reach, lanes, std::cref(tell));
  };
  tree_.visit([&](const Box& other) { return meets(box, other); }, lookAt);
}

// How a patch and a group can meet; false: not at all.
bool SurfaceSearch::meet(const MotionBounds& points, std::uint32_t group, const Query& query,
                         PairReach& out) const {
  const MotionBounds& other = groups_[group];
  std::copy_n(points.normals.axis, 3, out.axis);
  out.cosineNever = cosineNever(points.normals);
  if (within(other.normals, out.axis, out.cosineNever)) return false;
  const SelfContactModel::Group& g = model_->groups[group];
  out.ahead_m = std::min(query.ahead_m, g.ahead_m);
  const float range = std::max(out.ahead_m, query.depthScale * g.deepest_m);
  for (int a = 0; a < 3; ++a) {
    out.low[a] =
        points.low[a] + std::min(0.f, (points.slowest[a] - other.fastest[a]) * interval_s_);
    out.high[a] =
        points.high[a] + std::max(0.f, (points.fastest[a] - other.slowest[a]) * interval_s_);
    if (out.low[a] - range > other.high[a] || out.high[a] + range < other.low[a]) return false;
  }
  out.interval_s = interval_s_;
  out.depthScale = query.depthScale;
  return true;
}

}  // namespace fascia
