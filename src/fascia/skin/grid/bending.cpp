#include <fascia/skin/grid/bending.h>

#include <algorithm>
#include <cmath>

#include <fascia/math/points.h>
#include <fascia/math/types.h>
#include <fascia/skin/grid/elastic_grid.h>

namespace fascia {
namespace {

// Second differences over the 3x3 stencil, rows from below, columns from the left.
constexpr double kSecond[3][9] = {
    {0, 0, 0, 1, -2, 1, 0, 0, 0},
    {0, 1, 0, 0, -2, 0, 0, 1, 0},
    {0.25, 0, -0.25, 0, 0, 0, -0.25, 0, 0.25},
};
// B12 counts twice in the sum over a and b.
constexpr double kMultiplicity[3] = {1, 1, 2};
// The points that turn the normal: to the sides, above and below.
constexpr int kTurning[4] = {1, 3, 5, 7};
// Their share in a usual gradient, of a second difference's.
constexpr double kTurningShare = 0.5;
// So much larger than the usual one a gradient may be.
constexpr double kGrown = 1.2;

}  // namespace

struct Bending::Curvature {
  double b[3];
  Vec3 gradient[3][9];
};

Bending::Bending(const GridLayout& g, const VectorArray& rest, const FloatArray& stiffness)
    : layout_(g) {
  if (std::none_of(stiffness.begin(), stiffness.end(), [](float k) { return k > 0; })) return;
  const FloatArray areas = pointAreas(g, rest);
  for (int j = 0; j < g.rows; ++j) {
    firstOfRow_.push_back(nodes_.size());
    if (j == 0 || j + 1 == g.rows) continue;
    for (int i = 0; i < g.columns; ++i) {
      const bool interior = g.closed || (i > 0 && i + 1 < g.columns);
      const std::size_t k = g.at(i, j);
      if (!interior || stiffness[k] <= 0) continue;
      Node node{};
      for (int dj = -1, q = 0; dj <= 1; ++dj)
        for (int di = -1; di <= 1; ++di, ++q) node.stencil[q] = g.at(g.wrapped(i + di), j + dj);
      const auto spacing = [&](int low, int high) {
        return 0.5 * (pointAt(rest, node.stencil[high]) - pointAt(rest, node.stencil[4])).norm() +
               0.5 * (pointAt(rest, node.stencil[4]) - pointAt(rest, node.stencil[low])).norm();
      };
      const double h1 = spacing(3, 5), h2 = spacing(1, 7);
      if (h1 < 1e-6 || h2 < 1e-6) continue;
      node.weight = 0.5f * stiffness[k] * areas[k];
      node.inverse[0] = static_cast<float>(1 / (h1 * h1));
      node.inverse[1] = static_cast<float>(1 / (h2 * h2));
      node.inverse[2] = static_cast<float>(1 / (h1 * h2));
      const Curvature at = curvature(node, rest);
      for (int a = 0; a < 3; ++a) {
        node.rest[a] = static_cast<float>(at.b[a]);
        for (int q = 0; q < 9; ++q)
          node.usual[a][q] = static_cast<float>(std::max(
              at.gradient[a][q].norm(), std::abs(kSecond[a][q]) * double{node.inverse[a]}));
        for (const int q : kTurning)
          node.usual[a][q] =
              std::max(node.usual[a][q], static_cast<float>(kTurningShare) * node.inverse[a]);
      }
      nodes_.push_back(node);
    }
  }
  firstOfRow_.push_back(nodes_.size());
}

Bending::Curvature Bending::curvature(const Node& node, const VectorArray& r) const {
  Vec3 p[9];
  for (int q = 0; q < 9; ++q) p[q] = pointAt(r, node.stencil[q]);
  const Vec3 t1 = 0.5 * (p[5] - p[3]), t2 = 0.5 * (p[7] - p[1]);
  const Vec3 cross = t1.cross(t2);
  // A cell folded to less than a quarter of its area keeps that area as divisor: its normal then
  // shortens instead of spinning, and the force stays bounded.
  const double floor = 0.25 / node.inverse[2], length = cross.norm();
  const double area = std::max(length, floor);
  const Vec3 n = cross / area;
  Curvature out;
  for (int a = 0; a < 3; ++a) {
    Vec3 second = Vec3::Zero();
    for (int q = 0; q < 9; ++q) second += kSecond[a][q] * p[q];
    second *= node.inverse[a];
    out.b[a] = n.dot(second);
    for (int q = 0; q < 9; ++q) out.gradient[a][q] = kSecond[a][q] * node.inverse[a] * n;
    // d(n·c) through n: w·d(t1 × t2) with w the tangential part of c over |t1 × t2|.
    const Vec3 w = (length > floor ? Vec3(second - out.b[a] * n) : second) / area;
    const Vec3 by1 = 0.5 * t2.cross(w), by2 = 0.5 * w.cross(t1);
    out.gradient[a][5] += by1;
    out.gradient[a][3] -= by1;
    out.gradient[a][7] += by2;
    out.gradient[a][1] -= by2;
  }
  return out;
}

double Bending::fade(const Node& node, const Curvature& at, int a) {
  double left = 1;
  for (int q = 0; q < 9; ++q) {
    const double most = kGrown * node.usual[a][q], squared = at.gradient[a][q].squaredNorm();
    if (squared > most * most) left = std::min(left, most * most / squared);
  }
  return left;
}

double Bending::energy(const VectorArray& r) const {
  double total = 0;
  for (const Node& node : nodes_) {
    const Curvature at = curvature(node, r);
    for (int a = 0; a < 3; ++a) {
      const double t = at.b[a] - node.rest[a];
      total += kMultiplicity[a] * node.weight * t * t;
    }
  }
  return total;
}

void Bending::addForces(const VectorArray& r, VectorArray& force) const {
  for (const Node& node : nodes_) {
    const Curvature at = curvature(node, r);
    for (int a = 0; a < 3; ++a) {
      const double s =
          -2 * kMultiplicity[a] * node.weight * (at.b[a] - node.rest[a]) * fade(node, at, a);
      for (int q = 0; q < 9; ++q) {
        const Vec3 f = s * at.gradient[a][q];
        force.x[node.stencil[q]] += static_cast<float>(f.x());
        force.y[node.stencil[q]] += static_cast<float>(f.y());
        force.z[node.stencil[q]] += static_cast<float>(f.z());
      }
    }
  }
}

int Bending::pointOf(std::size_t storage) const {
  const std::size_t j = storage / layout_.stride();
  return static_cast<int>(j * static_cast<std::size_t>(layout_.columns) + storage -
                          layout_.row(static_cast<int>(j)));
}

void Bending::addStiffness(std::vector<Eigen::Triplet<double>>& entries) const {
  for (const Node& node : nodes_) {
    for (int a = 0; a < 3; ++a) {
      const double scale = 2 * kMultiplicity[a] * node.weight * node.inverse[a] * node.inverse[a];
      for (int p = 0; p < 9; ++p)
        for (int q = 0; q < 9; ++q)
          if (const double s = kSecond[a][p] * kSecond[a][q]; s != 0)
            entries.emplace_back(pointOf(node.stencil[p]), pointOf(node.stencil[q]), scale * s);
    }
  }
}

void Bending::addForceJacobian(const VectorArray& r,
                               std::vector<Eigen::Triplet<double>>& entries) const {
  for (const Node& node : nodes_) {
    const Curvature at = curvature(node, r);
    double scale[3];
    for (int a = 0; a < 3; ++a) scale[a] = 2 * kMultiplicity[a] * node.weight * fade(node, at, a);
    for (int p = 0; p < 9; ++p) {
      for (int q = 0; q < 9; ++q) {
        Mat3 h = Mat3::Zero();
        for (int a = 0; a < 3; ++a)
          h += scale[a] * at.gradient[a][p] * at.gradient[a][q].transpose();
        for (int m = 0; m < 3; ++m)
          for (int n = 0; n < 3; ++n)
            entries.emplace_back(3 * pointOf(node.stencil[p]) + m, 3 * pointOf(node.stencil[q]) + n,
                                 -h(m, n));
      }
    }
  }
}

void Bending::addStiffnessBound(FloatArray& bound) const {
  for (const Node& node : nodes_) {
    for (int p = 0; p < 9; ++p) {
      double sum = 0;
      for (int a = 0; a < 3; ++a) {
        double row = 0;
        for (int q = 0; q < 9; ++q) row += node.usual[a][q];
        sum += 2 * kMultiplicity[a] * node.weight * kGrown * kGrown * node.usual[a][p] * row;
      }
      bound[node.stencil[p]] += static_cast<float>(sum);
    }
  }
}

}  // namespace fascia
