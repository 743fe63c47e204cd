#include <fascia/field/reference.h>

#include <algorithm>
#include <cmath>

#include <fascia/field/shapes/superquadric.h>

namespace fascia {

namespace {

Vec3 halfSizes(const PrimitiveKernel& k) {
  return Eigen::Vector3f(k.half_m[0], k.half_m[1], k.half_m[2]).cast<double>();
}

FieldSample sphere(double radius_m, const Vec3& p) {
  const double length = p.norm();
  return {length - radius_m, length > 1e-15 ? Vec3(p / length) : Vec3::UnitX()};
}

FieldSample capsule(const PrimitiveKernel& k, const Vec3& p) {
  const double half = static_cast<double>(k.halfLength_m);
  return sphere(static_cast<double>(k.half_m[0]), p - Vec3(0, 0, std::clamp(p.z(), -half, half)));
}

// The Newton iteration of EllipsoidKernel.
FieldSample ellipsoid(const PrimitiveKernel& k, const Vec3& p) {
  const Vec3 a = halfSizes(k), square = a.cwiseProduct(a);
  const double least = a.minCoeff();
  const Vec3 m = p.cwiseAbs().cwiseMax(1e-6 * least);
  const Vec3 c = m.cwiseProduct(a);
  const Vec3 u = m.cwiseQuotient(a);
  const double low = (c - square).maxCoeff();
  double t = (u.norm() - 1) * u.squaredNorm() / u.cwiseQuotient(a).squaredNorm();
  t = std::max(t, low);
  const auto denominators = [&] { return Vec3((square.array() + t).max(1e-7 * least * least)); };
  for (int i = 0; i < 2; ++i) {
    const Vec3 s2 = c.cwiseQuotient(denominators()).cwiseAbs2();
    t += s2.sum() * (std::sqrt(s2.sum()) - 1) / s2.cwiseQuotient(denominators()).sum();
    t = std::max(t, low);
  }
  Vec3 n = m.cwiseQuotient(denominators()).normalized();
  const double distance = n.dot(p.cwiseAbs()) - n.cwiseProduct(a).norm();
  for (int i = 0; i < 3; ++i) n[i] = std::copysign(n[i], p[i]);
  return {distance, n};
}

// The better of two tangent planes, as in SuperellipsoidKernel.
FieldSample superellipsoid(const PrimitiveKernel& k, const Vec3& p) {
  const Superquadric s{halfSizes(k), 2 / static_cast<double>(k.northSouthPower),
                       2 / static_cast<double>(k.eastWestPower)};
  const Vec3 m = p.cwiseAbs();
  const auto plane = [&](const Vec3& at) {
    const Vec3 gradient = gaugeGradient(s, at.cwiseMax(1e-9 * s.half_m));
    const double length = gradient.norm();
    return FieldSample{(gradient.dot(m) - 1) / length, gradient / length};
  };
  FieldSample first = plane(m);
  const FieldSample second = plane((m - first.distance_m * first.normal).cwiseMax(0));
  if (second.distance_m > first.distance_m) first = second;
  for (int i = 0; i < 3; ++i) first.normal[i] = std::copysign(first.normal[i], p[i]);
  return first;
}

FieldSample primitive(const PrimitiveKernel& k, const Vec3& p) {
  switch (k.kind) {
    case PrimitiveKernel::Kind::sphere:
      return sphere(static_cast<double>(k.half_m[0]), p);
    case PrimitiveKernel::Kind::capsule:
      return capsule(k, p);
    case PrimitiveKernel::Kind::ellipsoid:
      return ellipsoid(k, p);
    case PrimitiveKernel::Kind::superellipsoid:
      break;
  }
  return superellipsoid(k, p);
}

}  // namespace

FieldSample evaluateReference(const Solid& solid, const Vec3& local) {
  const Vec3 x = solid.shapeFromDeformed(local);
  FieldSample sample = primitive(solid.kernel().primitive, x);
  const Vec3 gradient = solid.distanceJacobian(x).inverse().transpose() * sample.normal;
  const double length = gradient.norm();
  return {sample.distance_m / length, gradient / length};
}

}  // namespace fascia
