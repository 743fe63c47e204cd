#pragma once

#include <fascia/skin/grid/grid_stepper.h>
#include <fascia/skin/point/leapfrog.h>

#include "grids.h"

namespace fascia::test {

// A flat elastic sheet or tube with nothing around it: only what a test adds. Pinned at its border.
struct PinnedSheet {
  struct Options {
    GridLayout layout{17, 17, false};
    double width_m = 1, height_m = 1;
    double stretchU_N_per_m = 150, stretchV_N_per_m = 150, shear_N_per_m = 60;
    double prestretch = 1, maxStretch = 4;
    double density_kg_per_m2 = 4;
    double drag_Ns_per_m3 = 0;
    Vec3 gravity_m_per_s2 = Vec3::Zero();
    bool pinned = true;
  };

  GridLayout layout;
  VectorArray rest, position, velocity;
  ElasticGrid elastic;
  PointModel points;
  StepCoefficients step;
  PointSurroundings around;
  Vec3 gravity;
  GridStepper stepper;

  explicit PinnedSheet(const Options& o)
      : layout(o.layout),
        rest(o.layout.closed ? tube(layout, o.width_m / (2 * kPi), o.height_m)
                             : sheet(layout, o.width_m, o.height_m)),
        position(rest),
        velocity(layout.storage()),
        elastic(layout, rest,
                uniformMaterial(layout, o.stretchU_N_per_m, o.stretchV_N_per_m, o.shear_N_per_m,
                                o.prestretch, o.maxStretch)),
        gravity(o.gravity_m_per_s2),
        stepper(layout) {
    for (FloatArray* a : {&points.mass, &points.drag, &points.fat, &points.tissueStiffness,
                          &points.tissueDamping, &points.tissueRestLength, &points.free})
      a->assign(layout.storage(), 0.f);
    points.stiffnessBound = elastic.stiffnessBound();
    const FloatArray areas = pointAreas(layout, rest);
    forEachPoint(layout, [&](int i, int j, std::size_t k) {
      points.mass[k] = static_cast<float>(o.density_kg_per_m2 * areas[k]);
      points.drag[k] = static_cast<float>(o.drag_Ns_per_m3 * areas[k]);
      const bool border =
          j == 0 || j + 1 == layout.rows || (!layout.closed && (i == 0 || i + 1 == layout.columns));
      points.free[k] = o.pinned && border ? 0.f : 1.f;
    });
    around.resize(layout.storage());
  }

  void prepare(double h_s, const ContactResponse& contact = {}) {
    prepareStep(points, contact, h_s, step);
  }
  SweepModel model() const {
    SweepModel m{&layout, &elastic.coefficients(), {&points, &step, &around, nullptr, {}}};
    for (int a = 0; a < 3; ++a) m.inputs.gravity[a] = static_cast<float>(gravity[a]);
    return m;
  }
  void run(int steps) { stepper.run(model(), 0, steps, position, velocity); }

  // From rest at `position`: velocities belong half a step earlier than positions.
  void startFromRest() {
    const VectorArray force = membraneForces(elastic, position);
    forEachPoint(layout, [&](int, int, std::size_t k) {
      const double gain = points.free[k] > 0 ? -0.5 * step.step_s / points.mass[k] : 0;
      put(velocity, k, gain * (at(force, k) + points.mass[k] * gravity));
    });
  }
  // The kinetic energy at the positions' time, from the velocities before and after a half step.
  double energy() const {
    const VectorArray force = membraneForces(elastic, position);
    double kinetic = 0;
    forEachPoint(layout, [&](int, int, std::size_t k) {
      if (points.free[k] == 0) return;
      const Vec3 v = at(velocity, k) + 0.5 * step.step_s / points.mass[k] * at(force, k);
      kinetic += 0.5 * points.mass[k] * v.squaredNorm();
    });
    return kinetic + elastic.energy(position);
  }
};

inline bool sameBits(const GridLayout& g, const VectorArray& a, const VectorArray& b) {
  bool same = true;
  forEachPoint(g, [&](int, int, std::size_t k) {
    same = same && a.x[k] == b.x[k] && a.y[k] == b.y[k] && a.z[k] == b.z[k];
  });
  return same;
}

// Infinite if any coordinate is not a number.
inline double largestDistance(const GridLayout& g, const VectorArray& a, const VectorArray& b) {
  double largest = 0;
  forEachPoint(g, [&](int, int, std::size_t k) {
    const double distance = (at(a, k) - at(b, k)).norm();
    largest = std::max(largest, std::isnan(distance) ? HUGE_VAL : distance);
  });
  return largest;
}

}  // namespace fascia::test
