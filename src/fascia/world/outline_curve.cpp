#include <fascia/world/outline_curve.h>

#include <cmath>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

constexpr int kPiecesPerSpan = 8;

// The spline between b and c at s in [0, 1], by Barry & Goldman's pyramid of straight blends.
Vec2 splinePoint(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d, double s) {
  FASCIA_ASSERT(s >= 0 && s <= 1, "between two points");
  const auto knot = [](const Vec2& p, const Vec2& q) { return std::sqrt((q - p).norm()); };
  const double ta = -knot(a, b), tc = knot(b, c), td = tc + knot(c, d), t = s * tc;
  const auto blend = [t](const Vec2& p, double tp, const Vec2& q, double tq) -> Vec2 {
    return tq == tp ? q : Vec2(((tq - t) * p + (t - tp) * q) / (tq - tp));
  };
  // A neighbour that is the same point gives no direction: the curve leaves it straight.
  const Vec2 bc = blend(b, 0, c, tc);
  const Vec2 ab = ta < 0 ? blend(a, ta, b, 0) : bc;
  const Vec2 cd = td > tc ? blend(c, tc, d, td) : bc;
  const Vec2 left = ta < 0 ? blend(ab, ta, bc, tc) : bc;
  const Vec2 right = td > tc ? blend(bc, 0, cd, td) : bc;
  return blend(left, 0, right, tc);
}

}  // namespace

std::vector<Vec2> closedCurve(std::span<const Vec2> points_m) {
  const std::size_t n = points_m.size();
  if (n < 3) return {points_m.begin(), points_m.end()};
  std::vector<Vec2> out;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 &a = points_m[(i + n - 1) % n], &b = points_m[i], &c = points_m[(i + 1) % n],
               &d = points_m[(i + 2) % n];
    if (b == c) continue;  // a corner: the spans beside it end there
    for (int k = 0; k < kPiecesPerSpan; ++k)
      out.push_back(splinePoint(a, b, c, d, static_cast<double>(k) / kPiecesPerSpan));
  }
  return out;
}

}  // namespace fascia
