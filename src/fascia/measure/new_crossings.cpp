#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/geometry/closest_point.h>
#include <fascia/measure/deformation.h>

namespace fascia {
namespace {

using Corners = std::array<Vec3, 3>;
using Triangle = std::array<std::uint32_t, 3>;

Corners cornersOf(const Triangle& t, PointList points) {
  FASCIA_ASSERT(areBelow(t, points.size()), "corners are points");
  return {points[t[0]].cast<double>(), points[t[1]].cast<double>(), points[t[2]].cast<double>()};
}

// Distance of two edges (Ericson 2005, "Real-Time Collision Detection", 5.1.9); parallel ones may
// come out too far, the corners' distances to the triangles are right then.
double edgeDistance(const Vec3& p1, const Vec3& q1, const Vec3& p2, const Vec3& q2) {
  const Vec3 d1 = q1 - p1, d2 = q2 - p2, r = p1 - p2;
  const double a = d1.squaredNorm(), e = d2.squaredNorm(), b = d1.dot(d2);
  const double c = d1.dot(r), f = d2.dot(r), denominator = a * e - b * b;
  if (!(a > 0) || !(e > 0) || !(denominator > 0)) return HUGE_VAL;
  double s = std::clamp((b * f - c * e) / denominator, 0.0, 1.0);
  const double t = std::clamp((b * s + f) / e, 0.0, 1.0);
  s = std::clamp((b * t - c) / a, 0.0, 1.0);
  return (p1 + s * d1 - p2 - t * d2).norm();
}

double distance(const Corners& a, const Corners& b) {
  double least = HUGE_VAL;
  for (std::size_t i = 0; i < 3; ++i) {
    least =
        std::min(least, (closestPointOnTriangle(a[i], b[0], b[1], b[2]).position - a[i]).norm());
    least =
        std::min(least, (closestPointOnTriangle(b[i], a[0], a[1], a[2]).position - b[i]).norm());
    for (std::size_t j = 0; j < 3; ++j)
      least = std::min(least, edgeDistance(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]));
  }
  return least;
}

struct Interval {
  double low = HUGE_VAL, high = -HUGE_VAL;
};

// The heights of a triangle's corners over a plane, and where its edges pass it, along a line.
struct Passage {
  double below = 0, above = 0;
  Interval along;
};
Passage passage(const Corners& t, const Corners& plane, const Vec3& normal, const Vec3& line) {
  Passage result;
  std::array<double, 3> height{};
  for (std::size_t k = 0; k < 3; ++k) {
    height[k] = (t[k] - plane[0]).dot(normal);
    result.below = std::max(result.below, -height[k]);
    result.above = std::max(result.above, height[k]);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    if ((height[k] > 0) == (height[next] > 0)) continue;
    const double share = height[k] / (height[k] - height[next]);
    const double at = (t[k] + share * (t[next] - t[k]) - plane[0]).dot(line);
    result.along.low = std::min(result.along.low, at);
    result.along.high = std::max(result.along.high, at);
  }
  return result;
}

// A translation that parts two crossing triangles: out of either one's plane, or along the line in
// which they cross by as much as they share of it.
double parting(const Corners& a, const Corners& b) {
  const Vec3 ofA = (a[1] - a[0]).cross(a[2] - a[0]), ofB = (b[1] - b[0]).cross(b[2] - b[0]);
  if (!(ofA.norm() > 0) || !(ofB.norm() > 0)) return 0;
  const Vec3 normalA = ofA.normalized(), normalB = ofB.normalized();
  Vec3 line = normalA.cross(normalB);
  const double sine = line.norm();
  if (sine > 0) line /= sine;
  const Passage first = passage(a, b, normalB, line), second = passage(b, a, normalA, line);
  const double out = std::min({first.below, first.above, second.below, second.above});
  if (!(sine > 0)) return out;
  // The one's interval is measured from the other's corner.
  const double shift = (b[0] - a[0]).dot(line);
  const double shared = std::min(first.along.high + shift, second.along.high) -
                        std::max(first.along.low + shift, second.along.low);
  return std::min(out, std::max(0.0, shared));
}

class Touching {
 public:
  Touching(TriangleList triangles, PointList rest, PointList points, double tolerance_m)
      : triangles_(triangles), rest_(rest), points_(points), tolerance_m_(tolerance_m) {}

  bool operator()(const CrossingPair& pair) const {
    const Triangle& a = triangles_[pair.first];
    const Triangle& b = triangles_[pair.second];
    for (const std::uint32_t p : a)
      for (const std::uint32_t q : b)
        if (together(rest_, p, q) && together(points_, p, q)) return true;
    return distance(cornersOf(a, rest_), cornersOf(b, rest_)) <= tolerance_m_ &&
           parting(cornersOf(a, points_), cornersOf(b, points_)) <= tolerance_m_;
  }

 private:
  bool together(PointList points, std::uint32_t p, std::uint32_t q) const {
    return static_cast<double>((points[p] - points[q]).norm()) <= tolerance_m_;
  }

  TriangleList triangles_;
  PointList rest_, points_;
  double tolerance_m_;
};

}  // namespace

std::vector<CrossingPair> newCrossings(TriangleList triangles, PointList rest,
                                       std::span<const CrossingPair> atRest, PointList points,
                                       double tolerance_m) {
  const Touching touching(triangles, rest, points, tolerance_m);
  std::vector<CrossingPair> pairs = findCrossings(triangles, points);
  std::erase_if(pairs, [&](const CrossingPair& pair) {
    return std::binary_search(atRest.begin(), atRest.end(), pair) || touching(pair);
  });
  return pairs;
}

}  // namespace fascia
