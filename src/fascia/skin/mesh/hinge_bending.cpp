#include <fascia/skin/mesh/hinge_bending.h>

#include <algorithm>
#include <cmath>

#include <fascia/math/points.h>
#include <fascia/math/types.h>

namespace fascia {
namespace {

using Corners = std::array<std::uint32_t, 3>;

struct Fold {
  Vec3 edge, toFirst, toSecond;  // p1 − p0, p2 − p0, p3 − p0
  Vec3 normal1, normal2;         // twice the areas long

  Fold(const FoldEdge& h, const VectorArray& r) {
    const Vec3 p0 = pointAt(r, h.corners[0]);
    edge = pointAt(r, h.corners[1]) - p0;
    toFirst = pointAt(r, h.corners[2]) - p0;
    toSecond = pointAt(r, h.corners[3]) - p0;
    normal1 = edge.cross(toFirst);
    normal2 = toSecond.cross(edge);
  }
  // |n1||n2| times cosine and sine of θ, positive where the sheet bends away from its normals.
  double cosine() const { return normal1.dot(normal2); }
  double sine() const { return -edge.norm() * normal1.dot(toSecond); }
  double heightSquared1() const { return normal1.squaredNorm() / edge.squaredNorm(); }
  double heightSquared2() const { return normal2.squaredNorm() / edge.squaredNorm(); }
  double angleFrom(const FoldEdge& h) const {
    return std::atan2(sine() * h.restCosine - cosine() * h.restSine,
                      cosine() * h.restCosine + sine() * h.restSine);
  }
  // ∂θ/∂p per corner: apexes turn about the edge, its ends follow by the lever rule.
  std::array<Vec3, 4> gradient() const {
    const double length = edge.norm();
    const Vec3 g1 = -length / normal1.squaredNorm() * normal1;
    const Vec3 g2 = -length / normal2.squaredNorm() * normal2;
    const double a1 = toFirst.dot(edge) / edge.squaredNorm();
    const double a2 = toSecond.dot(edge) / edge.squaredNorm();
    return {-(1 - a1) * g1 - (1 - a2) * g2, -a1 * g1 - a2 * g2, g1, g2};
  }
};

// A side of a triangle, its ends in ascending order.
struct Side {
  std::uint32_t low, high, opposite;
  bool ascending;  // the triangle runs from low to high
  bool sameEdge(const Side& other) const { return low == other.low && high == other.high; }
};

std::vector<Side> sortedSides(std::span<const Corners> triangles) {
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (const Corners& c : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = c[k], b = c[(k + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), c[(k + 2) % 3], a < b});
    }
  std::stable_sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return a.low != b.low ? a.low < b.low : a.high < b.high;
  });
  return sides;
}

FoldEdge makeHinge(const Side& a, const Side& b, const VectorArray& rest,
                   const FloatArray& bending) {
  FoldEdge h{};
  h.corners = {a.ascending ? a.low : a.high, a.ascending ? a.high : a.low, a.opposite, b.opposite};
  const Fold fold(h, rest);
  const double areas = 0.5 * (fold.normal1.norm() + fold.normal2.norm());
  const double angle = std::atan2(fold.sine(), fold.cosine());
  const double mean = 0.5 * (bending[h.corners[0]] + bending[h.corners[1]]);
  constexpr double kFloor = FoldEdge::kSqueezed * FoldEdge::kSqueezed;
  h.stiffness = static_cast<float>(mean * fold.edge.squaredNorm() / areas);
  h.restCosine = static_cast<float>(std::cos(angle));
  h.restSine = static_cast<float>(std::sin(angle));
  h.floor1 = static_cast<float>(kFloor * fold.heightSquared1());
  h.floor2 = static_cast<float>(kFloor * fold.heightSquared2());
  h.floorEdge = static_cast<float>(kFloor * fold.edge.squaredNorm());
  return h;
}

}  // namespace

std::vector<FoldEdge> makeHinges(std::span<const Corners> triangles, const VectorArray& rest,
                                 const FloatArray& bending) {
  std::vector<FoldEdge> hinges;
  if (std::none_of(bending.begin(), bending.end(), [](float k) { return k > 0; })) return hinges;
  const std::vector<Side> sides = sortedSides(triangles);
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t next = i + 1;
    while (next < sides.size() && sides[next].sameEdge(sides[i])) ++next;
    // Edges of three and more triangles have no angle.
    if (next == i + 2) {
      const FoldEdge h = makeHinge(sides[i], sides[i + 1], rest, bending);
      if (h.stiffness > 0) hinges.push_back(h);
    }
    i = next;
  }
  return hinges;
}

double hingeEnergy(const FoldEdge& h, const VectorArray& r) {
  const double angle = Fold(h, r).angleFrom(h);
  return 0.5 * h.stiffness * angle * angle;
}

void addHingeJacobian(const FoldEdge& h, const VectorArray& r,
                      std::vector<Eigen::Triplet<double>>& entries) {
  const Fold fold(h, r);
  if (!(fold.heightSquared1() > h.floor1 && fold.heightSquared2() > h.floor2 &&
        fold.edge.squaredNorm() > h.floorEdge))
    return;  // the force fades
  const std::array<Vec3, 4> gradient = fold.gradient();
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      const Mat3 block = -double{h.stiffness} * gradient[i] * gradient[j].transpose();
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
          entries.emplace_back(3 * static_cast<int>(h.corners[i]) + a,
                               3 * static_cast<int>(h.corners[j]) + b, block(a, b));
    }
  }
}

std::array<Mat3, 4> hingeStiffness(const FoldEdge& h, const VectorArray& rest) {
  const std::array<Vec3, 4> gradient = Fold(h, rest).gradient();
  double sum = 0;
  for (const Vec3& g : gradient) sum += g.norm();
  std::array<Mat3, 4> stiffness;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3& g = gradient[i];
    // Heights go down to kSqueezed of the rest shape's.
    const double scale = h.stiffness * sum / (FoldEdge::kSqueezed * FoldEdge::kSqueezed);
    stiffness[i] = scale / std::max(g.norm(), 1e-30) * g * g.transpose();
  }
  return stiffness;
}

}  // namespace fascia
