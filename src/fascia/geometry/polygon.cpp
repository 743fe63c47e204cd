#include <fascia/geometry/polygon.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include <fascia/base/error.h>

namespace fascia {
namespace {

// Twice the area of the triangle a b c, positive if it is counter-clockwise.
double cross(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 u = b - a, v = c - a;
  return u.x() * v.y() - u.y() * v.x();
}

// c, on the line through a and b, lies between them.
bool between(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (c - a).dot(c - b) <= 0;
}

// Whether the closed segments a b and c d have a point in common.
bool segmentsMeet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double ca = cross(c, d, a), cb = cross(c, d, b), ac = cross(a, b, c), ad = cross(a, b, d);
  if (((ca > 0 && cb < 0) || (ca < 0 && cb > 0)) && ((ac > 0 && ad < 0) || (ac < 0 && ad > 0)))
    return true;
  return (ac == 0 && between(a, b, c)) || (ad == 0 && between(a, b, d)) ||
         (ca == 0 && between(c, d, a)) || (cb == 0 && between(c, d, b));
}

[[noreturn]] void refuse(const std::string& found, const std::string& expected) {
  Issue issue{{}, "outline: found " + found + ", expected " + expected, {}};
  throw Error(issue);
}

// Edges i and j of a polygon may share the corner between them and nothing else.
bool edgesCross(std::span<const Vec2> p, std::size_t i, std::size_t j) {
  const std::size_t n = p.size();
  const Vec2 &a = p[i], &b = p[(i + 1) % n], &c = p[j], &d = p[(j + 1) % n];
  const auto foldsBack = [](const Vec2& from, const Vec2& corner, const Vec2& to) {
    return cross(from, corner, to) == 0 && (to - corner).dot(from - corner) > 0;
  };
  if (j == i + 1) return foldsBack(a, b, d);
  if (i == 0 && j == n - 1) return foldsBack(c, a, b);
  return segmentsMeet(a, b, c, d);
}

// A corner is an ear if its triangle is counter-clockwise and holds no other corner that is left,
// on its border neither: the cut would run through it.
bool isEar(std::span<const Vec2> p, std::span<const std::uint32_t> left, std::size_t i) {
  const std::size_t n = left.size(), before = (i + n - 1) % n, after = (i + 1) % n;
  const Vec2 &a = p[left[before]], &b = p[left[i]], &c = p[left[after]];
  if (!(cross(a, b, c) > 0)) return false;
  for (std::size_t k = 0; k < n; ++k) {
    if (k == before || k == i || k == after) continue;
    const Vec2& q = p[left[k]];
    if (cross(a, b, q) >= 0 && cross(b, c, q) >= 0 && cross(c, a, q) >= 0) return false;
  }
  return true;
}

// There always is an ear; rounding may hide those that are nearly flat. Then the corner goes that
// turns most.
std::size_t findEar(std::span<const Vec2> p, std::span<const std::uint32_t> left) {
  const std::size_t n = left.size();
  std::size_t best = 0;
  double bestTurn = -1e300;
  for (std::size_t i = 0; i < n; ++i) {
    if (isEar(p, left, i)) return i;
    const double turn = cross(p[left[(i + n - 1) % n]], p[left[i]], p[left[(i + 1) % n]]);
    if (turn > bestTurn) bestTurn = turn, best = i;
  }
  return best;
}

}  // namespace

double signedArea(std::span<const Vec2> polygon_m) {
  if (polygon_m.empty()) return 0;
  double twice = 0;
  for (std::size_t i = 0; i < polygon_m.size(); ++i)
    twice += cross(polygon_m[0], polygon_m[i], polygon_m[(i + 1) % polygon_m.size()]);
  return 0.5 * twice;
}

void checkSimplePolygon(std::span<const Vec2> polygon_m) {
  const std::size_t n = polygon_m.size();
  if (n < 3) refuse(std::to_string(n) + " corners", "at least 3");
  for (std::size_t i = 0; i < n; ++i) {
    if (!polygon_m[i].allFinite())
      refuse("corner " + std::to_string(i) + " that is no point", "finite numbers");
    if (polygon_m[i] == polygon_m[(i + 1) % n])
      refuse("edge " + std::to_string(i) + " without length", "corners apart from each other");
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      if (edgesCross(polygon_m, i, j))
        refuse("edges " + std::to_string(i) + " and " + std::to_string(j) + " that cross",
               "a simple polygon");
  if (signedArea(polygon_m) == 0) refuse("no area", "a polygon with an inside");
}

PlanarTriangles triangulatePolygon(std::span<const Vec2> polygon_m) {
  std::vector<std::uint32_t> left(polygon_m.size());
  std::iota(left.begin(), left.end(), 0u);
  if (signedArea(polygon_m) < 0) std::ranges::reverse(left);
  PlanarTriangles triangles;
  while (left.size() >= 3) {
    const std::size_t n = left.size(), ear = findEar(polygon_m, left);
    triangles.push_back({left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  return triangles;
}

}  // namespace fascia
