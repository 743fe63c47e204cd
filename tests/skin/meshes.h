#pragma once

#include <cmath>
#include <vector>

#include <Eigen/Core>

#include <fascia/base/random.h>
#include <fascia/skin/mesh/mesh_kernels.h>
#include <fascia/skin/mesh/triangle_membrane.h>

namespace fascia::test {

using Corners = TriangleMembrane::Corners;

inline Vec3 pointOf(const VectorArray& a, std::size_t k) {
  return {a.x[k], a.y[k], a.z[k]};
}
// Onto multiples of 2^-20 m: small differences of such coordinates are exact in single precision.
inline void putPoint(VectorArray& a, std::size_t k, const Vec3& p) {
  const auto snap = [](double x) { return static_cast<float>(std::round(x * 0x1p20) * 0x1p-20); };
  a.x[k] = snap(p.x()), a.y[k] = snap(p.y()), a.z[k] = snap(p.z());
}

// A triangulated rectangle in the plane z = 0 from the origin, and a material for it.
struct MeshSheet {
  int columns, rows;
  std::vector<Corners> triangles;
  VectorArray rest;
  TriangleMaterial material;

  MeshSheet(int columnCount, int rowCount, double width_m, double height_m)
      : columns(columnCount), rows(rowCount), rest((count() + 15) / 16 * 16 + 16) {
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i)
        putPoint(rest, at(i, j), {width_m * i / (columns - 1), height_m * j / (rows - 1), 0});
    for (int j = 0; j + 1 < rows; ++j) {
      for (int i = 0; i + 1 < columns; ++i) {
        const std::uint32_t a = at(i, j), b = at(i + 1, j), c = at(i, j + 1), d = at(i + 1, j + 1);
        // Both diagonals occur, and each corner comes first in some triangle.
        if ((i + j) % 3 == 0)
          triangles.insert(triangles.end(), {Corners{a, b, d}, Corners{d, c, a}});
        else
          triangles.insert(triangles.end(), {Corners{c, a, b}, Corners{b, d, c}});
      }
    }
    setMaterial(150, 150, 75);
  }
  std::size_t count() const { return static_cast<std::size_t>(columns * rows); }
  std::uint32_t at(int i, int j) const { return static_cast<std::uint32_t>(j * columns + i); }
  double spacing_m() const { return (pointOf(rest, 1) - pointOf(rest, 0)).norm(); }

  void setMaterial(double u, double v, double shear, double prestretch = 1) {
    const auto fill = [&](FloatArray& a, double value) {
      a.assign(rest.size(), static_cast<float>(value));
    };
    fill(material.stretch_u, u), fill(material.stretch_v, v), fill(material.shear, shear);
    fill(material.prestretch, prestretch);
  }
  void setBending(double bending_Nm) {
    material.bending.assign(rest.size(), static_cast<float>(bending_Nm));
  }
  void setDirection(const Vec3& u) { material.u.assign(triangles.size(), u.cast<float>()); }
  TriangleMembrane membrane() const { return TriangleMembrane(triangles, rest, material); }

  // Moves every point by up to `amplitude` spacings in every direction that the sheet has.
  VectorArray scattered(double amplitude, Random& random, bool inPlane = false) const {
    VectorArray r = rest;
    for (std::size_t k = 0; k < count(); ++k) {
      const Vec3 by(random.uniform(-1, 1), random.uniform(-1, 1),
                    inPlane ? 0 : random.uniform(-1, 1));
      putPoint(r, k, pointOf(rest, k) + amplitude * spacing_m() * by);
    }
    return r;
  }
  template <class Map>
  VectorArray mapped(const Map& map) const {
    VectorArray r = rest;
    for (std::size_t k = 0; k < count(); ++k) putPoint(r, k, map(pointOf(rest, k)));
    return r;
  }
};

// Uneven triangles of a material that differs from point to point.
inline MeshSheet unevenSheet(int columns, int rows, Random& random) {
  MeshSheet sheet(columns, rows, 0.1 * (columns - 1), 0.1 * (rows - 1));
  sheet.rest = sheet.scattered(0.2, random);
  const auto vary = [&](FloatArray& a, double low, double high) {
    for (float& x : a) x = static_cast<float>(random.uniform(low, high));
  };
  vary(sheet.material.stretch_u, 50, 300), vary(sheet.material.stretch_v, 50, 300);
  vary(sheet.material.shear, 20, 200), vary(sheet.material.prestretch, 0.9, 1.2);
  sheet.setDirection(Vec3(1, 0.3, 0.1));
  return sheet;
}

inline Eigen::VectorXd flatten(const VectorArray& a, std::size_t count) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(3 * count));
  for (std::size_t k = 0; k < count; ++k)
    out.segment<3>(static_cast<Eigen::Index>(3 * k)) = pointOf(a, k);
  return out;
}

// Gradient of an energy of the points by central differences of 2^-16 m.
template <class Energy>
Eigen::VectorXd energyGradient(VectorArray r, std::size_t count, const Energy& energy) {
  constexpr float kStep_m = 0x1p-16f;
  Eigen::VectorXd out(static_cast<Eigen::Index>(3 * count));
  Eigen::Index n = 0;
  for (std::size_t k = 0; k < count; ++k) {
    for (FloatArray* axis : {&r.x, &r.y, &r.z}) {
      const float there = (*axis)[k];
      (*axis)[k] = there + kStep_m;
      const double above = energy(r);
      (*axis)[k] = there - kStep_m;
      const double below = energy(r);
      (*axis)[k] = there;
      out[n++] = (above - below) / (2.0 * kStep_m);
    }
  }
  return out;
}

inline VectorArray forcesOf(const TriangleMembrane& membrane, const VectorArray& r) {
  VectorArray force(r.size());
  meshForces(membrane, r, force);
  return force;
}

// The membrane's definition, triangle by triangle and in double precision; without bending.
inline Eigen::VectorXd plainForces(const TriangleMembrane& membrane, const Eigen::VectorXd& flat) {
  Eigen::VectorXd force = Eigen::VectorXd::Zero(flat.size());
  const double cap = membrane.cap();
  for (const TriangleMembrane::Triangle& t : membrane.triangles()) {
    const auto corner = [&](std::size_t c) { return 3 * static_cast<Eigen::Index>(t.corners[c]); };
    const Vec3 origin = flat.segment<3>(corner(0));
    const Vec3 e1 = flat.segment<3>(corner(1)) - origin, e2 = flat.segment<3>(corner(2)) - origin;
    const Vec3 xu = t.u[0] * e1 + t.u[1] * e2, xv = t.v[0] * e1 + t.v[1] * e2;
    const double su = t.stretch_u * 0.5 * std::clamp(xu.squaredNorm() - 1, -cap, cap);
    const double sv = t.stretch_v * 0.5 * std::clamp(xv.squaredNorm() - 1, -cap, cap);
    const double shear = t.shear * std::clamp(xu.dot(xv), -cap, cap);
    const Vec3 pu = su * xu + shear * xv, pv = sv * xv + shear * xu;
    for (std::size_t c = 1; c < 3; ++c) {
      const Vec3 pull = t.u[c - 1] * pu + t.v[c - 1] * pv;
      force.segment<3>(corner(c)) -= pull;
      force.segment<3>(corner(0)) += pull;
    }
  }
  return force;
}

inline bool allFinite(const VectorArray& a) {
  for (const FloatArray* axis : {&a.x, &a.y, &a.z})
    for (const float x : *axis)
      if (!std::isfinite(x)) return false;
  return true;
}

}  // namespace fascia::test
