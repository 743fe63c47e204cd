#include <fascia/skin/grid/elastic_grid.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/parallel.h>
#include <fascia/math/points.h>
#include <fascia/skin/point/plateau.h>

namespace fascia {
namespace {

double cellArea(const VectorArray& r, const GridLayout& g, int i, int j) {
  const Vec3 a = pointAt(r, g.at(i, j)), b = pointAt(r, g.at(i + 1, j));
  const Vec3 c = pointAt(r, g.at(i, j + 1)), d = pointAt(r, g.at(i + 1, j + 1));
  return 0.5 * (d - a).cross(c - b).norm();
}

// True for the cells and u-edges that exist: an open grid has none from its last column on.
bool spansColumn(const GridLayout& g, int i) {
  return g.closed || i + 1 < g.columns;
}

// The areas of all cells.
class CellAreas {
 public:
  CellAreas(const GridLayout& g, const VectorArray& r)
      : g_(g), areas_(g.rows > 1 ? static_cast<std::size_t>(g.columns) * (g.rows - 1u) : 0) {
    for (int j = 0; j + 1 < g.rows; ++j)
      for (int i = 0; i < g.columns; ++i)
        if (spansColumn(g, i)) areas_[number(i, j)] = cellArea(r, g, i, j);
  }
  // 0 outside of the grid; i may be -1 on a closed one.
  double orZero(int i, int j) const {
    if (j < 0 || j + 1 >= g_.rows) return 0;
    if (i < 0 && g_.closed) i += g_.columns;
    return i < 0 ? 0 : areas_[number(i, j)];
  }

 private:
  std::size_t number(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(g_.columns) +
           static_cast<std::size_t>(i);
  }

  const GridLayout& g_;
  std::vector<double> areas_;  // 0 where there is no cell
};

double fourthPower(double x) {
  return (x * x) * (x * x);
}

}  // namespace

void fillPads(const GridLayout& g, FloatArray& values) {
  for (int j = 0; j < g.rows; ++j) {
    float* row = values.data() + g.row(j);
    row[-1] = row[g.columns - 1];
    row[g.columns] = row[0];
  }
}

void fillPads(const GridLayout& layout, VectorArray& values) {
  for (FloatArray* a : {&values.x, &values.y, &values.z}) fillPads(layout, *a);
}

FloatArray pointAreas(const GridLayout& g, const VectorArray& rest) {
  FloatArray areas(g.storage(), 0.f);
  const CellAreas cells(g, rest);
  for (int j = 0; j < g.rows; ++j)
    for (int i = 0; i < g.columns; ++i)
      areas[g.at(i, j)] =
          static_cast<float>(0.25 * (cells.orZero(i, j) + cells.orZero(i - 1, j) +
                                     cells.orZero(i, j - 1) + cells.orZero(i - 1, j - 1)));
  return areas;
}

ElasticGrid::ElasticGrid(const GridLayout& layout, const VectorArray& rest, const GridMaterial& m)
    : layout_(layout) {
  const GridLayout& g = layout_;
  for (FloatArray* a :
       {&c_.w1, &c_.g1, &c_.w2, &c_.g2, &c_.w12, &c_.g12, &c_.lim12, &restLength1_, &restLength2_})
    a->assign(g.storage(), 0.f);
  c_.cap = m.max_stretch * m.max_stretch - 1;
  const CellAreas areas(g, rest);
  constexpr double kShortest_m = 1e-6;  // coinciding rest points get no stiffness
  parallelFor(static_cast<std::size_t>(g.rows), [&](std::size_t row) {
    const int j = static_cast<int>(row);
    for (int i = 0; i < g.columns; ++i) {
      const std::size_t k = g.at(i, j);
      const std::size_t right = g.at(g.wrapped(i + 1), j), up = g.at(i, j + 1);
      const bool hasColumn = spansColumn(g, i), hasRow = j + 1 < g.rows;
      const auto mean = [&](const FloatArray& a, std::size_t other) {
        return 0.5 * (a[k] + a[other]);
      };
      if (hasColumn) {
        const double length = (pointAt(rest, k + 1) - pointAt(rest, k)).norm();
        const double relaxed = length / mean(m.prestretch, right);
        const double area = 0.5 * (areas.orZero(i, j) + areas.orZero(i, j - 1));
        if (relaxed > kShortest_m) {
          restLength1_[k] = static_cast<float>(length);
          c_.g1[k] = static_cast<float>(relaxed * relaxed);
          c_.w1[k] =
              static_cast<float>(area * mean(m.stretch_u, right) / (2 * fourthPower(relaxed)));
        }
      }
      if (hasRow) {
        const double length = (pointAt(rest, up) - pointAt(rest, k)).norm();
        const double relaxed = length / mean(m.prestretch, up);
        const double area = 0.5 * (areas.orZero(i, j) + areas.orZero(i - 1, j));
        if (relaxed > kShortest_m) {
          restLength2_[k] = static_cast<float>(length);
          c_.g2[k] = static_cast<float>(relaxed * relaxed);
          c_.w2[k] = static_cast<float>(area * mean(m.stretch_v, up) / (2 * fourthPower(relaxed)));
        }
      }
      if (hasColumn && hasRow) {
        const std::size_t upRight = g.at(g.wrapped(i + 1), j + 1);
        const Vec3 a = pointAt(rest, k), b = pointAt(rest, k + 1);
        const Vec3 c = pointAt(rest, up), d = pointAt(rest, g.at(i + 1, j + 1));
        const double shrink =
            4 / (m.prestretch[k] + m.prestretch[right] + m.prestretch[up] + m.prestretch[upRight]);
        const Vec3 s1 = 0.5 * shrink * (b - a + d - c), s2 = 0.5 * shrink * (c - a + d - b);
        const double sides = s1.norm() * s2.norm();
        const double shear = 0.25 * (m.shear[k] + m.shear[right] + m.shear[up] + m.shear[upRight]);
        if (sides > kShortest_m * kShortest_m) {
          c_.g12[k] = static_cast<float>(s1.dot(s2));
          c_.w12[k] = static_cast<float>(areas.orZero(i, j) * shear / (sides * sides));
          c_.lim12[k] = static_cast<float>(c_.cap * sides);
        }
      }
    }
  });
  computeBound();
}

void ElasticGrid::computeBound() {
  const GridLayout& g = layout_;
  bound_.assign(g.storage(), 0.f);
  const double s2 = 1 + c_.cap;
  // One edge's force derivative is w[(r − G) I + 2 e eᵀ], r = |e|² ≤ s² G: `along` its direction
  // and `across` it. Edges along u and along v share a direction only as far as the cell is skewed.
  parallelFor(static_cast<std::size_t>(g.rows), [&](std::size_t row) {
    const int j = static_cast<int>(row);
    for (int i = 0; i < g.columns; ++i) {
      double along1 = 0, across1 = 0, along2 = 0, across2 = 0, shear = 0, skew = 0;
      const auto edge = [&](double w, double G, double& along, double& across) {
        along += 2 * w * G * (3 * s2 - 1);
        across += 2 * w * G * (s2 - 1);
      };
      const std::size_t k = g.at(i, j), left = g.at(g.wrapped(i - 1), j);
      edge(c_.w1[k], c_.g1[k], along1, across1);
      edge(c_.w1[left], c_.g1[left], along1, across1);
      edge(c_.w2[k], c_.g2[k], along2, across2);
      if (j > 0) edge(c_.w2[g.at(i, j - 1)], c_.g2[g.at(i, j - 1)], along2, across2);
      for (const int dj : {-1, 0}) {
        for (const int di : {-1, 0}) {
          if (j + dj < 0) continue;
          const std::size_t q = g.at(g.wrapped(i + di), j + dj);
          if (c_.w12[q] == 0) continue;
          const double sides = c_.lim12[q] / c_.cap;
          const double squares = 0.5 * (c_.g1[q] + c_.g2[q]);
          // |∂g/∂r| ≤ ½|s1 ± s2| at each corner; τ's own part is bounded by the plateau.
          shear += c_.w12[q] * (2 * s2 * squares + c_.lim12[q]);
          skew = std::max(skew, std::abs(c_.g12[q]) / sides);
        }
      }
      const double u = along1 + across2, v = along2 + across1;
      bound_[k] = static_cast<float>(std::max(u, v) + std::min(1.0, skew) * std::min(u, v) + shear);
    }
  });
}

double ElasticGrid::energy(const VectorArray& r) const {
  const GridLayout& g = layout_;
  double total = 0;
  for (int j = 0; j < g.rows; ++j) {
    for (int i = 0; i < g.columns; ++i) {
      const std::size_t k = g.at(i, j);
      const Vec3 a = pointAt(r, k);
      if (c_.w1[k] > 0) {
        const double t = (pointAt(r, k + 1) - a).squaredNorm() - c_.g1[k];
        total += 0.5 * c_.w1[k] * plateauEnergy(t, c_.cap * double{c_.g1[k]});
      }
      if (c_.w2[k] > 0) {
        const double t = (pointAt(r, g.at(i, j + 1)) - a).squaredNorm() - c_.g2[k];
        total += 0.5 * c_.w2[k] * plateauEnergy(t, c_.cap * double{c_.g2[k]});
      }
      if (c_.w12[k] > 0) {
        const Vec3 b = pointAt(r, k + 1), c = pointAt(r, g.at(i, j + 1));
        const Vec3 d = pointAt(r, g.at(i + 1, j + 1));
        const double t = 0.25 * (b - a + d - c).dot(c - a + d - b) - c_.g12[k];
        total += c_.w12[k] * plateauEnergy(t, c_.lim12[k]);
      }
    }
  }
  return total;
}

double ElasticGrid::maxStretch(const VectorArray& r) const {
  const GridLayout& g = layout_;
  float largest = 0;
  for (int j = 0; j < g.rows; ++j) {
    const std::size_t row = g.row(j), next = j + 1 < g.rows ? g.row(j + 1) : row;
    for (std::size_t k = row, n = next; k < row + static_cast<std::size_t>(g.columns); ++k, ++n) {
      const auto ratio = [&](std::size_t q, float rest) {
        const float x = r.x[q] - r.x[k], y = r.y[q] - r.y[k], z = r.z[q] - r.z[k];
        return (x * x + y * y + z * z) / (rest * rest);
      };
      if (restLength1_[k] > 0) largest = std::max(largest, ratio(k + 1, restLength1_[k]));
      if (restLength2_[k] > 0) largest = std::max(largest, ratio(n, restLength2_[k]));
    }
  }
  return std::sqrt(double{largest});
}

namespace {

// Scatters a 3x3 block −H at (p, q).
void addBlock(std::vector<Eigen::Triplet<double>>& entries, int p, int q, const Mat3& h) {
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) entries.emplace_back(3 * p + a, 3 * q + b, -h(a, b));
}

// An edge's energy Hessian is H at both ends and −H between them.
void addEdge(std::vector<Eigen::Triplet<double>>& entries, int p, int q, const Vec3& e, double w,
             double G, double cap, bool definite) {
  const double t = e.squaredNorm() - G;
  double stress = plateauStress(t, cap * G);
  if (definite) stress = std::max(stress, 0.0);
  Mat3 h = stress * Mat3::Identity();
  if (std::abs(t) < cap * G) h += 2 * e * e.transpose();
  h *= w;
  addBlock(entries, p, p, h);
  addBlock(entries, q, q, h);
  addBlock(entries, p, q, -h);
  addBlock(entries, q, p, -h);
}

}  // namespace

void ElasticGrid::addForceJacobian(const VectorArray& r, bool definite,
                                   std::vector<Eigen::Triplet<double>>& entries) const {
  const GridLayout& g = layout_;
  for (int j = 0; j < g.rows; ++j) {
    for (int i = 0; i < g.columns; ++i) {
      const std::size_t k = g.at(i, j);
      const int right = g.wrapped(i + 1);
      const int p[4] = {j * g.columns + i, j * g.columns + right, (j + 1) * g.columns + i,
                        (j + 1) * g.columns + right};
      const Vec3 a = pointAt(r, k);
      if (c_.w1[k] > 0)
        addEdge(entries, p[0], p[1], pointAt(r, k + 1) - a, c_.w1[k], c_.g1[k], c_.cap, definite);
      if (c_.w2[k] > 0)
        addEdge(entries, p[0], p[2], pointAt(r, g.at(i, j + 1)) - a, c_.w2[k], c_.g2[k], c_.cap,
                definite);
      if (c_.w12[k] == 0) continue;
      const Vec3 b = pointAt(r, k + 1), c = pointAt(r, g.at(i, j + 1));
      const Vec3 d = pointAt(r, g.at(i + 1, j + 1));
      const Vec3 s1 = 0.5 * (b - a + d - c), s2 = 0.5 * (c - a + d - b);
      const double t = s1.dot(s2) - c_.g12[k];
      const double stress = plateauStress(t, c_.lim12[k]);
      // g = s1·s2; s1 = Σ α_c r_c, s2 = Σ β_c r_c.
      static constexpr double alpha[4] = {-0.5, 0.5, -0.5, 0.5}, beta[4] = {-0.5, -0.5, 0.5, 0.5};
      for (int m = 0; m < 4; ++m) {
        const Vec3 gm = alpha[m] * s2 + beta[m] * s1;
        for (int n = 0; n < 4; ++n) {
          const Vec3 gn = alpha[n] * s2 + beta[n] * s1;
          Mat3 h = Mat3::Zero();
          if (std::abs(t) < c_.lim12[k]) h = gm * gn.transpose();
          if (!definite) h += stress * (alpha[m] * beta[n] + beta[m] * alpha[n]) * Mat3::Identity();
          addBlock(entries, p[m], p[n], c_.w12[k] * h);
        }
      }
    }
  }
}

}  // namespace fascia
