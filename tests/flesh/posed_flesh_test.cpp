#include <cmath>

#include <gtest/gtest.h>

#include "arm.h"

namespace fascia {
namespace {

using test::Arm;

std::vector<SolidId> allSolids(const Arm& arm) {
  std::vector<SolidId> ids;
  for (std::size_t i = 0; i < arm.flesh.solidCount(); ++i) ids.emplace_back(static_cast<int>(i));
  return ids;
}

std::vector<float> distances(const PosedFlesh& posed, SolidId solid,
                             const std::vector<Vec3>& points) {
  const VectorArray array = test::toArray(points);
  VectorArray normals(points.size());
  std::vector<float> distance_m(points.size());
  posed.evaluate(solid, view(array, 0, points.size()), distance_m.data(),
                 view(normals, 0, points.size()));
  return distance_m;
}

TEST(PosedFlesh, SolidsStandInTheirJointsFrames) {
  const Arm arm;
  PosedFlesh posed;
  arm.pose(arm.moving(), posed);
  PosedSkeleton skeleton;
  arm.skeleton.pose(arm.moving(), skeleton);
  for (SolidId id : allSolids(arm)) {
    const Transform& joint = skeleton.joint_world[arm.flesh.joint(id).index()];
    const FleshSolidDef& def = arm.flesh.def(id);
    EXPECT_LT((posed.frame(id).translation_m - joint.point(def.position_m)).norm(), 1e-14);
  }
}

TEST(PosedFlesh, DriversSetParametersFromTheJoint) {
  const Arm arm;
  PosedFlesh posed;
  for (const auto& [elbow, half_m] : {std::pair{0.0, 0.04}, {2.5, 0.07}, {1.25, 0.055}}) {
    Posture posture = arm.skeleton.restPosture();
    posture.values[3] = elbow;
    arm.pose(posture, posed);
    EXPECT_NEAR(posed.solid(arm.id("biceps")).parameter(0), half_m, 1e-12);
  }
}

TEST(PosedFlesh, AnchorsStayOnTheSurfaceWhileTheBicepsSwells) {
  const Arm arm;
  PosedFlesh posed;
  for (SolidId id : allSolids(arm)) {
    arm.pose(arm.skeleton.restPosture(), posed);
    std::vector<Vec3> materials;
    for (const Vec3& p : test::surfacePoints(posed, id)) {
      materials.push_back(posed.materialFromWorld(id, p));
    }
    for (double elbow : {0.0, 0.6, 1.7, 2.5}) {
      Posture posture = arm.moving();
      posture.values[3] = elbow;
      arm.pose(posture, posed);
      std::vector<Vec3> anchors;
      for (const Vec3& m : materials) anchors.push_back(posed.worldFromMaterial(id, m));
      for (float distance_m : distances(posed, id, anchors)) EXPECT_NEAR(distance_m, 0, 2e-5);
    }
  }
}

TEST(PosedFlesh, MaterialCoordinatesRoundTrip) {
  const Arm arm;
  PosedFlesh posed;
  arm.pose(arm.moving(), posed);
  for (SolidId id : allSolids(arm)) {
    for (const Vec3& surface : test::surfacePoints(posed, id)) {
      for (double scale : {0.4, 1.0, 1.3}) {  // inside, on and outside
        const Vec3 centre = posed.frame(id).translation_m;
        const Vec3 p = centre + scale * (surface - centre);
        EXPECT_LT((posed.worldFromMaterial(id, posed.materialFromWorld(id, p)) - p).norm(), 1e-9);
      }
    }
  }
}

TEST(PosedFlesh, BatchedMaterialPointsEqualSinglePoints) {
  const Arm arm;
  PosedFlesh posed;
  arm.pose(arm.moving(), posed);
  for (SolidId id : allSolids(arm)) {
    const std::vector<Vec3> surface = test::surfacePoints(posed, id);
    std::vector<Vec3> materials;
    for (const Vec3& p : surface) materials.push_back(posed.materialFromWorld(id, p));
    const VectorArray array = test::toArray(materials);
    VectorArray world(materials.size());
    posed.worldFromMaterials(id, view(array, 0, array.size()), view(world, 0, world.size()));
    for (std::size_t i = 0; i < surface.size(); ++i) {
      EXPECT_LT((test::at(world, i) - surface[i]).norm(), 1e-6);
    }
  }
}

// The velocity of matter against finite differences of where it is. `overridesAt` gives the
// animated parameters at a time near 0.
template <class OverridesAt>
double largestVelocityError(const Arm& arm, SolidId id, const Posture& posture,
                            const OverridesAt& overridesAt, double* fastest) {
  const double h = 1e-4;
  PosedFlesh now, before, after;
  arm.pose(posture, now, overridesAt(0.0));
  arm.pose(test::moved(posture, -h), before, overridesAt(-h));
  arm.pose(test::moved(posture, h), after, overridesAt(h));
  const std::vector<Vec3> points = test::surfacePoints(now, id);
  const VectorArray array = test::toArray(points);
  VectorArray velocity(points.size());
  now.velocity(id, view(array, 0, array.size()), view(velocity, 0, velocity.size()));
  double worst = 0;
  *fastest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 m = now.materialFromWorld(id, points[i]);
    const Vec3 expected =
        (after.worldFromMaterial(id, m) - before.worldFromMaterial(id, m)) / (2 * h);
    worst = std::max(worst, (test::at(velocity, i) - expected).norm());
    *fastest = std::max(*fastest, expected.norm());
  }
  return worst;
}

constexpr auto kNoOverrides = [](double) { return std::vector<Flesh::ParameterOverride>{}; };

TEST(PosedFlesh, VelocityIsTheDerivativeOfWhereTheMatterIs) {
  const Arm arm;
  for (SolidId id : allSolids(arm)) {
    double fastest = 0;
    EXPECT_LT(largestVelocityError(arm, id, arm.moving(), kNoOverrides, &fastest), 1e-5)
        << arm.flesh.def(id).name;
    EXPECT_GT(fastest, 0.3);
  }
}

// With a fixed solid frame, what remains is the swelling alone.
TEST(PosedFlesh, SwellingAloneMovesTheSurface) {
  SkeletonDef still = test::armSkeleton();
  still.joints[0].dofs = {{Dof::tx}};
  still.joints[1].dofs = {};
  still.joints[2].dofs = {{Dof::rz, 0, 2.5, 0}};
  FleshDef flesh = test::armFlesh();
  for (FleshSolidDef& solid : flesh.solids) {
    solid.joint = "shoulder";
    for (DriverDef& driver : solid.drivers) driver.joint = "hand";
  }
  const Arm arm(still, flesh);
  Posture posture = arm.skeleton.restPosture();
  posture.values = {0, 1.1};
  posture.rates = {0, 2.0};
  for (SolidId id : allSolids(arm)) {
    double fastest = 0;
    EXPECT_LT(largestVelocityError(arm, id, posture, kNoOverrides, &fastest), 2e-6)
        << arm.flesh.def(id).name;
    if (!arm.flesh.def(id).drivers.empty()) {
      EXPECT_GT(fastest, 0.004);
    }
  }
}

TEST(PosedFlesh, KeyedParametersMoveTheSurfaceToo) {
  const Arm arm;
  const SolidId id = arm.id("thumb");
  const int bend = arm.flesh.restSolid(id).parameterIndex("bend.angle_rad");
  ASSERT_GE(bend, 0);
  const auto bending = [&](double time_s) {
    return std::vector<Flesh::ParameterOverride>{{id, bend, 0.6 + 5 * time_s, 5}};
  };
  double fastest = 0, unkeyed = 0;
  EXPECT_LT(largestVelocityError(arm, id, arm.moving(), bending, &fastest), 1e-5);
  largestVelocityError(arm, id, arm.moving(), kNoOverrides, &unkeyed);
  EXPECT_GT(std::abs(fastest - unkeyed), 0.01);
}

TEST(PosedFlesh, KeyedParameterReplacesTheDriver) {
  const Arm arm;
  const SolidId id = arm.id("biceps");
  PosedFlesh posed;
  const Flesh::ParameterOverride keyed{id, 0, 0.09, 0};
  arm.pose(arm.moving(), posed, {&keyed, 1});
  EXPECT_EQ(posed.solid(id).parameter(0), 0.09);
  arm.pose(arm.moving(), posed);
  EXPECT_LT(posed.solid(id).parameter(0), 0.07);
}

TEST(PosedFlesh, ParameterHeldAtItsRangeDoesNotMove) {
  const Arm arm;
  const SolidId id = arm.id("bone");
  Posture still = arm.moving();
  still.rates.assign(still.rates.size(), 0.0);
  for (double wanted : {1e9, -1e9, std::nan("")}) {
    PosedFlesh posed;
    const Flesh::ParameterOverride keyed{id, 0, wanted, std::copysign(1e6, wanted)};
    arm.pose(still, posed, {&keyed, 1});
    const Solid& solid = posed.solid(id);
    EXPECT_GE(solid.parameter(0), solid.parameterInfo(0).min);
    EXPECT_LE(solid.parameter(0), solid.parameterInfo(0).max);
    VectorArray point(1), velocity(1);
    posed.velocity(id, view(point, 0, 1), view(velocity, 0, 1));
    EXPECT_EQ(test::at(velocity, 0), Vec3::Zero());
  }
}

TEST(PosedFlesh, BoundsHoldTheSurface) {
  const Arm arm;
  PosedFlesh posed;
  arm.pose(arm.moving(), posed);
  for (SolidId id : allSolids(arm)) {
    const Box box = posed.bounds(id);
    for (const Vec3& p : test::surfacePoints(posed, id)) {
      EXPECT_TRUE((p.array() >= box.low.array() - 1e-12).all());
      EXPECT_TRUE((p.array() <= box.high.array() + 1e-12).all());
    }
    EXPECT_LT(box.size().maxCoeff(), 1.0);
  }
}

// Everything that a caller can see of a posed flesh, to the bit.
std::vector<double> fingerprint(const Arm& arm, const PosedFlesh& posed) {
  std::vector<double> numbers;
  for (SolidId id : allSolids(arm)) {
    for (std::size_t i = 0; i < posed.solid(id).parameterCount(); ++i) {
      numbers.push_back(posed.solid(id).parameter(static_cast<int>(i)));
    }
    const Box box = posed.bounds(id);
    VectorArray point(1), velocity(1);
    point.fill(0.3f);
    posed.velocity(id, view(point, 0, 1), view(velocity, 0, 1));
    for (const Vec3& v : {box.low, box.high, posed.frame(id).translation_m, test::at(velocity, 0),
                          posed.worldFromMaterial(id, {0.01, 0.02, 0.03})}) {
      numbers.insert(numbers.end(), v.begin(), v.end());
    }
  }
  return numbers;
}

TEST(PosedFlesh, DependsOnlyOnItsArgumentsNotOnEarlierCalls) {
  const Arm arm;
  const Flesh::ParameterOverride keyed[] = {{arm.id("thumb"), 0, 0.2, 1},
                                            {arm.id("bone"), 0, 0.1, 2}};
  PosedFlesh fresh, used;
  arm.pose(arm.skeleton.restPosture(), used);
  arm.pose(arm.moving(), used, keyed);
  arm.pose(test::moved(arm.moving(), 0.3), used);
  arm.pose(arm.moving(), used);
  arm.pose(arm.moving(), fresh);
  EXPECT_EQ(fingerprint(arm, fresh), fingerprint(arm, used));
  arm.pose(arm.moving(), used, keyed);
  EXPECT_NE(fingerprint(arm, fresh), fingerprint(arm, used));
}

TEST(PosedFlesh, ServesAnotherFleshAfterTheFirst) {
  const Arm arm;
  FleshDef other = test::armFlesh();
  for (FleshSolidDef& solid : other.solids) {
    solid.solid = test::shape("sphere", {{"radius_m", 0.2}});
    solid.drivers.clear();
  }
  const Arm round(test::armSkeleton(), other);
  PosedFlesh posed;
  arm.pose(arm.moving(), posed);
  round.pose(arm.moving(), posed);
  EXPECT_EQ(posed.solid(SolidId{1}).parameterCount(), 1u);
  EXPECT_EQ(posed.solid(SolidId{1}).parameter(0), 0.2);
}

TEST(PosedFlesh, OutlivesItsFlesh) {
  PosedFlesh posed, expected;
  Arm arm;
  {
    const Arm shortLived;
    shortLived.pose(arm.moving(), posed);
  }
  arm.pose(arm.moving(), expected);
  EXPECT_EQ(fingerprint(arm, posed), fingerprint(arm, expected));
}

}  // namespace
}  // namespace fascia
