#include <fascia/field/shapes/superquadric.h>

#include <algorithm>
#include <cmath>

#include <fascia/field/shapes/lattice.h>

namespace fascia {

namespace {

double beta(double a, double b) {
  return std::tgamma(a) * std::tgamma(b) / std::tgamma(a + b);
}

// (a^p + b^p)^(1/p) without overflow; a, b >= 0.
double powerNorm(double a, double b, double p) {
  const double larger = std::max(a, b);
  if (larger == 0) return 0;
  return larger * std::pow(1 + std::pow(std::min(a, b) / larger, p), 1 / p);
}

Superquadric superquadricOf(std::span<const double> p) {
  return {Vec3(p[0], p[1], p[2]), p[3], p[4]};
}

}  // namespace

// Jaklič, Leonardis & Solina 2000, eq. 2.60: V = 2 a b c e1 e2 B(e1/2 + 1, e1) B(e2/2, e2/2).
double volume_m3(const Superquadric& s) {
  const double e1 = s.northSouth_e1, e2 = s.eastWest_e2;
  return 2 * s.half_m.prod() * e1 * e2 * beta(e1 / 2 + 1, e1) * beta(e2 / 2, e2 / 2);
}

double gauge(const Superquadric& s, const Vec3& x) {
  const Vec3 u = x.cwiseQuotient(s.half_m).cwiseAbs();
  return powerNorm(powerNorm(u.x(), u.y(), 2 / s.eastWest_e2), u.z(), 2 / s.northSouth_e1);
}

Vec3 gaugeGradient(const Superquadric& s, const Vec3& x) {
  const double p = 2 / s.eastWest_e2, q = 2 / s.northSouth_e1;
  // A hair off the coordinate planes, where 0^0 would appear (exponent 2).
  const double tiny = 1e-12 * std::max(x.cwiseQuotient(s.half_m).norm(), 1e-150);
  const Vec3 u = x.cwiseQuotient(s.half_m).cwiseAbs().cwiseMax(tiny);
  const double lateral = powerNorm(u.x(), u.y(), p);
  const double whole = powerNorm(lateral, u.z(), q);
  const double outer = std::pow(lateral / whole, q - 1);
  const Vec3 g(outer * std::pow(u.x() / lateral, p - 1), outer * std::pow(u.y() / lateral, p - 1),
               std::pow(u.z() / whole, q - 1));
  Vec3 signedGradient = g.cwiseQuotient(s.half_m);
  for (int i = 0; i < 3; ++i) signedGradient[i] = std::copysign(signedGradient[i], x[i]);
  return signedGradient;
}

PrimitiveKernel kernel(const Superquadric& s) {
  PrimitiveKernel k;
  const bool ellipsoid = s.northSouth_e1 == 1 && s.eastWest_e2 == 1;
  k.kind = ellipsoid ? PrimitiveKernel::Kind::ellipsoid : PrimitiveKernel::Kind::superellipsoid;
  for (int i = 0; i < 3; ++i) {
    k.half_m[i] = static_cast<float>(s.half_m[i]);
    k.square_m2[i] = k.half_m[i] * k.half_m[i];
    k.inverse_per_m[i] = 1 / k.half_m[i];
  }
  k.least_m = static_cast<float>(s.half_m.minCoeff());
  k.northSouthPower = static_cast<float>(2 / s.northSouth_e1);
  k.eastWestPower = static_cast<float>(2 / s.eastWest_e2);
  k.northSouthRoot = 1 / k.northSouthPower;
  k.eastWestRoot = 1 / k.eastWestPower;
  return k;
}

TriangleMesh tessellate(const Superquadric& s, int detail) {
  return latticeSurface(detail, false, [&](const Vec3& direction, bool) {
    const Vec3 ray = direction.cwiseProduct(s.half_m);
    return SurfacePoint{ray / gauge(s, ray), gaugeGradient(s, ray).normalized()};
  });
}

double SuperquadricShape::volume_m3(std::span<const double> p) const {
  return fascia::volume_m3(superquadricOf(p));
}

Vec3 SuperquadricShape::halfExtents_m(std::span<const double> p) const {
  return superquadricOf(p).half_m;
}

double SuperquadricShape::gauge(std::span<const double> p, const Vec3& x) const {
  return fascia::gauge(superquadricOf(p), x);
}

TriangleMesh SuperquadricShape::tessellate(std::span<const double> p, int detail) const {
  return fascia::tessellate(superquadricOf(p), detail);
}

PrimitiveKernel SuperquadricShape::kernel(std::span<const double> p) const {
  return fascia::kernel(superquadricOf(p));
}

}  // namespace fascia
