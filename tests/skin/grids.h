#pragma once

#include <cmath>
#include <ostream>
#include <vector>

#include <Eigen/Core>

#include <fascia/base/random.h>
#include <fascia/skin/grid/elastic_grid.h>
#include <fascia/skin/grid/grid_kernels.h>

namespace fascia::test {

inline Vec3 at(const VectorArray& a, std::size_t k) {
  return {a.x[k], a.y[k], a.z[k]};
}

inline void put(VectorArray& a, std::size_t k, const Vec3& p) {
  a.x[k] = static_cast<float>(p.x());
  a.y[k] = static_cast<float>(p.y());
  a.z[k] = static_cast<float>(p.z());
}

template <class Visit>
void forEachPoint(const GridLayout& g, const Visit& visit) {
  for (int j = 0; j < g.rows; ++j)
    for (int i = 0; i < g.columns; ++i) visit(i, j, g.at(i, j));
}

inline FloatArray constant(const GridLayout& g, double value) {
  return FloatArray(g.storage(), static_cast<float>(value));
}

inline GridMaterial uniformMaterial(const GridLayout& g, double u, double v, double shear,
                                    double prestretch, double maxStretch) {
  return {constant(g, u), constant(g, v), constant(g, shear), constant(g, prestretch),
          static_cast<float>(maxStretch)};
}

// A flat sheet in the plane z = 0 from the origin, or a tube around the y axis.
inline VectorArray sheet(const GridLayout& g, double width_m, double height_m) {
  VectorArray r(g.storage());
  forEachPoint(g, [&](int i, int j, std::size_t k) {
    put(r, k, Vec3(width_m * i / (g.columns - 1), height_m * j / (g.rows - 1), 0));
  });
  fillPads(g, r);
  return r;
}
inline VectorArray tube(const GridLayout& g, double radius_m, double height_m) {
  VectorArray r(g.storage());
  forEachPoint(g, [&](int i, int j, std::size_t k) {
    const double a = 2 * kPi * i / g.columns;
    put(r, k,
        Vec3(radius_m * std::sin(a), height_m * j / (g.rows - 1) - height_m / 2,
             radius_m * std::cos(a)));
  });
  fillPads(g, r);
  return r;
}
inline VectorArray restShape(const GridLayout& g) {
  return g.closed ? tube(g, 0.5, 0.8) : sheet(g, 1.2, 0.8);
}

// Moves every point by up to `amplitude_m` and onto multiples of 2^-20 m: small differences of
// such coordinates are exact in single precision.
inline void scatter(const GridLayout& g, double amplitude_m, Random& random, VectorArray& r) {
  const auto snap = [](double x) { return std::round(x * 0x1p20) * 0x1p-20; };
  forEachPoint(g, [&](int, int, std::size_t k) {
    const Vec3 by(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    const Vec3 p = at(r, k) + amplitude_m * by;
    put(r, k, Vec3(snap(p.x()), snap(p.y()), snap(p.z())));
  });
  fillPads(g, r);
}

// An uneven, skewed rest shape of a material that differs from point to point.
struct RandomGrid {
  GridLayout layout;
  VectorArray rest;
  ElasticGrid elastic;
  double spacing_m = 0;

  RandomGrid(const GridLayout& g, double maxStretch, Random& random) : layout(g) {
    rest = restShape(g);
    spacing_m = (at(rest, g.at(0, 1)) - at(rest, g.at(0, 0))).norm();
    scatter(g, 0.15 * spacing_m, random, rest);
    GridMaterial m = uniformMaterial(g, 0, 0, 0, 1, maxStretch);
    forEachPoint(g, [&](int, int, std::size_t k) {
      m.stretch_u[k] = static_cast<float>(random.uniform(50, 300));
      m.stretch_v[k] = static_cast<float>(random.uniform(50, 300));
      m.shear[k] = static_cast<float>(random.uniform(20, 200));
      m.prestretch[k] = static_cast<float>(random.uniform(0.9, 1.2));
    });
    elastic = ElasticGrid(g, rest, m);
  }
  VectorArray posture(double amplitude, Random& random) const {
    VectorArray r = rest;
    scatter(layout, amplitude * spacing_m, random, r);
    return r;
  }
};

struct GridCase {
  int columns, rows;
  bool closed;
  GridLayout layout() const { return {columns, rows, closed}; }
};
inline std::ostream& operator<<(std::ostream& out, const GridCase& c) {
  return out << c.columns << "x" << c.rows << (c.closed ? "Closed" : "Open");
}
// Widths around multiples of every vector length.
inline std::vector<GridCase> gridCases() {
  std::vector<GridCase> cases;
  for (const int columns : {8, 15, 16, 17, 33})
    for (const bool closed : {true, false}) cases.push_back({columns, 6, closed});
  return cases;
}

// Row-major points as one flat vector, point p = j · columns + i.
inline Eigen::VectorXd flat(const GridLayout& g, const VectorArray& a) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(3 * g.pointCount()));
  Eigen::Index n = 0;
  forEachPoint(g, [&](int, int, std::size_t k) {
    out.segment<3>(n) = at(a, k);
    n += 3;
  });
  return out;
}

inline VectorArray membraneForces(const ElasticGrid& elastic, const VectorArray& r) {
  const GridLayout& g = elastic.layout();
  VectorArray force(g.storage());
  SweepScratch scratch;
  scratch.resize(g);
  gridForces(g, elastic.coefficients(), r, force, scratch);
  return force;
}

// Gradient of an energy of the points by central differences of 2^-16 m: exact steps for
// coordinates on multiples of 2^-20 m.
template <class Energy>
Eigen::VectorXd energyGradient(const GridLayout& g, VectorArray r, const Energy& energy) {
  constexpr float kStep_m = 0x1p-16f;
  Eigen::VectorXd out(static_cast<Eigen::Index>(3 * g.pointCount()));
  Eigen::Index n = 0;
  forEachPoint(g, [&](int, int, std::size_t k) {
    for (FloatArray* axis : {&r.x, &r.y, &r.z}) {
      const float there = (*axis)[k];
      const auto energyAt = [&](float x) {
        (*axis)[k] = x;
        fillPads(g, r);
        return energy(r);
      };
      const double above = energyAt(there + kStep_m), below = energyAt(there - kStep_m);
      energyAt(there);
      out[n++] = (above - below) / (2.0 * kStep_m);
    }
  });
  return out;
}

}  // namespace fascia::test
