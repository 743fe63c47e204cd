#include <fascia/skin/self_contact/self_contact_model.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <queue>

#include <fascia/base/parallel.h>
#include <fascia/geometry/triangle_hierarchy.h>
#include <fascia/math/points.h>
#include <fascia/skin/self_contact/self_contact_search.h>

namespace fascia {
namespace {

using Triangles = std::span<const std::array<std::uint32_t, 3>>;
using RestDistance = SelfContactModel::RestDistance;

// Half the circle that a sheet can be bent into without coming nearer than the gap to itself is
// π/2 gaps long; points twice as far apart on the surface may touch.
constexpr double kNearGaps = kPi;
// Where edges are short (faces, hands) the gap is at most this share of them: wider, and neighbours
// in a crease push each other out of line.
constexpr float kGapOfEdges = 1.f / 3;
// Points farther in front of a group than this many of its edges are no matter of this interval,
// unless they approach: in hands and faces everything is near everything.
constexpr float kAheadEdges = 0.5f;
// Patches are as wide as this many edges where their normals differ by one: narrow around limbs.
constexpr float kTurnEdges = 4;
// Caps the list of points that are near on the surface, for meshes much finer than the gap.
constexpr std::size_t kMostNear = 256;
// What of a limb's thickness a point may come through from one side.
constexpr float kDepthShare = 0.5f;
// In the rest shape deeper points count too: they may come up later. Below the share that would
// take the other side of every thin limb for one that came through.
constexpr float kRestDepthScale = 1.5f;
// Sheets nearer than this many gaps in the rest shape cross, for all that rounding can tell.
constexpr float kCrossing = 0.02f;
// Distances in the rest shape are kept up to rounding.
constexpr float kRestSlack = 0.02f;
// How many points around one that crosses another part at rest are left alone like that one.
constexpr int kSpread = 2;
// Distance to keep between what crosses.
constexpr float kLeaveAlone = -1e30f;

constexpr std::size_t wholeVectors(std::size_t count) {
  return (count + SelfContactModel::kLanes - 1) / SelfContactModel::kLanes *
         SelfContactModel::kLanes;
}

// Points joined by edges, each list sorted.
Lists<std::uint32_t> neighborsOf(Triangles triangles, std::size_t points) {
  std::vector<std::vector<std::uint32_t>> sets(points);
  for (const auto& t : triangles)
    for (std::size_t c = 0; c < 3; ++c)
      for (const std::size_t other : {(c + 1) % 3, (c + 2) % 3}) sets[t[c]].push_back(t[other]);
  Lists<std::uint32_t> out;
  for (std::vector<std::uint32_t>& set : sets) {
    std::sort(set.begin(), set.end());
    out.items.insert(out.items.end(), set.begin(), std::unique(set.begin(), set.end()));
    out.endList();
  }
  return out;
}

// All points within a distance along edges, and those one edge away: Dijkstra's search from one
// point at a time.
class NearSearch {
 public:
  NearSearch(const Lists<std::uint32_t>& neighbors, const VectorArray& rest)
      : neighbors_(neighbors), rest_(rest), distance_(neighbors.size(), kFar) {}

  void append(std::uint32_t start, float limit_m, std::vector<std::uint32_t>& out) {
    reach(start, 0);
    for (const std::uint32_t n : neighbors_[start]) reach(n, length(start, n));
    while (!queue_.empty() && reached_.size() < kMostNear) {
      const auto [distance, point] = queue_.top();
      queue_.pop();
      if (distance > limit_m || distance > distance_[point]) continue;
      for (const std::uint32_t n : neighbors_[point])
        if (distance + length(point, n) <= limit_m) reach(n, distance + length(point, n));
    }
    out.insert(out.end(), reached_.begin(), reached_.end());
    for (const std::uint32_t p : reached_) distance_[p] = kFar;
    reached_.clear();
    queue_ = {};
  }

 private:
  static constexpr float kFar = 1e30f;
  using Entry = std::pair<float, std::uint32_t>;

  float length(std::uint32_t a, std::uint32_t b) const {
    return (floatPointAt(rest_, a) - floatPointAt(rest_, b)).norm();
  }
  void reach(std::uint32_t point, float distance) {
    if (!(distance < distance_[point])) return;
    if (distance_[point] == kFar) reached_.push_back(point);
    distance_[point] = distance;
    queue_.push({distance, point});
  }

  const Lists<std::uint32_t>& neighbors_;
  const VectorArray& rest_;
  std::vector<float> distance_;
  std::vector<std::uint32_t> reached_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

class Preparation {
 public:
  Preparation(Triangles triangles, const VectorArray& rest, const std::vector<PointBlock>& blocks,
              float gap_m)
      : triangles_(triangles), rest_(rest) {
    model_.neighbors = neighborsOf(triangles, rest.size());
    model_.gap_m = gap_m;
    model_.points = rest.size();
    for (const PointBlock& b : blocks)
      for (std::uint32_t l = 0; l < b.count; ++l)
        tested_.push_back(static_cast<std::uint32_t>(b.first) + l);
  }

  SelfContactModel run() {
    makePatches();
    makeGroups();
    model_.tree.build(boxes_);
    makeFans();
    findNearPoints();
    measureDepths();
    measureRestDistances();
    return std::move(model_);
  }

 private:
  // Halves the points along the widest of their six dimensions, place and normal, in whole patches.
  void makePatches() {
    TriangleMesh& mesh = mesh_;
    for (std::size_t k = 0; k < model_.points; ++k)
      mesh.positions.push_back(floatPointAt(rest_, k));
    mesh.triangles.assign(triangles_.begin(), triangles_.end());
    computeNormals(mesh.positions, mesh.triangles, mesh.normals);
    meanEdge_m_ = meanEdgeLength();
    model_.gap_m = std::min(model_.gap_m, meanEdge_m_);
    std::erase_if(tested_, [&](std::uint32_t k) { return model_.neighbors[k].empty(); });
    measureSurroundings();
    split(tested_);
  }

  void measureSurroundings() {
    SelfContactModel& m = model_;
    for (FloatArray* a : {&m.edge_m, &m.pointGap_m, &m.roughAtRest_m}) a->assign(m.points, 0.f);
    for (std::size_t k = 0; k < m.points; ++k) {
      const std::span<const std::uint32_t> neighbors = m.neighbors[k];
      if (neighbors.empty()) continue;
      const auto count = static_cast<float>(neighbors.size());
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      for (const std::uint32_t n : neighbors) {
        sum += floatPointAt(rest_, n);
        m.edge_m[k] += (floatPointAt(rest_, n) - floatPointAt(rest_, k)).norm() / count;
      }
      m.roughAtRest_m[k] = (floatPointAt(rest_, k) - sum / count).norm();
      m.pointGap_m[k] = std::min(m.gap_m, kGapOfEdges * m.edge_m[k]);
    }
  }

  void split(std::span<std::uint32_t> points) {
    if (points.empty()) return;
    if (points.size() <= SelfContactModel::Patch::kCapacity) {
      std::sort(points.begin(), points.end());
      SelfContactModel::Patch& patch = model_.patches.emplace_back();
      patch.count = static_cast<std::uint32_t>(points.size());
      for (std::size_t l = 0; l < SelfContactModel::Patch::kCapacity; ++l)
        patch.points[l] = static_cast<std::int32_t>(points[std::min(l, points.size() - 1)]);
      return;
    }
    using Six = Eigen::Vector<float, 6>;
    const auto at = [&](std::uint32_t k) {
      Six six;
      six << mesh_.positions[k], kTurnEdges * meanEdge_m_ * mesh_.normals[k];
      return six;
    };
    Six low = at(points.front()), high = low;
    for (const std::uint32_t k : points) low = low.cwiseMin(at(k)), high = high.cwiseMax(at(k));
    Eigen::Index axis;
    (high - low).maxCoeff(&axis);
    const std::size_t patches = (points.size() + SelfContactModel::Patch::kCapacity - 1) /
                                SelfContactModel::Patch::kCapacity,
                      half = patches / 2 * SelfContactModel::Patch::kCapacity;
    std::nth_element(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(half),
                     points.end(), [&](std::uint32_t a, std::uint32_t b) {
                       const float x = at(a)[axis], y = at(b)[axis];
                       return x != y ? x < y : a < b;
                     });
    split(points.first(half));
    split(points.subspan(half));
  }

  // The patch that most corners of a triangle are in; the number of patches if none is.
  std::vector<std::uint32_t> patchesOfTriangles() const {
    const auto none = static_cast<std::uint32_t>(model_.patches.size());
    std::vector<std::uint32_t> ofPoint(model_.points, none), ofTriangle;
    for (std::uint32_t p = 0; p < none; ++p)
      for (const std::int32_t k : model_.patches[p].points)
        ofPoint[static_cast<std::size_t>(k)] = p;
    for (const auto& t : triangles_) {
      std::array<std::uint32_t, 3> of{ofPoint[t[0]], ofPoint[t[1]], ofPoint[t[2]]};
      std::sort(of.begin(), of.end());
      // `none` sorts last.
      ofTriangle.push_back(of[1] != none && of[1] == of[2] ? of[1] : of[0]);
    }
    return ofTriangle;
  }

  void makeGroups() {
    constexpr std::size_t kMost = SelfContactModel::Group::kCapacity;
    const std::vector<std::uint32_t> patch = patchesOfTriangles();
    std::vector<std::uint32_t> order(triangles_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return patch[a] < patch[b]; });
    for (std::size_t begin = 0, end; begin < order.size(); begin = end) {
      end = begin;
      while (end < order.size() && patch[order[end]] == patch[order[begin]]) ++end;
      const std::size_t count = end - begin, parts = (count + kMost - 1) / kMost;
      for (std::size_t p = 0; p < parts; ++p)
        addGroup(std::span(order).subspan(begin + count * p / parts,
                                          count * (p + 1) / parts - count * p / parts));
    }
  }

  void addGroup(std::span<const std::uint32_t> members) {
    SelfContactModel& m = model_;
    const std::size_t first = m.corners[0].size(), count = wholeVectors(members.size());
    m.groups.push_back(
        {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count), 0, 0});
    std::vector<std::uint32_t> points;
    Box box;
    for (std::size_t i = 0; i < count; ++i) {
      const auto& t = triangles_[members[std::min(i, members.size() - 1)]];
      for (std::size_t c = 0; c < 3; ++c) {
        m.corners[c].push_back(static_cast<std::int32_t>(t[c]));
        points.push_back(t[c]);
        box.add(floatPointAt(rest_, t[c]).cast<double>());
      }
      isRepeated_.push_back(i >= members.size());
    }
    float edge_m = 0;
    for (const std::uint32_t k : points) edge_m += m.edge_m[k] / static_cast<float>(points.size());
    m.groups.back().ahead_m = m.gap_m + kAheadEdges * edge_m;
    std::sort(points.begin(), points.end());
    const auto end = std::unique(points.begin(), points.end());
    groupPoints_.items.insert(groupPoints_.items.end(), points.begin(), end);
    groupPoints_.endList();
    boxes_.push_back(box);
    m.depth_m.resize(m.corners[0].size());
  }

  void makeFans() {
    SelfContactModel& m = model_;
    std::vector<std::vector<std::int32_t>> around(wholeVectors(m.points));
    m.area_m2.assign(m.points, 0.f);
    for (std::size_t t = 0; t < m.triangleCount(); ++t) {
      if (isRepeated_[t]) continue;
      const auto [a, b, c] = m.triangle(t);
      const Eigen::Vector3f r = floatPointAt(rest_, a);
      const float area =
          0.5f * (floatPointAt(rest_, b) - r).cross(floatPointAt(rest_, c) - r).norm();
      for (const std::uint32_t corner : {a, b, c}) {
        around[corner].push_back(static_cast<std::int32_t>(t));
        m.area_m2[corner] += area / 3;
      }
    }
    const auto missing = static_cast<std::int32_t>(m.triangleCount());
    for (std::size_t k = 0; k < around.size(); k += SelfContactModel::kLanes) {
      const auto chunk = std::span(around).subspan(k, SelfContactModel::kLanes);
      std::size_t slots = 0;
      for (const auto& list : chunk) slots = std::max(slots, list.size());
      for (std::size_t slot = 0; slot < slots; ++slot)
        for (const auto& list : chunk)
          m.fans.items.push_back(slot < list.size() ? list[slot] : missing);
      m.fans.endList();
    }
  }

  void findNearPoints() {
    NearSearch search(model_.neighbors, rest_);
    const auto limit_m = static_cast<float>(kNearGaps * model_.gap_m);
    for (std::size_t k = 0; k < model_.points; ++k) {
      search.append(static_cast<std::uint32_t>(k), limit_m, model_.nearPoints.items);
      model_.nearPoints.endList();
    }
  }

  // From rays into the flesh, up to about one edge.
  void measureDepths() {
    SelfContactModel& m = model_;
    const TriangleHierarchy hierarchy(mesh_);
    const auto thickness = [&](const Vec3& from, const Vec3& normal, double most_m) {
      const Vec3 inside = from - 1e-3 * most_m * normal;
      const auto hit = hierarchy.firstHit(inside, -normal, most_m);
      return static_cast<float>(hit ? hit->t : most_m);
    };
    parallelFor(m.groups.size(), [&](std::size_t g) {
      for (std::size_t t = m.groups[g].first; t < m.groups[g].first + m.groups[g].count; ++t) {
        const auto corners = m.triangle(t);
        Vec3 center = Vec3::Zero(), normal = Vec3::Zero();
        float edge = 0;
        for (std::size_t c = 0; c < 3; ++c) {
          center += floatPointAt(rest_, corners[c]).cast<double>() / 3;
          normal += mesh_.normals[corners[c]].cast<double>();
          edge = std::max(
              edge,
              (floatPointAt(rest_, corners[c]) - floatPointAt(rest_, corners[(c + 1) % 3])).norm());
        }
        const float most_m = (m.gap_m + std::min(edge, meanEdge_m_)) / kDepthShare;
        float least_m = thickness(center, normal.normalized(), most_m);
        for (const std::uint32_t c : corners)
          least_m = std::min(least_m, thickness(floatPointAt(rest_, c).cast<double>(),
                                                mesh_.normals[c].cast<double>(), most_m));
        m.depth_m[t] = kDepthShare * least_m;
        m.groups[g].deepest_m = std::max(m.groups[g].deepest_m, m.depth_m[t]);
      }
    });
    for (const SelfContactModel::Group& g : m.groups)
      m.deepest_m = std::max(m.deepest_m, g.deepest_m);
  }

  float meanEdgeLength() const {
    double sum = 0;
    for (const auto& t : triangles_)
      for (std::size_t c = 0; c < 3; ++c)
        sum += (floatPointAt(rest_, t[c]) - floatPointAt(rest_, t[(c + 1) % 3])).norm();
    return static_cast<float>(sum /
                              static_cast<double>(std::max<std::size_t>(1, 3 * triangles_.size())));
  }

  // What touches in the rest shape already, and spreads that over the surroundings of both.
  void measureRestDistances() {
    std::vector<std::vector<RestDistance>> lists(model_.points);
    model_.leftAlone.first.resize(model_.patches.size() + 1);  // nothing yet
    SurfaceSearch search(model_);
    const VectorArray still(model_.points);
    search.update(rest_, still, 0);
    const SurfaceSearch::Query query{model_.gap_m, kRestDepthScale, rest_, still};
    PointLanes lanes;
    for (std::size_t p = 0; p < model_.patches.size(); ++p)
      search.search(p, query, lanes, [&](std::uint32_t group, const Touch& touch) {
        if (touch.distance_m >= model_.gap_m) return;
        const bool crosses = touch.distance_m < kCrossing * model_.gap_m;
        lists[static_cast<std::size_t>(model_.patches[p].points[touch.lane])].push_back(
            {group, crosses ? kLeaveAlone : (1 - kRestSlack) * touch.distance_m});
      });
    spreadOverGroups(lists);
    for (int turn = 0; turn < kSpread; ++turn) spreadOverPoints(lists);
    for (std::size_t k = 0; k < lists.size(); ++k) {
      for (const RestDistance& r : lists[k])
        if (r.keep_m != kLeaveAlone) model_.restDistances.items.push_back(r);
      model_.restDistances.endList();
    }
    model_.leftAlone = {};
    for (const SelfContactModel::Patch& patch : model_.patches) {
      std::map<std::uint32_t, std::uint32_t> crossing;
      for (std::uint32_t l = 0; l < patch.count; ++l)
        for (const RestDistance& r : lists[static_cast<std::size_t>(patch.points[l])])
          if (r.keep_m == kLeaveAlone) crossing[r.group] |= 1u << l;
      for (const auto& [group, bits] : crossing) model_.leftAlone.items.push_back({group, bits});
      model_.leftAlone.endList();
    }
  }

  // Keeps the least distance of each group.
  static void reduce(std::vector<RestDistance>& list) {
    std::sort(list.begin(), list.end(), [](const RestDistance& a, const RestDistance& b) {
      return a.group != b.group ? a.group < b.group : a.keep_m < b.keep_m;
    });
    const auto same = [](const RestDistance& a, const RestDistance& b) {
      return a.group == b.group;
    };
    list.erase(std::unique(list.begin(), list.end(), same), list.end());
  }

  void spreadOverGroups(std::vector<std::vector<RestDistance>>& lists) const {
    const SelfContactModel& m = model_;
    std::vector<std::vector<std::uint32_t>> groupsOfPoint(m.points);
    for (std::uint32_t g = 0; g < m.groups.size(); ++g)
      for (const std::uint32_t p : groupPoints_[g]) groupsOfPoint[p].push_back(g);
    for (std::vector<RestDistance>& list : lists) {
      reduce(list);
      const std::vector<RestDistance> own = list;
      for (const RestDistance& r : own)
        for (const std::uint32_t p : groupPoints_[r.group])
          for (const std::uint32_t g : groupsOfPoint[p]) list.push_back({g, r.keep_m});
      reduce(list);
    }
  }

  void spreadOverPoints(std::vector<std::vector<RestDistance>>& lists) const {
    const std::vector<std::vector<RestDistance>> before = lists;
    for (std::size_t k = 0; k < lists.size(); ++k) {
      for (const std::uint32_t n : model_.neighbors[k])
        lists[k].insert(lists[k].end(), before[n].begin(), before[n].end());
      reduce(lists[k]);
    }
  }

  Triangles triangles_;
  const VectorArray& rest_;
  std::vector<std::uint32_t> tested_;  // points
  TriangleMesh mesh_;                  // the rest shape
  float meanEdge_m_ = 0;
  std::vector<bool> isRepeated_;  // per triangle of the model
  Lists<std::uint32_t> groupPoints_;
  std::vector<Box> boxes_;  // of groups
  SelfContactModel model_;
};

}  // namespace

SelfContactModel prepareSelfContact(std::span<const std::array<std::uint32_t, 3>> triangles,
                                    const VectorArray& rest, const std::vector<PointBlock>& blocks,
                                    float gap_m) {
  return Preparation(triangles, rest, blocks, gap_m).run();
}

}  // namespace fascia
