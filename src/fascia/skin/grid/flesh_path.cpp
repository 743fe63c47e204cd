#include <fascia/skin/grid/flesh_path.h>

#include <algorithm>
#include <limits>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>
#include <fascia/math/points.h>

namespace fascia {
namespace {

constexpr double kShallowCost = 4;       // what one counts that is just below the surface
constexpr double kOutsideCost = 30;      // what a length outside of the flesh counts
constexpr std::size_t kNeighbours = 12;  // of a solid: where the way may lead next
constexpr std::size_t kWaySamples = 8;   // of a way from one to the next
// Of more solids than this, only the straight way is considered: asking all costs their square.
constexpr std::size_t kMostSolids = 1024;
constexpr std::size_t kFinePath = 512;  // places of the polyline while it is smoothed
constexpr int kSmoothPasses = 400;      // evens out what is shorter than a fortieth of its length

class PathSearch {
 public:
  PathSearch(const DistanceField& flesh, const Vec3& from, const Vec3& to) : flesh_(flesh) {
    places_ = {from, to};
    if (flesh.solidCount() > kMostSolids) return;
    for (std::size_t s = 0; s < flesh.solidCount(); ++s) {
      const SolidId id(static_cast<std::int64_t>(s));
      places_.push_back(flesh.bounds(id).center());
    }
  }

  std::vector<Vec3> run() {
    findWays();
    std::vector<std::size_t> before(places_.size(), 0);
    std::vector<double> cost(places_.size(), std::numeric_limits<double>::infinity());
    std::vector<char> done(places_.size(), 0);
    cost[0] = 0;
    for (std::size_t n = 0; n < places_.size(); ++n) {
      std::size_t at = places_.size();
      for (std::size_t p = 0; p < places_.size(); ++p)
        if (!done[p] && (at == places_.size() || cost[p] < cost[at])) at = p;
      done[at] = 1;
      for (const Way& way : ways_[at])
        if (const double sum = cost[at] + way.cost; sum < cost[way.to])
          cost[way.to] = sum, before[way.to] = at;
    }
    std::vector<Vec3> path{places_[1]};
    for (std::size_t p = 1; p != 0; p = before[p]) path.push_back(places_[before[p]]);
    std::reverse(path.begin(), path.end());
    return path;
  }

 private:
  struct Way {
    std::size_t to;
    double cost;
  };

  // Both ends know each other, so that there is always a way.
  void findWays() {
    ways_.resize(places_.size());
    parallelFor(places_.size(), [&](std::size_t p) {
      std::vector<std::pair<double, std::size_t>> near;
      for (std::size_t q = 0; q < places_.size(); ++q)
        if (q != p) near.emplace_back((places_[q] - places_[p]).squaredNorm(), q);
      const std::size_t count = std::min(kNeighbours, near.size());
      std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count),
                        near.end());
      for (std::size_t n = 0; n < near.size(); ++n)
        if (n < count || (p == 0 && near[n].second == 1))
          ways_[p].push_back({near[n].second, costOf(places_[p], places_[near[n].second])});
    });
    // A place that is nobody's neighbour is reached by the ways that lead from it.
    const std::vector<std::vector<Way>> forth = ways_;
    for (std::size_t p = 0; p < forth.size(); ++p)
      for (const Way& way : forth[p]) ways_[way.to].push_back({p, way.cost});
  }

  // Of the least distance to a solid at places along the way: the farther from the depth of its
  // ends, the more it counts, so that a bend is not cut along its inner side.
  double costOf(const Vec3& a, const Vec3& b) const {
    VectorArray at(kWaySamples + 2), normal(kWaySamples + 2);
    for (std::size_t i = 0; i < kWaySamples; ++i)
      setPoint(at, i, a + (static_cast<double>(i) + 0.5) / kWaySamples * (b - a));
    setPoint(at, kWaySamples, a);
    setPoint(at, kWaySamples + 1, b);
    std::vector<float> least(at.size(), 3e38f), found(at.size());
    for (std::size_t s = 0; s < flesh_.solidCount(); ++s) {
      flesh_.evaluate(SolidId(static_cast<std::int64_t>(s)), view(at, 0, at.size()), found.data(),
                      view(normal, 0, at.size()));
      for (std::size_t i = 0; i < at.size(); ++i) least[i] = std::min(least[i], found[i]);
    }
    const double deepest =
        std::max(1e-9, -double{std::min(least[kWaySamples], least[kWaySamples + 1])});
    double weight = 1;
    for (std::size_t i = 0; i < kWaySamples; ++i)
      weight += (least[i] > 0 ? kOutsideCost
                              : kShallowCost * std::clamp(1 + least[i] / deepest, 0.0, 1.0)) /
                kWaySamples;
    return weight * (b - a).norm();
  }

  const DistanceField& flesh_;
  std::vector<Vec3> places_;  // from, to, then the solids' middles
  std::vector<std::vector<Way>> ways_;
};

std::vector<Vec3> evenly(const std::vector<Vec3>& path, std::size_t count) {
  std::vector<double> along(path.size(), 0.0);
  for (std::size_t i = 1; i < path.size(); ++i)
    along[i] = along[i - 1] + (path[i] - path[i - 1]).norm();
  std::vector<Vec3> out;
  std::size_t piece = 0;
  for (std::size_t n = 0; n < count; ++n) {
    const double s = along.back() * static_cast<double>(n) / static_cast<double>(count - 1);
    while (piece + 2 < path.size() && along[piece + 1] < s) ++piece;
    const double length = along[piece + 1] - along[piece];
    const double t = length > 0 ? std::clamp((s - along[piece]) / length, 0.0, 1.0) : 0.0;
    out.push_back(path[piece] + t * (path[piece + 1] - path[piece]));
  }
  return out;
}

}  // namespace

std::vector<Vec3> pathThroughFlesh(const DistanceField& flesh, const Vec3& from, const Vec3& to,
                                   std::size_t count) {
  FASCIA_ASSERT(count >= 2, "a way has two ends");
  std::vector<Vec3> path = evenly(PathSearch(flesh, from, to).run(), kFinePath);
  for (int pass = 0; pass < kSmoothPasses; ++pass) {
    Vec3 before = path.front();
    for (std::size_t i = 1; i + 1 < path.size(); ++i) {
      const Vec3 here = path[i];
      path[i] = 0.25 * before + 0.5 * here + 0.25 * path[i + 1];
      before = here;
    }
  }
  return evenly(path, count);
}

}  // namespace fascia
