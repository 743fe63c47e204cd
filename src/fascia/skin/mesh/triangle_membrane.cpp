#include <fascia/skin/mesh/triangle_membrane.h>

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include <fascia/math/points.h>
#include <fascia/skin/point/plateau.h>

namespace fascia {
namespace {

using Triangle = TriangleMembrane::Triangle;

// Triangles flatter than this share of their longest edge have no direction to hold on to.
constexpr double kFlattest = 1e-5;
constexpr double kShortest_m2 = 1e-12;  // squared longest edge of a triangle that counts
// A sliver's stiffness against its own height grows with length over height. It would ask for short
// steps of the whole skin, so it grows no further than at this height over length.
constexpr double kSliver = 0.1;

// x_u = Σ u[i] r_i, x_v = Σ v[i] r_i over a triangle's corners.
struct Gradients {
  double u[3], v[3];
  explicit Gradients(const Triangle& t)
      : u{-double{t.u[0]} - t.u[1], t.u[0], t.u[1]}, v{-double{t.v[0]} - t.v[1], t.v[0], t.v[1]} {}
};

struct Stretch {
  Vec3 u, v;  // x_u, x_v
  Stretch(const Triangle& t, const VectorArray& r) {
    const Vec3 origin = pointAt(r, t.corners[0]);
    const Vec3 e1 = pointAt(r, t.corners[1]) - origin, e2 = pointAt(r, t.corners[2]) - origin;
    u = double{t.u[0]} * e1 + double{t.u[1]} * e2;
    v = double{t.v[0]} * e1 + double{t.v[1]} * e2;
  }
  double strain_u() const { return 0.5 * (u.squaredNorm() - 1); }
  double strain_v() const { return 0.5 * (v.squaredNorm() - 1); }
  double shear() const { return u.dot(v); }
};

// Row sums (Gershgorin) of −∂f/∂r per corner of a triangle with both directions stretched to the
// plateau and at right angles, where shear is elastic too: −∂f/∂r ≼ diag(sums), along x_u, along
// x_v and normal to both.
std::array<Vec3, 3> rowSums(const Triangle& t, double cap) {
  const Gradients g(t);
  const double square = 1 + cap;  // |x_u|² = |x_v|²
  std::array<Vec3, 3> sums;
  for (int i = 0; i < 3; ++i) {
    Vec3& row = sums[static_cast<std::size_t>(i)] = Vec3::Zero();
    for (int j = 0; j < 3; ++j) {
      const double uu = t.stretch_u * g.u[i] * g.u[j], vv = t.stretch_v * g.v[i] * g.v[j];
      const double across = 0.5 * cap * (uu + vv), shear = square * t.shear;
      row.x() += std::abs(across + square * uu + shear * g.v[i] * g.v[j]) +
                 std::abs(shear * g.v[i] * g.u[j]);
      row.y() += std::abs(across + square * vv + shear * g.u[i] * g.u[j]) +
                 std::abs(shear * g.u[i] * g.v[j]);
      row.z() += std::abs(across);
    }
  }
  return sums;
}

// A rest triangle's edges from corner 0, and how much of it there is.
struct RestShape {
  Vec3 e1, e2, cross;
  double lengths[3], longest;  // squared, of the edges 01, 02 and 12
  double flatness;             // height over longest edge

  RestShape(const TriangleMembrane::Corners& c, const VectorArray& rest) {
    const Vec3 origin = pointAt(rest, c[0]);
    e1 = pointAt(rest, c[1]) - origin, e2 = pointAt(rest, c[2]) - origin;
    cross = e1.cross(e2);
    lengths[0] = e1.squaredNorm(), lengths[1] = e2.squaredNorm();
    lengths[2] = (e2 - e1).squaredNorm();
    longest = std::max({lengths[0], lengths[1], lengths[2]});
    flatness = cross.norm() / longest;
  }
  double area() const { return 0.5 * cross.norm(); }
  bool isDegenerate() const { return !(flatness > kFlattest) || longest < kShortest_m2; }
};

// The material's directions u and v in the triangle's plane, and its normal.
Mat3 materialAxes(const RestShape& shape, const Vec3& wanted) {
  const Vec3 normal = shape.cross.normalized();
  const Vec3 inPlane = wanted - wanted.dot(normal) * normal;
  const bool usable = inPlane.norm() > 1e-3 * wanted.norm();
  Mat3 axes;
  axes.col(0) = usable ? inPlane.normalized() : shape.e1.normalized();
  axes.col(1) = normal.cross(axes.col(0));
  axes.col(2) = normal;
  return axes;
}

Triangle makeTriangle(const TriangleMembrane::Corners& c, const RestShape& shape, const Mat3& axes,
                      const TriangleMaterial& m) {
  const auto mean = [&](const FloatArray& a) { return (a[c[0]] + a[c[1]] + a[c[2]]) / 3.0; };
  const Vec3 u = axes.col(0), v = axes.col(1);
  // Inverse of the relaxed edges' matrix (e1 e2)/prestretch in the axes u and v.
  const double inverse = mean(m.prestretch) / shape.cross.norm();
  Triangle t{};
  t.corners = c;
  t.u[0] = static_cast<float>(inverse * shape.e2.dot(v));
  t.u[1] = static_cast<float>(-inverse * shape.e1.dot(v));
  t.v[0] = static_cast<float>(-inverse * shape.e2.dot(u));
  t.v[1] = static_cast<float>(inverse * shape.e1.dot(u));
  const double weight = shape.area() * std::min(1.0, shape.flatness / kSliver);
  t.stretch_u = static_cast<float>(weight * mean(m.stretch_u));
  t.stretch_v = static_cast<float>(weight * mean(m.stretch_v));
  t.shear = static_cast<float>(weight * mean(m.shear));
  for (int k = 0; k < 3; ++k) t.inverseRest[k] = static_cast<float>(1 / shape.lengths[k]);
  return t;
}

}  // namespace

TriangleMembrane::TriangleMembrane(std::span<const Corners> triangles, const VectorArray& rest,
                                   const TriangleMaterial& m)
    : bound_(rest.size(), 0.f), areas_(rest.size(), 0.f), cap_(m.max_stretch * m.max_stretch - 1) {
  triangles_.reserve(triangles.size());
  std::vector<Corners> kept;
  std::vector<Mat3> stiffness(rest.size(), Mat3::Zero());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Corners& corners = triangles[i];
    const RestShape shape(corners, rest);
    if (shape.isDegenerate()) continue;
    const Mat3 axes = materialAxes(shape, m.u.empty() ? shape.e1 : Vec3(m.u[i].cast<double>()));
    kept.push_back(corners);
    triangles_.push_back(makeTriangle(corners, shape, axes, m));
    const std::array<Vec3, 3> sums = rowSums(triangles_.back(), cap_);
    for (std::size_t k = 0; k < 3; ++k) {
      areas_[corners[k]] += static_cast<float>(shape.area() / 3);
      stiffness[corners[k]] += axes * sums[k].asDiagonal() * axes.transpose();
    }
  }
  hinges_ = makeHinges(kept, rest, m.bending);
  for (const FoldEdge& hinge : hinges_) {
    const std::array<Mat3, 4> bending = hingeStiffness(hinge, rest);
    for (std::size_t k = 0; k < 4; ++k) stiffness[hinge.corners[k]] += bending[k];
  }
  std::transform(stiffness.begin(), stiffness.end(), bound_.begin(), [](const Mat3& at) {
    return static_cast<float>(
        Eigen::SelfAdjointEigenSolver<Mat3>(at, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff());
  });
}

double TriangleMembrane::energy(const VectorArray& r) const {
  double total = 0;
  for (const Triangle& t : triangles_) {
    const Stretch s(t, r);
    total += t.stretch_u * plateauEnergy(s.strain_u(), 0.5 * cap_) +
             t.stretch_v * plateauEnergy(s.strain_v(), 0.5 * cap_) +
             t.shear * plateauEnergy(s.shear(), cap_);
  }
  for (const FoldEdge& hinge : hinges_) total += hingeEnergy(hinge, r);
  return total;
}

double TriangleMembrane::maxStretch(const VectorArray& r) const {
  float largest = 0;
  for (const Triangle& t : triangles_) {
    const auto ratio = [&](int from, int to, float inverseRest) {
      const std::size_t a = t.corners[static_cast<std::size_t>(from)];
      const std::size_t b = t.corners[static_cast<std::size_t>(to)];
      const float x = r.x[b] - r.x[a], y = r.y[b] - r.y[a], z = r.z[b] - r.z[a];
      return (x * x + y * y + z * z) * inverseRest;
    };
    largest = std::max({largest, ratio(0, 1, t.inverseRest[0]), ratio(0, 2, t.inverseRest[1]),
                        ratio(1, 2, t.inverseRest[2])});
  }
  return std::sqrt(double{largest});
}

std::vector<StretchLimit::Edge> TriangleMembrane::edges(float stretch) const {
  std::vector<StretchLimit::Edge> edges;
  for (const Triangle& t : triangles_) {
    const auto add = [&](std::uint32_t a, std::uint32_t b, float inverseRest) {
      edges.push_back({std::min(a, b), std::max(a, b), stretch / std::sqrt(inverseRest)});
    };
    add(t.corners[0], t.corners[1], t.inverseRest[0]);
    add(t.corners[0], t.corners[2], t.inverseRest[1]);
    add(t.corners[1], t.corners[2], t.inverseRest[2]);
  }
  const auto ends = [](const StretchLimit::Edge& e) { return std::pair(e.a, e.b); };
  std::ranges::stable_sort(edges, {}, ends);
  const auto same = [&](const auto& a, const auto& b) { return ends(a) == ends(b); };
  edges.erase(std::unique(edges.begin(), edges.end(), same), edges.end());
  return edges;
}

void TriangleMembrane::addForceJacobian(const VectorArray& r, bool definite,
                                        std::vector<Eigen::Triplet<double>>& entries) const {
  for (const Triangle& t : triangles_) {
    const Gradients g(t);
    const Stretch s(t, r);
    // Hessian of w φ(E_uu) with E_uu = ½(|x_u|² − 1): u_i u_j w (φ'' x_u x_uᵀ + φ' I).
    const auto along = [&](double weight, double strain, const Vec3& x) {
      double stress = plateauStress(strain, 0.5 * cap_);
      if (definite) stress = std::max(stress, 0.0);
      Mat3 h = stress * Mat3::Identity();
      if (std::abs(strain) < 0.5 * cap_) h += x * x.transpose();
      return Mat3(weight * h);
    };
    const Mat3 hu = along(t.stretch_u, s.strain_u(), s.u);
    const Mat3 hv = along(t.stretch_v, s.strain_v(), s.v);
    const double stress = definite ? 0 : t.shear * plateauStress(s.shear(), cap_);
    const double stiffness = std::abs(s.shear()) < cap_ ? t.shear : 0;
    for (int i = 0; i < 3; ++i) {
      const Vec3 gi = g.u[i] * s.v + g.v[i] * s.u;
      for (int j = 0; j < 3; ++j) {
        const Vec3 gj = g.u[j] * s.v + g.v[j] * s.u;
        const Mat3 h = g.u[i] * g.u[j] * hu + g.v[i] * g.v[j] * hv +
                       stiffness * gi * gj.transpose() +
                       stress * (g.u[i] * g.v[j] + g.v[i] * g.u[j]) * Mat3::Identity();
        const int row = 3 * static_cast<int>(t.corners[static_cast<std::size_t>(i)]);
        const int column = 3 * static_cast<int>(t.corners[static_cast<std::size_t>(j)]);
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) entries.emplace_back(row + a, column + b, -h(a, b));
      }
    }
  }
  for (const FoldEdge& hinge : hinges_) addHingeJacobian(hinge, r, entries);
}

}  // namespace fascia
