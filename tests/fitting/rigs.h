#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>

#include <fascia/rig/rigged_model.h>

namespace fascia::testing {

// Small rigged bodies with closed forms.

inline void addJoint(RiggedModel& model, const std::string& name, int parent, const Vec3& at) {
  RigJoint joint;
  joint.name = name;
  joint.parent = parent;
  joint.rest_world.translation_m = at;
  model.joints.push_back(joint);
}

inline PointWeights onlyJoint(std::size_t joint) {
  PointWeights w;
  w.joint[0] = static_cast<std::uint16_t>(joint);
  w.weight[0] = 1;
  return w;
}

// Two influences: `second` has the share.
inline PointWeights between(std::size_t first, std::size_t second, double share) {
  PointWeights w;
  const bool flip = share > 0.5;
  w.joint[0] = static_cast<std::uint16_t>(flip ? second : first);
  w.joint[1] = static_cast<std::uint16_t>(flip ? first : second);
  w.weight[0] = static_cast<float>(flip ? share : 1 - share);
  w.weight[1] = 1 - w.weight[0];
  if (w.weight[1] <= 0) w.joint[1] = 0;
  return w;
}

// A closed surface of rings: `at(u, v)` for u around in [0, 1) and v in [0, 1] from pole to pole.
inline void addClosedSurface(RiggedModel& model, int around, int along,
                             const std::function<Vec3(double u, double v)>& at,
                             const std::function<PointWeights(const Vec3&)>& weights) {
  const auto first = static_cast<std::uint32_t>(model.points_m.size());
  const std::uint32_t piece = model.componentCount++;
  const auto add = [&](const Vec3& p) {
    model.points_m.push_back(p.cast<float>());
    model.weights.push_back(weights(p));
    model.component.push_back(piece);
  };
  add(at(0, 0));
  for (int i = 1; i < along; ++i) {
    for (int j = 0; j < around; ++j)
      add(at(static_cast<double>(j) / around, static_cast<double>(i) / along));
  }
  add(at(0, 1));
  const auto last = static_cast<std::uint32_t>(model.points_m.size() - 1);
  const auto ring = [&](int i, int j) {
    return first + 1 + static_cast<std::uint32_t>((i - 1) * around + j % around);
  };
  for (int j = 0; j < around; ++j) {
    model.triangles.push_back({first, ring(1, j + 1), ring(1, j)});
    model.triangles.push_back({last, ring(along - 1, j), ring(along - 1, j + 1)});
    for (int i = 1; i + 1 < along; ++i) {
      model.triangles.push_back({ring(i, j), ring(i, j + 1), ring(i + 1, j)});
      model.triangles.push_back({ring(i, j + 1), ring(i + 1, j + 1), ring(i + 1, j)});
    }
  }
}

// An ellipsoid around `centre` with its poles along y.
inline void addEllipsoid(RiggedModel& model, const Vec3& centre, const Vec3& half_m,
                         const std::function<PointWeights(const Vec3&)>& weights) {
  addClosedSurface(
      model, 32, 24,
      [&](double u, double v) {
        const double a = 2 * kPi * u, b = kPi * (v - 0.5);
        return Vec3(centre + half_m.cwiseProduct(Vec3(std::cos(a) * std::cos(b), std::sin(b),
                                                      -std::sin(a) * std::cos(b))));
      },
      weights);
}

// A tube with round ends along x from `from` to `to`; the radius goes linearly.
inline void addLimb(RiggedModel& model, const Vec3& from, const Vec3& to, double radiusFrom_m,
                    double radiusTo_m, const std::function<PointWeights(const Vec3&)>& weights) {
  const Vec3 axis = to - from, z = axis.normalized(), x = z.unitOrthogonal(), y = z.cross(x);
  addClosedSurface(
      model, 24, 40,
      [&](double u, double v) {
        const double a = 2 * kPi * u, share = std::clamp((v - 0.15) / 0.7, 0.0, 1.0);
        const double radius = radiusFrom_m + share * (radiusTo_m - radiusFrom_m);
        // The round ends take 0.15 of the rings each.
        const double low = v < 0.15 ? (0.15 - v) / 0.15 : v > 0.85 ? (0.85 - v) / 0.15 : 0;
        const double b = low * kPi / 2;
        return Vec3(from + share * axis - radius * std::sin(b) * z +
                    radius * std::cos(b) * (std::cos(a) * x + std::sin(a) * y));
      },
      weights);
}

// An upper and a lower arm along ±x with the elbow half way; side −1 mirrors it.
inline void addArm(RiggedModel& model, int parent, double side, const std::string& suffix) {
  const auto upper = model.joints.size();
  addJoint(model, "upper_arm" + suffix, parent, Vec3(side * 0.2, 1, 0));
  addJoint(model, "forearm" + suffix, static_cast<int>(upper), Vec3(side * 0.5, 1, 0));
  addJoint(model, "hand" + suffix, static_cast<int>(upper) + 1, Vec3(side * 0.8, 1, 0));
  addLimb(model, Vec3(side * 0.2, 1, 0), Vec3(side * 0.78, 1, 0), 0.06, 0.04, [=](const Vec3& p) {
    const double beyond = std::abs(p.x()) - 0.5;
    return between(upper, upper + 1, std::clamp(0.5 + beyond / 0.08, 0.0, 1.0));
  });
}

}  // namespace fascia::testing
