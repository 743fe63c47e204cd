#pragma once

#include <string>
#include <vector>

#include <fascia/base/random.h>
#include <fascia/field/solid.h>

namespace fascia {

inline Solid makeSolid(const SolidDef& def) {
  Diagnostics diagnostics;
  Solid solid(def, "", diagnostics);
  diagnostics.throwIfErrors();
  return solid;
}

inline Vec3 randomDirection(Random& random) {
  for (;;) {
    const Vec3 v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    if (v.squaredNorm() < 1 && v.squaredNorm() > 1e-4) return v.normalized();
  }
}

inline double randomHalfSize_m(Random& random) {
  return 0.05 * std::pow(4.0, random.uniform());
}

inline SolidDef randomSuperellipsoid(Random& random, double least, double most) {
  const double x = randomHalfSize_m(random), y = randomHalfSize_m(random);
  const double z = randomHalfSize_m(random), e1 = random.uniform(least, most);
  return {"superellipsoid", {x, y, z, e1, random.uniform(least, most)}, {}};
}

struct Sample {
  double distance_m;
  Vec3 normal;
};

inline Sample evaluateOne(const Solid& solid, const Vec3& p) {
  VectorArray point(1), normal(1);
  point.x[0] = static_cast<float>(p.x());
  point.y[0] = static_cast<float>(p.y());
  point.z[0] = static_cast<float>(p.z());
  float distance_m = 0;
  solid.evaluate(view(point, 0, 1), &distance_m, view(normal, 0, 1));
  return {static_cast<double>(distance_m),
          Eigen::Vector3f(normal.x[0], normal.y[0], normal.z[0]).cast<double>()};
}

// One solid of every kind, plain and deformed.
inline std::vector<SolidDef> assortedSolids() {
  return {
      {"sphere", {0.1}, {}},
      {"capsule", {0.07, 0.12}, {}},
      {"superellipsoid", {0.1, 0.07, 0.16, 1, 1}, {}},
      {"superellipsoid", {0.1, 0.07, 0.16, 0.4, 1.3}, {}},
      {"superellipsoid", {0.12, 0.1, 0.08, 0.1, 0.1}, {}},
      {"superellipsoid", {0.12, 0.1, 0.08, 2, 2}, {}},
      {"cylinder", {0.06, 0.08, 0.2}, {}},
      {"sphere", {0.1}, {{"taper", {0.5}}}},
      {"capsule", {0.05, 0.15}, {{"twist", {2.0}}}},
      {"capsule", {0.05, 0.15}, {{"bend", {1.2}}}},
      {"superellipsoid", {0.06, 0.05, 0.16, 0.6, 0.8}, {{"bend", {-0.9}}, {"taper", {-0.3}}}},
      {"cylinder", {0.04, 0.06, 0.2}, {{"taper", {0.3}}, {"twist", {-1.5}}, {"bend", {0.7}}}},
  };
}

}  // namespace fascia
