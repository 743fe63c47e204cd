#include <cmath>

#include <gtest/gtest.h>

#include "body.h"
#include "mesh_arm.h"

namespace fascia {
namespace {

using test::ArmRun;
using test::at;
using test::Body;
using test::MeshArm;

constexpr double kSolid_m = 0.15, kShrinking_m = 0.01, kFatOfBall_m = 0.02;

// A solid ball under fat that shrinks as a run begins: its skin follows as far as strands pull it
// and the fat's volume lets it.
class ShrinkingBall final : public SkinPoseSource {
 public:
  ShrinkingBall(double bulk_Pa, double tissue_N_per_m3) : tissue_N_per_m3_(tissue_N_per_m3) {
    body_.fleshDef.solids = {test::ball("ball", "hip", Vec3::Zero(), kSolid_m)};
    SkinDef& def = body_.skinDef;
    def.grid.bottom = def.grid.top = {};
    def.surface = SkinSurfaceDef{.edge_m = 0.03};
    def.fat = {.thickness_m = kFatOfBall_m, .bulk_Pa = bulk_Pa};
    def.tissue.stiffness_N_per_m3 = tissue_N_per_m3;
    def.tissue.damping_Ns_per_m3 = 400;
    def.material.stretch_u_N_per_m = def.material.stretch_v_N_per_m = 1e-3;
    def.material.shear_N_per_m = 0;
    def.material.prestretch = 1;
    def.material.drag_Ns_per_m3 = 40;  // strands swing to and fro across themselves
    body_.settings.gravity_m_per_s2.setZero();
    EXPECT_TRUE(body_.build());
    placeSkin(*body_.skin, body_.skinPose(), state_);
  }
  SkinPose at(double) override {
    const Flesh::ParameterOverride smaller{SolidId(0), 0, kSolid_m - kShrinking_m, 0};
    body_.flesh.pose(body_.skeleton.restPosture(), body_.posedSkeleton, {&smaller, 1},
                     body_.posedFlesh);
    return body_.skinPose();
  }
  void run(double duration_s, double rate_per_s) {
    for (int i = 0; i < std::lround(duration_s * rate_per_s); ++i, ++frame_)
      advanceSkin(*body_.skin, *this, frame_ / rate_per_s, (frame_ + 1) / rate_per_s, state_,
                  workspace_, stats_);
  }
  // From the ball's centre.
  double radius_m(std::size_t k) const {
    return (test::at(state_.position, k) - body_.posedSkeleton.joint_world[0].translation_m).norm();
  }
  std::size_t pointCount() const { return body_.skin->pointCount(); }
  double meanRadius_m() const {
    double sum = 0;
    for (std::size_t k = 0; k < pointCount(); ++k) sum += radius_m(k);
    return sum / static_cast<double>(pointCount());
  }
  // How much longer strands are than at rest.
  double stretch_m() const { return meanRadius_m() - (kSolid_m - kShrinking_m) - kFatOfBall_m; }
  double stretch_m(std::size_t k) const { return stretch_m() + radius_m(k) - meanRadius_m(); }
  // Over V0. Volumes are in units of 4π/3.
  double volumeChange() const {
    const double rest = cube(kSolid_m + kFatOfBall_m) - cube(kSolid_m);
    return (cube(meanRadius_m()) - cube(kSolid_m - kShrinking_m)) / rest - 1;
  }
  // What the strands bear, for they alone hold it.
  double pressure_Pa() const {
    const double wider = meanRadius_m() / (kSolid_m + kFatOfBall_m);
    return tissue_N_per_m3_ * stretch_m() / (wider * wider);
  }
  double fastest_m_per_s() const {
    double most = 0;
    for (std::size_t k = 0; k < pointCount(); ++k)
      most = std::max(most, test::at(state_.velocity, k).norm());
    return most;
  }
  const SkinStats& stats() const { return stats_; }

 private:
  static double cube(double x) { return x * x * x; }

  Body body_;
  double tissue_N_per_m3_;
  SkinState state_;
  SkinWorkspace workspace_;
  SkinStats stats_;
  int frame_ = 0;
};

TEST(FatOnFlesh, ResistsAsItsBulkModulusSaysAtEveryRate) {
  for (const double bulk_Pa : {1e3, 1e4, 4e4}) {
    for (const double rate_per_s : {30.0, 60.0, 120.0, 240.0}) {
      SCOPED_TRACE(testing::Message() << bulk_Pa << " Pa, " << rate_per_s << " Hz");
      ShrinkingBall ball(bulk_Pa, 0.5 * bulk_Pa / kFatOfBall_m);
      ball.run(2, rate_per_s);
      ASSERT_GT(ball.stretch_m(), 1e-4);
      ASSERT_LT(ball.volumeChange(), -0.02);
      const double found_Pa = -ball.pressure_Pa() / ball.volumeChange();
      EXPECT_NEAR(found_Pa / bulk_Pa, 1, 0.05);
      for (std::size_t k = 0; k < ball.pointCount(); ++k)
        ASSERT_NEAR(ball.stretch_m(k) / ball.stretch_m(), 1, 0.02);
      EXPECT_LT(ball.fastest_m_per_s(), 1e-3);
      EXPECT_EQ(ball.stats().repaired_points, 0u);
    }
  }
}

MeshArm armOfFat(double bulk_Pa, double gravity_m_per_s2) {
  MeshArm arm;
  arm.skinDef.fat.bulk_Pa = bulk_Pa;
  arm.settings.gravity_m_per_s2 = Vec3(0, -gravity_m_per_s2, 0);
  EXPECT_TRUE(arm.build());
  return arm;
}

// Frames of 1/30 s; returns how fast the fastest point goes relative to its flesh.
double runSlowly(const MeshArm& arm, ArmRun& run, int first, int count) {
  double fastest = 0;
  for (int f = first; f < first + count; ++f) {
    advanceSkin(*arm.skin, run, f / 30.0, (f + 1) / 30.0, run.state, run.workspace, run.stats);
    for (std::size_t k = 0; k < arm.skin->pointCount(); ++k)
      fastest = std::max(
          fastest,
          (at(run.state.velocity, k) - at(run.state.surroundings.anchorVelocity, k)).norm());
  }
  return fastest;
}

double farthestFromCarried(const MeshArm& arm, ArmRun& run, double time_s) {
  VectorArray carried = run.state.position;
  arm.skin->attachment().makePlacer()->placeAll(run.at(time_s), carried);
  double farthest = 0;
  for (std::size_t k = 0; k < arm.skin->pointCount(); ++k)
    farthest = std::max(farthest, (at(run.state.position, k) - at(carried, k)).norm());
  return farthest;
}

TEST(FatOnFlesh, IsWithoutPressureWhereNothingLoadsIt) {
  const MeshArm arm = armOfFat(4e4, 0);
  ASSERT_NE(arm.skin->fatPressure(), nullptr);
  ASSERT_EQ(arm.skin->fatPressure()->layers.size(), 2u);
  for (const double angle : {0.0, 1.2}) {
    ArmRun run(arm, [&](Posture& posture, double) {
      arm.valueOf(posture, MeshArm::upper, Dof::rz) = angle;
    });
    EXPECT_LT(runSlowly(arm, run, 0, 30), 1e-4);
    EXPECT_LT(farthestFromCarried(arm, run, 1), 1e-5);
  }
}

// In three seconds after one of shaking and bending.
TEST(FatOnFlesh, ComesToRestAsSoonAsSkinWithoutIt) {
  double without = 0;
  for (const double bulk_Pa : {0.0, 1e3, 4e4, 1e5}) {
    const MeshArm arm = armOfFat(bulk_Pa, 9.81);
    ArmRun run(arm, [&](Posture& posture, double time_s) {
      const double swing = time_s > 0 && time_s < 1 ? std::sin(10 * kPi * time_s) : 0;
      arm.valueOf(posture, MeshArm::upper, Dof::ty) = 0.15 * swing;
      arm.valueOf(posture, MeshArm::fore, Dof::rz) = kPi / 2 * std::clamp(time_s, 0.0, 1.0);
    });
    EXPECT_GT(runSlowly(arm, run, 0, 30), 0.1);
    runSlowly(arm, run, 30, 90);
    const double still = runSlowly(arm, run, 120, 1);
    if (bulk_Pa == 0) without = still;
    EXPECT_LT(still, 1.5 * without + 1e-4) << bulk_Pa << " Pa";
    EXPECT_EQ(run.stats.repaired_points, 0u);
  }
}

}  // namespace
}  // namespace fascia
