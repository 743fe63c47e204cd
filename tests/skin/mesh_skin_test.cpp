#include <gtest/gtest.h>

#include <fascia/base/parallel.h>

#include "mesh_arm.h"

namespace fascia {
namespace {

using test::ArmRun;
using test::MeshArm;

constexpr double kRounding_m = 1e-6;

void stand(Posture&, double) {}

// Bends the elbow to 90° within a second.
ArmRun::Move bend(const MeshArm& arm) {
  return [&arm](Posture& posture, double time_s) {
    arm.valueOf(posture, MeshArm::fore, Dof::rz) = kPi / 2 * std::clamp(time_s, 0.0, 1.0);
  };
}
// Up and down five times a second.
ArmRun::Move shake(const MeshArm& arm) {
  return [&arm](Posture& posture, double time_s) {
    arm.valueOf(posture, MeshArm::upper, Dof::ty) =
        0.15 * std::sin(10 * kPi * std::max(0.0, time_s));
  };
}

std::size_t fixedCount(MeshArm& arm) {
  EXPECT_TRUE(arm.build());
  return arm.skin->fixedPoints().size();
}

// After a second in the rest posture, of the points at least so far from the elbow along the arm.
double farthestFromRest(const MeshArm& arm, double fromElbow_m) {
  ArmRun run(arm, stand);
  run.advance(60);
  const VectorArray& rest = arm.skin->restPosition();
  double farthest = 0;
  for (std::size_t k = 0; k < arm.skin->pointCount(); ++k) {
    if (std::abs(rest.x[k] - MeshArm::kElbow_m) < fromElbow_m) continue;
    farthest = std::max(farthest, (run.place(k) - Vec3(rest.x[k], rest.y[k], rest.z[k])).norm());
  }
  return farthest;
}

TEST(MeshSkin, RestsInItsRestShapeUnderGravity) {
  MeshArm arm;
  ASSERT_TRUE(arm.build());
  ASSERT_GT(arm.skin->points().mass[0], 0);
  EXPECT_LT(farthestFromRest(arm, 0), 1e-4);
}

// The strands' ends lie higher than points may slide.
TEST(MeshSkin, RestsInItsRestShapeOnSoftTissue) {
  MeshArm arm;
  arm.skinDef.tissue.stiffness_N_per_m3 = 2500;
  ASSERT_TRUE(arm.build());
  EXPECT_LT(farthestFromRest(arm, 0.15), 1e-4);  // where one bone carries
}

TEST(MeshSkin, SagsWhenGravityChangesSoThatItIsReallyCarried) {
  MeshArm arm;
  ASSERT_TRUE(arm.build());
  ArmRun run(arm, [&](Posture& posture, double) {
    arm.valueOf(posture, MeshArm::upper, Dof::rz) = kPi;  // upside down
  });
  run.advance(60);
  VectorArray carried = run.state.position;
  arm.skin->attachment().makePlacer()->placeAll(run.at(1), carried);
  double farthest = 0;
  for (std::size_t k = 0; k < arm.skin->pointCount(); ++k)
    farthest = std::max<double>(farthest, std::abs(carried.y[k] - run.state.position.y[k]));
  EXPECT_GT(farthest, 5e-4);
}

TEST(MeshSkin, BendsWithoutTearing) {
  MeshArm arm;
  ASSERT_TRUE(arm.build());
  ArmRun run(arm, bend(arm));
  run.advance(75, [&] { ASSERT_TRUE(run.finite()); });
  EXPECT_LT(run.stats.max_edge_stretch, 2.5);
  EXPECT_EQ(run.stats.repaired_points, 0u);
  // It went along: the wrist's points are where the forearm's frame carries them.
  const Vec3 wrist(MeshArm::kElbow_m, MeshArm::kLength_m - MeshArm::kElbow_m, 0);
  double nearest = 1;
  for (std::size_t k = 0; k < arm.skin->pointCount(); ++k)
    nearest = std::min(nearest, (run.place(k) - wrist).norm());
  EXPECT_LT(nearest, 0.01);
}

TEST(MeshSkin, IsTheSameOnAnyNumberOfThreads) {
  MeshArm arm(96, 64);  // more points than one task takes
  ASSERT_TRUE(arm.build());
  ASSERT_GT(arm.skin->pointCount(), 4096u);
  const auto hashOn = [&](int threads) {
    const ThreadLimit limit(threads);
    ArmRun run(arm, [&](Posture& p, double t) { bend(arm)(p, 3 * t); });
    run.advance(12);
    return run.hash();
  };
  const std::uint64_t one = hashOn(1);
  EXPECT_EQ(one, hashOn(2));
  ArmRun still(arm, stand);
  still.advance(1);
  EXPECT_NE(one, still.hash());
}

TEST(MeshSkin, GoesOnFromACopyOfItsState) {
  MeshArm arm;
  ASSERT_TRUE(arm.build());
  ArmRun run(arm, bend(arm));
  run.advance(30);
  const SkinState copy = run.state;
  run.advance(20);
  const std::uint64_t straight = run.hash();
  // A new workspace knows nothing of what the first one remembers of solids and gaps.
  ArmRun other(arm, bend(arm));
  other.advance(30);
  other.state = copy;
  other.workspace = SkinWorkspace();
  other.advance(20);
  EXPECT_EQ(other.hash(), straight);
}

TEST(MeshSkin, CarriesSmallPiecesExactly) {
  MeshArm arm;
  ASSERT_TRUE(arm.build());
  ASSERT_EQ(arm.skin->fixedPoints().size(), 6u);  // the bead
  ArmRun run(arm, [&](Posture& posture, double time_s) {
    bend(arm)(posture, time_s);
    shake(arm)(posture, time_s);
  });
  run.advance(30, [&] {
    const Transform& fore = run.posedSkeleton.joint_world[MeshArm::fore];
    for (const std::size_t k : arm.skin->fixedPoints()) {
      const Vec3 rest(arm.skin->restPosition().x[k], arm.skin->restPosition().y[k],
                      arm.skin->restPosition().z[k]);
      const Vec3 expected = fore.point(rest - Vec3(MeshArm::kElbow_m, 0, 0));
      EXPECT_LT((run.place(k) - expected).norm(), kRounding_m);
    }
  });
}

TEST(MeshSkin, CarriesBordersExactly) {
  constexpr int kAround = 24;
  MeshArm arm(kAround, 40, true);
  ASSERT_TRUE(arm.build());
  ASSERT_EQ(arm.skin->fixedPoints().size(), kAround + 6u);  // the open end and the bead
  ArmRun run(arm, bend(arm));
  run.advance(30);
  VectorArray carried = run.state.position;
  arm.skin->attachment().makePlacer()->placeAll(run.at(30 * ArmRun::kFrame_s), carried);
  for (const std::size_t k : arm.skin->fixedPoints())
    EXPECT_LT((run.place(k) - Vec3(carried.x[k], carried.y[k], carried.z[k])).norm(), kRounding_m);
}

TEST(MeshSkin, MakesPartsRigidOrElasticAsTheFileSays) {
  MeshArm arm;
  const std::size_t all = arm.rig.points_m.size();
  arm.skinDef.mesh.parts = {{"bead", false}};
  EXPECT_EQ(fixedCount(arm), 0u);
  arm.skinDef.mesh.parts = {{"arm", true}};
  EXPECT_EQ(fixedCount(arm), all);
  arm.skinDef.mesh.parts = {{"glass", false}};  // the bead's material
  EXPECT_EQ(fixedCount(arm), 0u);
  arm.skinDef.mesh.parts = {{"arm", true}, {"arm", false}};  // later rules win
  EXPECT_EQ(fixedCount(arm), 6u);
}

TEST(MeshSkin, MovesEveryPointByItsJointsIfAllAreRigid) {
  MeshArm arm;
  arm.skinDef.mesh.parts = {{"arm", true}};
  ASSERT_TRUE(arm.build());
  ArmRun run(arm, bend(arm));
  run.advance(10);
  VectorArray carried = run.state.position;
  arm.skin->attachment().makePlacer()->placeAll({&run.posedFlesh, run.posedSkeleton.joint_world},
                                                carried);
  EXPECT_EQ(carried.x, run.state.position.x);
  EXPECT_EQ(carried.y, run.state.position.y);
}

TEST(MeshSkin, IsCarriedByItsJointsAloneWithoutFlesh) {
  MeshArm arm;
  arm.fleshDef.solids.clear();
  EXPECT_EQ(fixedCount(arm), arm.rig.points_m.size());
}

TEST(MeshSkin, SlidesOnlySoFarHoweverHardItIsShaken) {
  MeshArm arm;
  ASSERT_TRUE(arm.build());
  const FloatArray& limit = arm.skin->points().slideLimit;
  ASSERT_EQ(limit.size(), arm.skin->pointCount() - 6);
  ArmRun run(arm, shake(arm));
  double farthest = 0;
  run.advance(60, [&] {
    ASSERT_TRUE(run.finite());
    const VectorArray& anchor = run.state.surroundings.anchor;
    for (std::size_t k = 0; k < limit.size(); ++k) {
      const Vec3 from(anchor.x[k], anchor.y[k], anchor.z[k]);
      farthest = std::max(farthest, (run.place(k) - from).norm() / double{limit[k]});
    }
  });
  EXPECT_GT(farthest, 0.99);  // the limit is reached
  EXPECT_LT(farthest, 1.2);
  EXPECT_LT(run.stats.max_edge_stretch, 3);
  EXPECT_EQ(run.stats.repaired_points, 0u);
}

TEST(MeshSkin, JumpsWithABodyThatIsTeleported) {
  MeshArm arm;
  ASSERT_TRUE(arm.build());
  ArmRun run(arm, [&](Posture& posture, double time_s) {
    const bool away = time_s > 10.5 * ArmRun::kFrame_s;
    arm.valueOf(posture, MeshArm::upper, Dof::tx) = away ? 5 : 0;
    arm.valueOf(posture, MeshArm::upper, Dof::rz) = away ? 2 : 0;
  });
  run.advance(10);
  EXPECT_EQ(run.stats.repaired_points, 0u);
  run.advance(5, [&] { ASSERT_TRUE(run.finite()); });
  EXPECT_EQ(run.stats.repaired_points, arm.skin->pointCount());
  EXPECT_LT(run.stats.max_edge_stretch, 1.5);
  Box box;
  for (std::size_t k = 0; k < arm.skin->pointCount(); ++k) box.add(run.place(k));
  EXPECT_GT(box.low.x(), 4);
}

// --- Not simulated: the pose function alone.

MeshArm posedArm() {
  MeshArm arm;
  arm.skinDef.mesh.pose.simulate = false;
  EXPECT_TRUE(arm.build());
  return arm;
}

TEST(PosedSkin, IsWhereItsPoseFunctionHasItAndNothingElse) {
  MeshArm arm;
  arm.skinDef.mesh.pose.simulate = false;
  arm.skinDef.mesh.pose.jiggle = 0;
  ASSERT_TRUE(arm.build());
  ASSERT_FALSE(arm.skin->isSimulated());
  ArmRun run(arm, bend(arm));
  run.advance(40);
  VectorArray placed = run.state.position;
  arm.skin->attachment().makePlacer()->placeAll(run.at(40 * ArmRun::kFrame_s), placed);
  EXPECT_EQ(placed.x, run.state.position.x);
  EXPECT_EQ(placed.y, run.state.position.y);
  EXPECT_EQ(run.stats.repaired_points, 0u);
}

TEST(PosedSkin, SwingsBehindAShakeByItsDial) {
  const auto swing = [&](double dial) {
    MeshArm arm;
    arm.skinDef.mesh.pose.simulate = false;
    arm.skinDef.mesh.pose.jiggle = dial;
    EXPECT_TRUE(arm.build());
    ArmRun run(arm, shake(arm));
    VectorArray placed = run.state.position;
    double most = 0;
    for (int f = 1; f <= 40; ++f) {
      run.advance(1);
      arm.skin->attachment().makePlacer()->placeAll(run.at(f * ArmRun::kFrame_s), placed);
      for (std::size_t k = 0; k < arm.skin->pointCount(); ++k)
        most = std::max<double>(most, std::abs(placed.y[k] - run.state.position.y[k]));
    }
    return most;
  };
  EXPECT_EQ(swing(0), 0);
  EXPECT_GT(swing(0.25), 0.002);
  EXPECT_GT(swing(0.75), 1.5 * swing(0.25));
}

TEST(PosedSkin, StartsItsJiggleAnewAfterAJump) {
  const MeshArm arm = posedArm();
  ArmRun run(arm, [&](Posture& posture, double time_s) {
    arm.valueOf(posture, MeshArm::upper, Dof::tx) = time_s > 5.5 * ArmRun::kFrame_s ? 5 : 0;
  });
  run.advance(5);
  run.advance(5, [&] {
    ASSERT_TRUE(run.finite());
    Box box;
    for (std::size_t k = 0; k < arm.skin->pointCount(); ++k) box.add(run.place(k));
    EXPECT_LT(box.size().x(), MeshArm::kLength_m + 1e-4);
  });
}

TEST(PosedSkin, DialsDifferByRegionJointAndPoint) {
  const auto jiggleOf = [](MeshArm& arm) {
    arm.skinDef.mesh.pose.simulate = false;
    EXPECT_TRUE(arm.build());
    return arm.skin->rigged()->skin->jiggle().nodeCount();
  };
  MeshArm all, upper, none, painted;
  const std::size_t everywhere = jiggleOf(all);
  SkinRegionDef region;
  region.name = "still";
  region.joint = "fore";
  region.edits = {{SkinQuantity::jiggle, SkinRegionDef::Edit::Mode::set, 0}};
  upper.skinDef.regions = {region};
  const std::size_t half = jiggleOf(upper);
  EXPECT_GT(half, 0u);
  EXPECT_LT(half, everywhere);
  none.skinDef.mesh.pose.jiggle = 0;
  EXPECT_EQ(jiggleOf(none), 0u);
  painted.skinDef.points.emplace().jiggle.edit().assign(painted.rig.points_m.size(), 0.f);
  EXPECT_EQ(jiggleOf(painted), 0u);
}

TEST(PosedSkin, NamesAJointThatTheRigLacks) {
  MeshArm arm;
  SkinRegionDef region;
  region.name = "still";
  region.joint = "tail";
  arm.skinDef.regions = {region};
  EXPECT_FALSE(arm.build());
  ASSERT_EQ(arm.diagnostics.errors().size(), 1u);
  EXPECT_EQ(arm.diagnostics.errors()[0].where.pointer, "/skin/regions/0/joint");
}

void expectError(MeshArm& arm, const std::string& pointer, const std::string& what) {
  EXPECT_FALSE(arm.build());
  ASSERT_EQ(arm.diagnostics.errors().size(), 1u);
  const Issue& issue = arm.diagnostics.errors()[0];
  EXPECT_EQ(issue.where.pointer, pointer);
  EXPECT_NE(issue.text().find(what), std::string::npos) << issue.text();
}

TEST(MeshSkinFaults, NameAPartThatTheMeshLacks) {
  MeshArm arm;
  arm.skinDef.mesh.parts = {{"bead", true}, {"toe", true}};
  expectError(arm, "/skin/parts/1/name", "'toe'");
}

TEST(MeshSkinFaults, NameAJointThatTheSkeletonLacks) {
  MeshArm arm;
  arm.rig.joints[1].name = "forearm";
  expectError(arm, "/skin", "'forearm'");
}

TEST(MeshSkinFaults, NameASolidThatTheFleshLacks) {
  MeshArm arm;
  SkinRegionDef region;
  region.name = "soft";
  region.solid = "fort";
  arm.skinDef.regions = {region};
  expectError(arm, "/skin/regions/0/solid", "did you mean 'fore'");
}

TEST(MeshSkinFaults, RefuseRegionsByCoordinatesThatAMeshLacks) {
  MeshArm arm;
  SkinRegionDef region;
  region.name = "half";
  region.u_max = 0.5;
  arm.skinDef.regions = {region};
  EXPECT_FALSE(arm.build());
  ASSERT_EQ(arm.diagnostics.errors().size(), 1u);
  EXPECT_EQ(arm.diagnostics.errors()[0].where.pointer.find("/skin/regions/0"), 0u);
}

TEST(MeshSkinFaults, CountTheValuesOfPointLists) {
  MeshArm arm;
  arm.skinDef.points.emplace();
  arm.skinDef.points->fat.edit().assign(3, 0.01f);
  expectError(arm, "/skin/points/fat_m",
              "found 3 values, expected " + std::to_string(arm.rig.points_m.size()));
}

TEST(MeshSkinFaults, RefuseAnchorsOfTheirOwn) {
  MeshArm arm;
  arm.skinDef.points.emplace();
  arm.skinDef.points->anchor.edit().resize(arm.rig.points_m.size());
  expectError(arm, "/skin/points", "found anchors");
}

}  // namespace
}  // namespace fascia
