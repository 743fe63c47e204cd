#include <gtest/gtest.h>

#include <fascia/base/error.h>

#include "puppets.h"

namespace fascia {
namespace {

using test::PuppetStage;

constexpr BodyScheme kSchemes[] = {BodyScheme::explicitEuler, BodyScheme::implicitEuler,
                                   BodyScheme::energyConserving};

double stepOf(BodyScheme scheme) {
  return scheme == BodyScheme::explicitEuler ? 1.0 / 4800 : PuppetStage::kStep_s;  // stable
}

TEST(Chase, MeetsATargetOfConstantVelocityInPlaceAndFinalVelocity) {
  for (const BodyScheme scheme : kSchemes) {
    for (const int dimension : {2, 3}) {
      PuppetStage stage(dimension, 2, scheme);
      stage.setVelocity(0, Vec3(-1, 0.5, 0)), stage.setVelocity(1, Vec3(0.4, 0.8, 0));
      const Vec3 final(2, -1, 0);
      const BehaviourId chase =
          stage.puppet->run(makeChase(stage["right 0"], stage["middle 1"],
                                      {.duration_s = 0.5, .finalVelocity_m_per_s = final}));
      stage.stepUntil(0.5, stepOf(scheme));
      EXPECT_TRUE(stage.puppet->running(chase));
      stage.puppet->update(PuppetStage::kStep_s);
      EXPECT_FALSE(stage.puppet->running(chase));
      EXPECT_LT((stage.position("right 0") - stage.position("middle 1")).norm(), 1e-9);
      EXPECT_LT((stage.velocity("right 0") - final).norm(), 1e-9);
      EXPECT_FALSE(stage.puppet->controlled(stage["right 0"]));
    }
  }
}

TEST(Chase, IsThePlannedCubicAllTheWay) {
  PuppetStage stage(3, 2);
  stage.setVelocity(0, Vec3(0, 1, 0)), stage.setVelocity(1, Vec3(0.4, 0.8, 0));
  const Vec3 start = stage.position("right 0"),
             end = stage.position("middle 1") + 0.4 * Vec3(0.4, 0.8, 0);
  const Vec3 final(2, -1, 0);
  const CubicSegment plan(0, start, Vec3(0, 1, 0), 0.4, end, final);
  stage.puppet->run(makeChase(stage["right 0"], stage["middle 1"],
                              {.duration_s = 0.4, .finalVelocity_m_per_s = final}));
  for (int i = 0; i < 24; ++i) {
    stage.step();
    EXPECT_LT((stage.position("right 0") - plan.at(stage.state.t_s).position_m).norm(), 1e-9) << i;
  }
}

TEST(Chase, MissesAnAcceleratedTargetByItsAccelerationOverOneStepOnly) {
  // The last plan is a step old: it is off by a h².
  for (const double h : {1.0 / 60, 1.0 / 240}) {
    PuppetStage stage(3, 2, BodyScheme::implicitEuler, Vec3(0, -9.81, 0));
    stage.setVelocity(1, Vec3(0.2, 3, 0));
    stage.puppet->run(makeChase(stage["right 0"], stage["middle 1"], {.duration_s = 0.5}));
    stage.stepUntil(0.5, h);
    const double miss = stage.puppet->distance_m(stage["right 0"], stage["middle 1"]);
    EXPECT_NEAR(miss, 9.81 * h * h, 1e-3 * h * h);
  }
}

TEST(Chase, ArrivesByDefaultWithoutAccelerationWhateverTheFrame) {
  const auto arrival = [](const Vec3& frame) {
    PuppetStage stage(3, 2);
    stage.setVelocity(0, Vec3(0, 1, 0) + frame), stage.setVelocity(1, Vec3(0.4, 0.8, 0) + frame);
    stage.puppet->run(makeChase(stage["right 0"], stage["middle 1"], {.duration_s = 0.5}));
    stage.stepUntil(0.5);
    stage.puppet->update(PuppetStage::kStep_s);
    EXPECT_LT(stage.puppet->distance_m(stage["right 0"], stage["middle 1"]), 1e-9);
    return Vec3(stage.velocity("right 0") - frame);
  };
  // v = v_target + (3/2) d/T − u/2 with d = (0.8, 0, 0) and u = (−0.4, 0.2, 0).
  const Vec3 expected = Vec3(0.4, 0.8, 0) + 1.5 * Vec3(0.8, 0, 0) / 0.5 - 0.5 * Vec3(-0.4, 0.2, 0);
  EXPECT_LT((arrival(Vec3::Zero()) - expected).norm(), 1e-9);
  EXPECT_LT((arrival(Vec3(3, -2, 1)) - expected).norm(), 1e-9);
}

TEST(Chase, EndsWithTheStepInWhichItsTimeIsOver) {
  PuppetStage stage(3, 2);
  stage.setVelocity(1, Vec3(0, 0.7, 0));
  const BehaviourId chase =
      stage.puppet->run(makeChase(stage["right 0"], stage["left 1"], {.duration_s = 0.21}));
  stage.stepUntil(0.3, 0.05);
  EXPECT_FALSE(stage.puppet->running(chase));
  PuppetStage other(3, 2);
  other.setVelocity(1, Vec3(0, 0.7, 0));
  other.puppet->run(makeChase(other["right 0"], other["left 1"], {.duration_s = 0.21}));
  other.stepUntil(0.25, 0.05);
  EXPECT_LT(other.puppet->distance_m(other["right 0"], other["left 1"]), 1e-9);
}

TEST(Chase, KeepsOneConstraintAllTheWay) {
  PuppetStage stage(3, 2);
  stage.puppet->run(makeChase(stage["right 0"], stage["left 1"], {.duration_s = 1}));
  stage.step();
  const int version = stage.system->constraintVersion();
  stage.stepUntil(0.9);
  EXPECT_EQ(stage.system->constraintVersion(), version);
}

TEST(Chase, FailsWhenANewerControlTakesItsPoint) {
  PuppetStage stage(3, 2);
  bool arrived = false;
  const auto id =
      stage.puppet->run(sequence(makeChase(stage["right 0"], stage["left 1"], {.duration_s = 0.5}),
                                 makeWaitFor([&](const Puppet&) { return arrived = true; })));
  stage.stepUntil(0.2);
  stage.puppet->hold(stage["right 0"]);
  stage.stepUntil(1);
  EXPECT_FALSE(stage.puppet->running(id));
  EXPECT_FALSE(arrived);
}

TEST(Chase, LetsGoWhenCancelled) {
  PuppetStage stage(3, 2);
  const auto id =
      stage.puppet->run(makeGrab(stage["right 0"], stage["left 1"], {.duration_s = 0.5}));
  stage.stepUntil(0.25);
  EXPECT_TRUE(stage.puppet->controlled(stage["right 0"]));
  const Vec3 momentum = stage.system->model().momentum_Ns(stage.state.v);
  stage.puppet->cancel(id);
  EXPECT_FALSE(stage.puppet->running(id));
  EXPECT_FALSE(stage.puppet->controlled(stage["right 0"]));
  stage.stepUntil(1);
  EXPECT_EQ(stage.puppet->connectionCount(), 0u);
  EXPECT_LT((stage.system->model().momentum_Ns(stage.state.v) - momentum).norm(), 1e-9) << "free";
}

TEST(Grab, TiesWhatItHasReached) {
  for (const BodyScheme scheme : kSchemes) {
    PuppetStage stage(2, 2, scheme, Vec3(0, -9.81, 0));
    stage.setVelocity(1, Vec3(0, 4, 0));
    stage.puppet->run(makeGrab(stage["right 0"], stage["left 1"], {.duration_s = 0.5}));
    stage.stepUntil(0.5, stepOf(scheme));
    stage.puppet->update(PuppetStage::kStep_s);
    EXPECT_TRUE(stage.puppet->connected(stage["right 0"], stage["left 1"]));
    EXPECT_LT((stage.velocity("right 0") - stage.velocity("left 1")).norm(), 1e-9);
    stage.stepUntil(1, stepOf(scheme));
    EXPECT_LT(stage.puppet->distance_m(stage["right 0"], stage["left 1"]), 1e-9);
  }
}

TEST(Grab, HangsItselfUpAtAPlace) {
  PuppetStage stage(2, 1, BodyScheme::implicitEuler, Vec3(0, -9.81, 0));
  stage.puppet->run(makeGrab(stage["left 0"], stage["post"], {.duration_s = 0.5}));
  stage.stepUntil(2);
  EXPECT_LT(stage.puppet->distance_m(stage["left 0"], stage["post"]), 1e-9);
}

TEST(Move, HoldsAtRestAndLetsGoInFlight) {
  PuppetStage stage(3, 2, BodyScheme::implicitEuler, Vec3(0, -9.81, 0));
  const Vec3 place(0.3, 0.5, 0.2);
  stage.puppet->run(
      parallel(makeMove(stage["left 0"], place, {.duration_s = 0.4}),
               makeMove(stage["left 1"], place,
                        {.duration_s = 0.4, .finalVelocity_m_per_s = Vec3(0, 1, 0)})));
  stage.stepUntil(0.5);
  EXPECT_FALSE(stage.puppet->controlled(stage["left 1"]));
  const double rising = stage.velocity("middle 1").y();
  stage.stepUntil(1);
  EXPECT_NEAR(stage.velocity("middle 1").y(), rising - 0.5 * 9.81, 1e-6);
  EXPECT_LT((stage.position("left 0") - place).norm(), 1e-9);
  EXPECT_LT(stage.velocity("left 0").norm(), 1e-9);
}

KeyframedPath somePath() {
  return KeyframedPath({{0, Vec3(0, 1, 0), Vec3(1, 0, 0), {}},
                        {0.5, Vec3(1, 1, 0), Vec3(1, 1, 0), Vec3(0, -1, 0)},
                        {1, Vec3(1, 0, 0), {}, Vec3(2, 0, 0)}});
}

TEST(Follow, PrerollsFromPlaceAndVelocityToThePath) {
  for (const int dimension : {2, 3}) {
    PuppetStage stage(dimension, 1, BodyScheme::implicitEuler);
    stage.setVelocity(0, Vec3(0, -1, 0));
    const Vec3 start = stage.position("left 0");
    const CubicSegment preroll(0, start, Vec3(0, -1, 0), 0.3, Vec3(0, 1, 0), Vec3(1, 0, 0));
    stage.puppet->run(makeFollow(stage["left 0"], somePath(), {.preroll_s = 0.3}));
    while (stage.state.t_s < 1.29) {
      stage.step();
      const double t = stage.state.t_s;
      const Vec3 expected = t < 0.3 ? preroll.at(t).position_m : somePath().at(t - 0.3).position_m;
      EXPECT_LT((stage.position("left 0") - expected).norm(), 1e-9) << t;
    }
  }
}

TEST(Follow, MakesVelocityJumpsByImpulsesAndEndsBallistic) {
  PuppetStage stage(3, 1);
  stage.puppet->run(makeFollow(stage["left 0"], somePath(), {.preroll_s = 0.25}));
  stage.stepUntil(0.75);
  stage.puppet->update(PuppetStage::kStep_s);
  EXPECT_LT((stage.velocity("left 0") - Vec3(0, -1, 0)).norm(), 1e-9) << "after the jump";
  stage.stepUntil(1.25);
  stage.puppet->update(PuppetStage::kStep_s);
  EXPECT_LT((stage.velocity("left 0") - Vec3(2, 0, 0)).norm(), 1e-9) << "out of the last key";
  EXPECT_FALSE(stage.puppet->controlled(stage["left 0"]));
}

TEST(Follow, LeavesThePointFreeUntilThePrerollBeforeItsOnset) {
  PuppetStage stage(3, 1);
  stage.setVelocity(0, Vec3(0, -1, 0));
  stage.puppet->run(makeFollow(stage["left 0"], somePath(), {.preroll_s = 0.25, .onset_s = 1}));
  stage.stepUntil(0.75);
  EXPECT_FALSE(stage.puppet->controlled(stage["left 0"]));
  EXPECT_LT((stage.position("left 0") - Vec3(-0.2, -0.75, 0)).norm(), 1e-9);
  stage.stepUntil(1.25);
  EXPECT_LT((stage.position("left 0") - somePath().at(0.25).position_m).norm(), 1e-9);
}

TEST(Follow, HoldsThePointWhereThePathEndsAtRest) {
  PuppetStage stage(3, 1, BodyScheme::implicitEuler, Vec3(0, -9.81, 0));
  const KeyframedPath path({{0, Vec3(0, 1, 0), {}, {}}, {0.5, Vec3(1, 1, 0), {}, {}}});
  const auto id = stage.puppet->run(makeFollow(stage["left 0"], path));
  stage.stepUntil(2);
  EXPECT_FALSE(stage.puppet->running(id));
  EXPECT_LT((stage.position("left 0") - Vec3(1, 1, 0)).norm(), 1e-9);
}

TEST(Follow, ClosesTheGapOfAPathThatItHasToJoinAtOnce) {
  PuppetStage stage(3, 1);
  const KeyframedPath path({{0, Vec3(0, 1, 0), {}, {}}, {1, Vec3(1, 1, 0), {}, {}}});
  stage.puppet->run(makeFollow(stage["left 0"], path, {.preroll_s = 0}));
  Vec3 before = stage.position("left 0");
  for (int i = 0; i < 6; ++i) {
    stage.step();
    EXPECT_LT((stage.position("left 0") - before).norm(), 0.35) << "a jump";
    before = stage.position("left 0");
  }
  EXPECT_LT((before - path.at(0.1).position_m).norm(), 1e-9);
}

// Behaviours that write down when they act.
BehaviourPtr note(std::string& log, const char* what) {
  return makeWaitFor([&log, what](const Puppet&) {
    log += what;
    return true;
  });
}

TEST(Parallel, ActsInItsOrderAndWaitsForTheSlowest) {
  PuppetStage stage;
  std::string log;
  stage.puppet->run(sequence(parallel(sequence(makeWait(0.1), note(log, "a")), note(log, "b"),
                                      sequence(makeWait(0.1), note(log, "c"))),
                             note(log, "d")));
  stage.stepUntil(0.08);
  EXPECT_EQ(log, "b");
  stage.stepUntil(0.2);
  EXPECT_EQ(log, "bacd");
}

TEST(Sequence, GoesOnWithinTheSameStep) {
  PuppetStage stage;
  double time = -1;
  stage.puppet->run(sequence(makeWait(0.25), makeHold(stage["left 0"]), makeStop(stage["left 0"]),
                             makeRelease(stage["left 0"]), makeWaitFor([&](const Puppet& puppet) {
                               time = puppet.time_s();
                               return true;
                             })));
  stage.stepUntil(1, 0.05);
  EXPECT_NEAR(time, 0.25, 1e-12);
}

TEST(WaitFor, GivesUpAfterItsTime) {
  PuppetStage stage;
  std::string log;
  const auto id = stage.puppet->run(
      sequence(makeWaitFor([](const Puppet&) { return false; }, 0.25), note(log, "a")));
  stage.stepUntil(0.2, 0.05);
  EXPECT_TRUE(stage.puppet->running(id));
  stage.stepUntil(0.3, 0.05);
  EXPECT_FALSE(stage.puppet->running(id));
  EXPECT_EQ(log, "");
}

TEST(Behaviours, RefuseNumbersOutOfRange) {
  const PuppetPointId point(0);
  EXPECT_THROW(makeChase(point, Vec3(0, 0, 0), {.duration_s = 0}), Error);
  EXPECT_THROW(makeGrab(point, Vec3(0, 0, 0), {.duration_s = std::nan("")}), Error);
  EXPECT_THROW(makeMove(point, Vec3::Zero(), {.finalVelocity_m_per_s = Vec3(std::nan(""), 0, 0)}),
               Error);
  EXPECT_THROW(makeFollow(point, somePath(), {.preroll_s = -1}), Error);
  EXPECT_THROW(makeFollow(point, somePath(), {.onset_s = std::nan("")}), Error);
  EXPECT_THROW(makeWait(-1), Error);
  EXPECT_THROW(makeWaitFor({}), Error);
  EXPECT_THROW(makeWaitFor([](const Puppet&) { return true; }, -1), Error);
}

}  // namespace
}  // namespace fascia
