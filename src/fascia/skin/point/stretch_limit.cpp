#include <fascia/skin/point/stretch_limit.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <fascia/math/points.h>

namespace fascia {
namespace {

// Times through all levels, at most: one will do but for what has been torn far.
constexpr int kCycles = 2;
constexpr int kSweeps = 2;  // of each level
// An edge is too long from this part of its limit beyond it on.
constexpr float kTolerance = 0.02f;

// The share of the way together that goes to `a`: by mass, and all of it if `b` cannot move.
float shareOf(const PointModel& points, std::size_t a, std::size_t b) {
  if (points.free[a] == 0) return 0;
  if (points.free[b] == 0) return 1;
  const float both = points.mass[a] + points.mass[b];
  return both > 0 ? points.mass[b] / both : 0.5f;
}

void add(VectorArray& a, std::size_t k, const Eigen::Vector3f& v) {
  a.x[k] += v.x(), a.y[k] += v.y(), a.z[k] += v.z();
}

}  // namespace

StretchLimit::StretchLimit(std::vector<Level> levels) : levels_(std::move(levels)) {
  if (levels_.empty()) return;
  std::vector<Edge> edges = levels_.back().edges;
  const auto step = [](const Edge& e) { return std::int64_t{e.b} - std::int64_t{e.a}; };
  std::ranges::sort(edges, {}, [&](const Edge& e) { return std::pair(step(e), e.a); });
  for (const Edge& edge : edges) {
    const bool goesOn = !runs_.empty() && runs_.back().step == step(edge) &&
                        runs_.back().first + runs_.back().count == edge.a;
    if (!goesOn)
      runs_.push_back({edge.a, 0, static_cast<std::int32_t>(step(edge)),
                       static_cast<std::uint32_t>(longest_m_.size())});
    ++runs_.back().count;
    longest_m_.push_back(edge.longest_m);
  }
}

void StretchLimit::apply(const PointModel& points, VectorArray& position, VectorArray& velocity) {
  for (int cycle = 0; cycle < kCycles && exceeded(position, kTolerance); ++cycle) {
    for (const Level& level : levels_) {
      const bool leads = !level.followers.empty();
      if (leads) position_ = position, velocity_ = velocity;
      for (int s = 0; s < kSweeps; ++s) sweep(level, points, position, velocity);
      if (!leads) continue;
      follow(level, points, position_, position);
      follow(level, points, velocity_, velocity);
    }
  }
}

bool StretchLimit::exceeded(const VectorArray& position, float share) const {
  return anyEdgeExceeds(runs_, longest_m_, position, share);
}

double StretchLimit::shareExceeding(const VectorArray& position, float share) const {
  if (levels_.empty()) return 0;
  const std::vector<Edge>& edges = levels_.back().edges;
  const auto count = std::ranges::count_if(edges, [&](const Edge& edge) {
    return (floatPointAt(position, edge.b) - floatPointAt(position, edge.a)).norm() >
           (1 + share) * edge.longest_m;
  });
  return static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(edges.size(), 1));
}

void StretchLimit::sweep(const Level& level, const PointModel& points, VectorArray& position,
                         VectorArray& velocity) const {
  for (const Edge& edge : level.edges) shorten(edge, points, position, velocity);
  for (auto edge = level.edges.rbegin(); edge != level.edges.rend(); ++edge)
    shorten(*edge, points, position, velocity);
}

void StretchLimit::shorten(const Edge& edge, const PointModel& points, VectorArray& position,
                           VectorArray& velocity) {
  const Eigen::Vector3f way = floatPointAt(position, edge.b) - floatPointAt(position, edge.a);
  const float squared = way.squaredNorm();
  if (!(squared > edge.longest_m * edge.longest_m)) return;
  const float a = shareOf(points, edge.a, edge.b), b = shareOf(points, edge.b, edge.a);
  if (a + b == 0) return;
  const Eigen::Vector3f excess = (1 - edge.longest_m / std::sqrt(squared)) * way;
  add(position, edge.a, a * excess);
  add(position, edge.b, -b * excess);
  const float parting =
      (floatPointAt(velocity, edge.b) - floatPointAt(velocity, edge.a)).dot(way) / squared;
  if (!(parting > 0)) return;
  add(velocity, edge.a, a * parting * way);
  add(velocity, edge.b, -b * parting * way);
}

void StretchLimit::follow(const Level& level, const PointModel& points, const VectorArray& before,
                          VectorArray& values) {
  for (const Follower& f : level.followers) {
    if (points.free[f.point] == 0) continue;
    Eigen::Vector3f change = Eigen::Vector3f::Zero();
    for (std::size_t i = 0; i < f.leaders.size(); ++i)
      if (points.free[f.leaders[i]] > 0)
        change += f.weights[i] *
                  (floatPointAt(values, f.leaders[i]) - floatPointAt(before, f.leaders[i]));
    add(values, f.point, change);
  }
}

}  // namespace fascia
