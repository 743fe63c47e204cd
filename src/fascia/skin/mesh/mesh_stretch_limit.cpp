#include <fascia/skin/mesh/mesh_stretch_limit.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <queue>
#include <utility>

namespace fascia {
namespace {

using Edge = StretchLimit::Edge;
using Follower = StretchLimit::Follower;
using Level = StretchLimit::Level;

// No fewer points are made fewer: there is nothing left to pass on.
constexpr std::size_t kFewest = 24;
constexpr float kFar = std::numeric_limits<float>::infinity();

// The edges of one level, and what is around each of its points.
class Graph {
 public:
  struct Way {
    std::uint32_t to;
    float length_m;
  };

  explicit Graph(const std::vector<Edge>& edges) {
    for (const Edge& edge : edges) {
      around_[edge.a].push_back({edge.b, edge.longest_m});
      around_[edge.b].push_back({edge.a, edge.longest_m});
    }
  }
  const std::map<std::uint32_t, std::vector<Way>>& points() const { return around_; }
  const std::vector<Way>& around(std::uint32_t point) const { return around_.at(point); }

 private:
  std::map<std::uint32_t, std::vector<Way>> around_;
};

// The leaders among a level's points: no two of them share an edge, and no further point could be
// one. Every point belongs to the nearest leader.
class Leaders {
 public:
  struct Nearest {
    std::uint32_t leader = 0;
    float distance_m = kFar;
  };

  explicit Leaders(const Graph& graph) : graph_(graph) {
    for (const auto& [point, ways] : graph.points()) {
      const bool led = std::ranges::any_of(
          ways, [&](const Graph::Way& way) { return nearest_.contains(way.to); });
      if (!led) nearest_[point] = {point, 0}, ++count_;
    }
    spread();
  }

  std::size_t count() const { return count_; }

  // Chords between leaders that share a neighbour, or whose surroundings touch.
  std::vector<Edge> edges() const {
    std::map<std::pair<std::uint32_t, std::uint32_t>, float> chords;
    const auto add = [&](std::uint32_t a, std::uint32_t b, float length_m) {
      if (a >= b) return;
      const auto [chord, isNew] = chords.try_emplace({a, b}, length_m);
      chord->second = std::min(chord->second, length_m);
    };
    for (const auto& [point, ways] : graph_.points()) {
      const Nearest& here = nearest_.at(point);
      for (const Graph::Way& way : ways) {
        const Nearest& there = nearest_.at(way.to);
        add(here.leader, there.leader, here.distance_m + way.length_m + there.distance_m);
        if (there.leader != way.to) continue;
        for (const Graph::Way& other : ways)
          if (nearest_.at(other.to).leader == other.to)
            add(way.to, other.to, way.length_m + other.length_m);
      }
    }
    std::vector<Edge> edges;
    edges.reserve(chords.size());
    for (const auto& [ends, length_m] : chords)
      edges.push_back({ends.first, ends.second, length_m});
    return edges;
  }

  // All other points, each with the nearest of the leaders around it.
  std::vector<Follower> followers() const {
    std::vector<Follower> followers;
    for (const auto& [point, ways] : graph_.points())
      if (nearest_.at(point).leader != point) followers.push_back(follower(point, ways));
    return followers;
  }

 private:
  // From all leaders at once along the edges.
  void spread() {
    using Reached = std::pair<float, std::uint32_t>;  // way so far, point
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> next;
    for (const auto& [point, nearest] : nearest_) next.push({0, point});
    while (!next.empty()) {
      const auto [distance_m, point] = next.top();
      next.pop();
      const Nearest here = nearest_[point];
      if (distance_m > here.distance_m) continue;
      for (const Graph::Way& way : graph_.around(point)) {
        Nearest& there = nearest_[way.to];
        if (distance_m + way.length_m >= there.distance_m) continue;
        there = {here.leader, distance_m + way.length_m};
        next.push({there.distance_m, way.to});
      }
    }
  }

  Follower follower(std::uint32_t point, const std::vector<Graph::Way>& ways) const {
    std::map<std::uint32_t, float> distances;  // of leaders, over one neighbour
    const auto add = [&](const Nearest& nearest, float further_m) {
      const auto [found, isNew] = distances.try_emplace(nearest.leader, kFar);
      found->second = std::min(found->second, nearest.distance_m + further_m);
    };
    add(nearest_.at(point), 0);
    for (const Graph::Way& way : ways) add(nearest_.at(way.to), way.length_m);
    std::vector<std::pair<float, std::uint32_t>> sorted;
    sorted.reserve(distances.size());
    for (const auto& [leader, distance_m] : distances) sorted.push_back({distance_m, leader});
    std::ranges::sort(sorted);

    // What is twice as far weighs a quarter; places without a leader weigh nothing.
    Follower follower{point, {}, {}};
    follower.leaders.fill(sorted.front().second);
    const std::size_t count = std::min(sorted.size(), follower.leaders.size());
    float sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
      follower.leaders[i] = sorted[i].second;
      const float ratio = sorted.front().first / sorted[i].first;
      sum += follower.weights[i] = ratio * ratio;
    }
    for (float& weight : follower.weights) weight /= sum;
    return follower;
  }

  const Graph& graph_;
  std::map<std::uint32_t, Nearest> nearest_;
  std::size_t count_ = 0;
};

}  // namespace

std::vector<Level> meshStretchLimits(std::vector<Edge> edges) {
  std::vector<Level> levels;
  levels.push_back({std::move(edges), {}});
  for (;;) {
    const Graph graph(levels.back().edges);
    if (graph.points().size() < kFewest) break;
    const Leaders leaders(graph);
    std::vector<Edge> chords = leaders.edges();
    if (chords.empty()) break;
    levels.push_back({std::move(chords), leaders.followers()});
  }
  std::ranges::reverse(levels);
  return levels;
}

}  // namespace fascia
