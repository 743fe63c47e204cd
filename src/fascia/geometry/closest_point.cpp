#include <fascia/geometry/closest_point.h>

#include <algorithm>

#include <fascia/base/assert.h>

namespace fascia {

namespace {

// Share of b in the point of the segment ab nearest to p.
double closestOnSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double square = ab.squaredNorm();
  return square > 0 ? std::clamp((p - a).dot(ab) / square, 0.0, 1.0) : 0.0;
}

}  // namespace

// Inside the triangle's prism the answer is the projection onto its plane, with the barycentric
// weights of Ericson 2005, §3.4; anywhere else it lies on one of the three edges.
TrianglePoint closestPointOnTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  FASCIA_ASSERT(p.allFinite() && normal.allFinite(), "corners and point are places");
  const double square = normal.squaredNorm();
  if (square > 0) {
    const double wb = (p - a).cross(c - a).dot(normal) / square;
    const double wc = (b - a).cross(p - a).dot(normal) / square;
    if (wb >= 0 && wc >= 0 && wb + wc <= 1) {
      const Vec3 weights(1 - wb - wc, wb, wc);
      return {weights[0] * a + weights[1] * b + weights[2] * c, weights};
    }
  }
  const Vec3 corners[3] = {a, b, c};
  TrianglePoint best{a, Vec3::UnitX()};
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const double s = closestOnSegment(p, corners[i], corners[j]);
    const Vec3 position = (1 - s) * corners[i] + s * corners[j];
    if (i > 0 && (position - p).squaredNorm() >= (best.position - p).squaredNorm()) continue;
    best = {position, Vec3::Zero()};
    best.weights[i] = 1 - s;
    best.weights[j] = s;
  }
  return best;
}

}  // namespace fascia
