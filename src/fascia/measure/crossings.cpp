#include <algorithm>
#include <cmath>

#include <fascia/geometry/box_tree.h>
#include <fascia/measure/deformation.h>

namespace fascia {
namespace {

using Corners = std::array<Vec3, 3>;

// On which side of the plane through a, b, c a point d lies: 1 or -1, and 0 where rounding leaves
// it open (Shewchuk 1997, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
// Predicates", first filter of orient3d: (7 + 56 ε) ε times the permanent, ε = 2⁻⁵³).
int side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  constexpr double kRounding = 7.7715611723761027e-16;
  const Vec3 u = a - d, v = b - d, w = c - d;
  const double vw1 = v.x() * w.y(), vw2 = v.y() * w.x();
  const double wu1 = w.x() * u.y(), wu2 = w.y() * u.x();
  const double uv1 = u.x() * v.y(), uv2 = u.y() * v.x();
  const double determinant = u.z() * (vw1 - vw2) + v.z() * (wu1 - wu2) + w.z() * (uv1 - uv2);
  const double permanent = std::abs(u.z()) * (std::abs(vw1) + std::abs(vw2)) +
                           std::abs(v.z()) * (std::abs(wu1) + std::abs(wu2)) +
                           std::abs(w.z()) * (std::abs(uv1) + std::abs(uv2));
  const double bound = kRounding * permanent;
  return determinant > bound ? 1 : determinant < -bound ? -1 : 0;
}

// The line through p and q passes strictly inside of t.
bool passesInside(const Vec3& p, const Vec3& q, const Corners& t) {
  const int first = side(p, q, t[0], t[1]);
  return first != 0 && side(p, q, t[1], t[2]) == first && side(p, q, t[2], t[0]) == first;
}

std::array<int, 3> sides(const Corners& plane, const Corners& t) {
  return {side(plane[0], plane[1], plane[2], t[0]), side(plane[0], plane[1], plane[2], t[1]),
          side(plane[0], plane[1], plane[2], t[2])};
}

bool onBothSides(const std::array<int, 3>& s) {
  return std::min({s[0], s[1], s[2]}) < 0 && std::max({s[0], s[1], s[2]}) > 0;
}

bool edgePierces(const Corners& t, const std::array<int, 3>& s, const Corners& plane) {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    if (s[k] * s[next] < 0 && passesInside(t[k], t[next], plane)) return true;
  }
  return false;
}

// Where two triangles cross, the ends of their common segment lie on edges: of one or of both
// (Möller 1997, "A Fast Triangle-Triangle Intersection Test").
bool cross(const Corners& a, const Corners& b) {
  const std::array<int, 3> ofB = sides(a, b);
  if (!onBothSides(ofB)) return false;
  const std::array<int, 3> ofA = sides(b, a);
  if (!onBothSides(ofA)) return false;
  return edgePierces(b, ofB, a) || edgePierces(a, ofA, b);
}

bool sharePoint(const std::array<std::uint32_t, 3>& a, const std::array<std::uint32_t, 3>& b) {
  for (const std::uint32_t p : a)
    if (p == b[0] || p == b[1] || p == b[2]) return true;
  return false;
}

}  // namespace

std::vector<CrossingPair> findCrossings(TriangleList triangles, PointList points) {
  std::vector<Corners> corners(triangles.size());
  std::vector<Box> boxes(triangles.size());  // empty, and so never met, where a point is not finite
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) corners[t][k] = points[triangles[t][k]].cast<double>();
    if (!corners[t][0].allFinite() || !corners[t][1].allFinite() || !corners[t][2].allFinite())
      continue;
    for (const Vec3& corner : corners[t]) boxes[t].add(corner);
  }
  BoxTree tree;
  tree.build(boxes);
  std::vector<CrossingPair> pairs;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    tree.visit([&](const Box& box) { return meets(box, boxes[t]); },
               [&](std::uint32_t other) {
                 if (other > t && !sharePoint(triangles[t], triangles[other]) &&
                     cross(corners[t], corners[other]))
                   pairs.push_back({t, other});
               });
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::size_t crossingTrianglePairs(TriangleList triangles, PointList points) {
  return findCrossings(triangles, points).size();
}

std::size_t newCrossings(std::span<const CrossingPair> before, std::span<const CrossingPair> now) {
  std::size_t known = 0;
  for (const CrossingPair& pair : now)
    known += std::binary_search(before.begin(), before.end(), pair) ? 1 : 0;
  return now.size() - known;
}

}  // namespace fascia
