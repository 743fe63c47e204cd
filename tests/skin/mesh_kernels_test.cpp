#include <gtest/gtest.h>

#include <fascia/base/parallel.h>
#include <fascia/math/finite_difference.h>
#include <fascia/skin/point/leapfrog.h>

#include "meshes.h"

namespace fascia {
namespace {

using test::MeshSheet, test::pointOf;

// A sheet with everything that a step reads.
struct SteppedSheet {
  MeshSheet sheet;
  TriangleMembrane membrane;
  PointModel points;
  PointSurroundings around;
  StepCoefficients step;
  VectorArray position, velocity;
  Vec3 gravity_m_per_s2 = Vec3::Zero();
  MeshStepper stepper;

  SteppedSheet(MeshSheet given, double drag_Ns_per_m3 = 0)
      : sheet(std::move(given)),
        membrane(sheet.membrane()),
        position(sheet.rest),
        velocity(sheet.rest.size()),
        stepper(membrane) {
    const std::size_t n = sheet.rest.size();
    for (FloatArray* a : {&points.mass, &points.drag, &points.fat, &points.tissueStiffness,
                          &points.tissueDamping, &points.tissueRestLength, &points.free})
      a->assign(n, 0.f);
    points.stiffnessBound = membrane.stiffnessBound();
    for (std::size_t k = 0; k < sheet.count(); ++k) {
      points.mass[k] = 4 * membrane.pointAreas()[k];
      points.drag[k] = static_cast<float>(drag_Ns_per_m3) * membrane.pointAreas()[k];
      points.free[k] = 1;
    }
    around.resize(n);
    around.anchor = sheet.rest;
  }
  void prepare(double step_s) { prepareStep(points, {}, step_s, step); }
  StepInputs inputs(const VectorArray* extraForce = nullptr) const {
    StepInputs in{&points, &step, &around, extraForce, {}};
    for (int a = 0; a < 3; ++a) in.gravity[a] = static_cast<float>(gravity_m_per_s2[a]);
    return in;
  }
  void run(int steps, const VectorArray* extraForce = nullptr) {
    stepper.run(inputs(extraForce), 0, steps, position, velocity);
  }
  double energy() const {
    double kinetic = 0;
    for (std::size_t k = 0; k < sheet.count(); ++k)
      kinetic += 0.5 * points.mass[k] * pointOf(velocity, k).squaredNorm();
    return kinetic + membrane.energy(position);
  }
};

// Tissue, flesh, gravity, drag and fixed points, all different from point to point.
SteppedSheet busySheet(int columns, int rows, Random& random) {
  MeshSheet sheet = test::unevenSheet(columns, rows, random);
  sheet.setBending(0.05);
  SteppedSheet out(std::move(sheet), 3);
  out.gravity_m_per_s2 = Vec3(0.5, -9.81, 1);
  const auto vary = [&](FloatArray& a, double low, double high) {
    for (std::size_t k = 0; k < out.sheet.count(); ++k)
      a[k] = static_cast<float>(random.uniform(low, high));
  };
  vary(out.points.tissueStiffness, 0, 20), vary(out.points.tissueDamping, 0, 0.2);
  vary(out.points.tissueRestLength, 0, 0.02);
  for (VectorArray* a : {&out.velocity, &out.around.anchorVelocity, &out.around.fleshVelocity})
    for (FloatArray* axis : {&a->x, &a->y, &a->z}) vary(*axis, -0.5, 0.5);
  for (std::size_t k = 0; k < out.sheet.count(); ++k) {
    const Vec3 normal(random.uniform(-1, 1), random.uniform(-1, 1), 0.2);
    const Vec3 unit = normal.normalized();
    if (k % 3 == 0) {
      out.around.normal.x[k] = static_cast<float>(unit.x());
      out.around.normal.y[k] = static_cast<float>(unit.y());
      out.around.normal.z[k] = static_cast<float>(unit.z());
      out.around.offset[k] =
          static_cast<float>(unit.dot(pointOf(out.position, k)) + random.uniform(-0.02, 0.01));
    }
    if (k % 17 == 0) out.points.free[k] = 0;
  }
  out.position = out.sheet.scattered(0.2, random);
  out.prepare(1.0 / 480);
  return out;
}

// One step of leapfrog.h and point_step-inl.h in double precision. Returns how deep the point came
// into the flesh, m.
double plainStep(const SteppedSheet& s, std::size_t k, Vec3 force, double time_s, Vec3& r,
                 Vec3& v) {
  const PointModel& p = s.points;
  const double h = s.step.step_s;
  const Vec3 anchorVelocity = pointOf(s.around.anchorVelocity, k);
  const Vec3 strand = r - pointOf(s.around.anchor, k) - (time_s - h) * anchorVelocity;
  const double length = strand.norm(), extension = length - p.tissueRestLength[k];
  Vec3 closing = Vec3::Zero();
  if (extension > 0 && length > 0) {
    force -= p.tissueStiffness[k] * extension / length * strand;
    const Vec3 relative = v - anchorVelocity;
    closing =
        s.step.strandGain[k] *
        (p.tissueRestLength[k] == 0 ? relative : relative.dot(strand) / (length * length) * strand);
  }
  force += s.step.weight[k] * s.gravity_m_per_s2;
  v = s.step.keep[k] * v + s.step.gain[k] * force - closing;
  r += h * v;
  const Vec3 normal = pointOf(s.around.normal, k), flesh = pointOf(s.around.fleshVelocity, k);
  const double depth = normal.dot(r) - s.around.offset[k] - time_s * normal.dot(flesh);
  if (depth >= 0) return -depth;
  r -= depth * normal;
  const Vec3 relative = v - flesh;
  const double along = relative.dot(normal);
  v = flesh + s.step.slide * (relative - along * normal) +
      (along < 0 ? -s.step.bounce * along : along) * normal;
  return -depth;
}

TEST(MeshKernels, ForcesEqualAPlainLoop) {
  Random random(51);
  for (const int columns : {2, 5, 16, 17, 33, 70}) {  // the last needs several chunks
    const MeshSheet sheet = test::unevenSheet(columns, columns + 3, random);
    const TriangleMembrane membrane = sheet.membrane();
    const VectorArray r = sheet.scattered(0.7, random);
    const Eigen::VectorXd plain = test::plainForces(membrane, test::flatten(r, sheet.count()));
    EXPECT_GT(plain.norm(), 1);
    const Eigen::VectorXd force = test::flatten(test::forcesOf(membrane, r), sheet.count());
    EXPECT_LT(derivativeMismatch(plain, force), 5e-6) << columns;
  }
}

TEST(MeshKernels, StepsEqualAPlainLoop) {
  Random random(52);
  for (const int columns : {4, 17, 60}) {
    SteppedSheet s = busySheet(columns, columns, random);
    int touching = 0;
    for (int n = 0; n < 3; ++n) {
      const VectorArray force = test::forcesOf(s.membrane, s.position);
      const VectorArray before = s.position, velocityBefore = s.velocity;
      s.stepper.run(s.inputs(), n, 1, s.position, s.velocity);
      for (std::size_t k = 0; k < s.sheet.count(); ++k) {
        Vec3 r = pointOf(before, k), v = pointOf(velocityBefore, k);
        const double time_s = (n + 1) * double{s.step.step_s};
        const double depth_m = plainStep(s, k, pointOf(force, k), time_s, r, v);
        touching += depth_m > 1e-6;
        if (std::abs(depth_m) < 1e-6) continue;  // rounding decides whether it touches
        EXPECT_LT((r - pointOf(s.position, k)).norm(), 2e-6) << k;
        EXPECT_LT((v - pointOf(s.velocity, k)).norm(), 5e-5 * (1 + v.norm())) << k;
      }
    }
    EXPECT_GT(touching, 3);
  }
}

TEST(MeshKernels, StepsTakenTogetherEqualStepsTakenOneByOne) {
  Random random(53);
  SteppedSheet s = busySheet(50, 50, random);
  VectorArray position = s.position, velocity = s.velocity;
  s.run(6);
  for (int n = 0; n < 6; ++n) s.stepper.run(s.inputs(), n, 1, position, velocity);
  EXPECT_EQ(s.position.x, position.x);
  EXPECT_EQ(s.velocity.z, velocity.z);
}

TEST(MeshKernels, SameBitsOnAnyNumberOfThreads) {
  Random random(54);
  const SteppedSheet start = busySheet(80, 70, random);
  const auto result = [&](int threads) {
    const ThreadLimit limit(threads);
    SteppedSheet s = start;
    s.run(8);
    return std::pair(s.position, s.velocity);
  };
  const auto [position, velocity] = result(1);
  EXPECT_TRUE(test::allFinite(position));
  for (const int threads : {2, 3, 8}) {
    const auto [otherPosition, otherVelocity] = result(threads);
    EXPECT_TRUE(position.x == otherPosition.x && position.y == otherPosition.y &&
                position.z == otherPosition.z);
    EXPECT_TRUE(velocity.x == otherVelocity.x && velocity.y == otherVelocity.y &&
                velocity.z == otherVelocity.z);
  }
}

TEST(MeshKernels, ExtraForcesAreAdded) {
  MeshSheet sheet(6, 6, 0.5, 0.5);
  SteppedSheet s(std::move(sheet));
  s.prepare(1.0 / 480);
  VectorArray extra(s.position.size());
  extra.y[7] = 0.25f;
  s.run(1, &extra);
  EXPECT_NEAR(s.velocity.y[7], s.step.gain[7] * 0.25, 1e-6);
  EXPECT_NEAR(s.velocity.y[8], 0, 1e-6);
}

// A strip that is held at one end and pulled at the other stretches until K E λ = F, K that of the
// direction it is pulled along, E = ½(λ² − 1).
TEST(MeshDynamics, AStripPulledAlongUOrVStretchesAsTheClosedFormSays) {
  constexpr double kPull_N_per_m = 20;
  for (const bool along : {true, false}) {
    MeshSheet sheet(17, 5, 0.8, 0.2);
    sheet.setMaterial(190, 80, 45);
    sheet.setDirection(along ? Vec3::UnitX() : Vec3::UnitY());
    SteppedSheet s(std::move(sheet), 60);
    for (int j = 0; j < 5; ++j) s.points.free[s.sheet.at(0, j)] = 0;
    s.prepare(1.0 / 240);
    VectorArray pull(s.position.size());
    for (int j = 0; j < 5; ++j)
      pull.x[s.sheet.at(16, j)] =
          static_cast<float>(kPull_N_per_m * 0.05 * (j == 0 || j == 4 ? 0.5 : 1));
    s.run(3000, &pull);
    const double stiffness = along ? 190 : 80;
    double stretch = 1;
    for (int i = 0; i < 50; ++i)
      stretch -= (0.5 * stiffness * (stretch * stretch - 1) * stretch - kPull_N_per_m) /
                 (0.5 * stiffness * (3 * stretch * stretch - 1));
    EXPECT_GT(stretch, 1.05);
    for (int j = 0; j < 5; ++j)
      EXPECT_NEAR(s.position.x[s.sheet.at(16, j)] / 0.8, stretch, 2e-3) << along;
  }
}

TEST(MeshDynamics, DragTakesAllEnergy) {
  Random random(55);
  MeshSheet sheet = test::unevenSheet(20, 20, random);
  sheet.setBending(0.02);
  SteppedSheet s(std::move(sheet), 15);
  s.position = s.sheet.scattered(0.3, random);
  s.prepare(1.0 / 480);
  double before = s.energy();
  const double start = before;
  EXPECT_GT(start, 0.5);
  for (int n = 0; n < 12; ++n) {
    s.run(120);
    const double now = s.energy();
    EXPECT_LT(now, 1.05 * before) << n;
    before = now;
  }
  EXPECT_LT(before, 0.05 * start);
}

// Steps that resolve the stiffness and steps far longer both stay bounded.
TEST(MeshDynamics, EnergyStaysWithoutDragAtAnyStep) {
  Random random(56);
  for (const double step_s : {1.0 / 4000, 1.0 / 480, 1.0 / 60}) {
    MeshSheet sheet = test::unevenSheet(16, 16, random);
    sheet.setMaterial(150, 150, 60, 1);
    sheet.setBending(0.02);
    SteppedSheet s(std::move(sheet));
    s.position = s.sheet.scattered(0.1, random);
    s.prepare(step_s);
    const double start = s.membrane.energy(s.position);
    double most = 0;
    for (int n = 0; n < 20; ++n) {
      s.run(50);
      most = std::max(most, s.membrane.energy(s.position));
    }
    EXPECT_TRUE(test::allFinite(s.position));
    EXPECT_LT(most, 1.5 * start) << step_s;
    EXPECT_GT(most, 0.1 * start) << step_s;
  }
}

TEST(MeshDynamics, RecoversFromAPointWithoutNaN) {
  Random random(57);
  MeshSheet sheet = test::unevenSheet(9, 9, random);
  sheet.setBending(1);
  SteppedSheet s(std::move(sheet), 5);
  s.prepare(1.0 / 480);
  s.position.fill(0.25f);
  s.run(50);
  EXPECT_TRUE(test::allFinite(s.position) && test::allFinite(s.velocity));
  s.position = s.sheet.scattered(0.05, random);
  s.run(400);
  EXPECT_TRUE(test::allFinite(s.position));
}

TEST(MeshKernels, PointsWithoutTrianglesFall) {
  MeshSheet sheet(4, 4, 0.3, 0.3);
  sheet.triangles.resize(3);
  SteppedSheet s(std::move(sheet));
  s.points.mass[15] = 1;
  s.gravity_m_per_s2 = Vec3(0, -9.81, 0);
  s.prepare(0.01);
  s.run(10);
  EXPECT_NEAR(s.position.y[15] - s.sheet.rest.y[15], -9.81 * 0.01 * 0.01 * 55, 1e-5);
}

}  // namespace
}  // namespace fascia
