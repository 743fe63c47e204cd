#include <gtest/gtest.h>

#include <fascia/base/error.h>

#include "puppets.h"

namespace fascia {
namespace {

using test::PuppetStage;

std::string errorOf(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Puppet, FindsPointsByNameAndSuggestsTheNearest) {
  PuppetStage stage;
  EXPECT_EQ(stage.puppet->name(stage["right 1"]), "right 1");
  const std::string said = errorOf([&] { stage.puppet->find("rihgt 1"); });
  EXPECT_NE(said.find("no point is named 'rihgt 1'"), std::string::npos) << said;
  EXPECT_NE(said.find("did you mean 'right 1'?"), std::string::npos) << said;
}

TEST(Puppet, RefusesPointsWithoutNameBodyOrSense) {
  PuppetStage stage;
  const auto make = [&](const std::vector<NamedPoint>& points) {
    return errorOf([&] { Puppet puppet(*stage.system, stage.state, points); });
  };
  EXPECT_EQ(make({{"a", Vec3::Zero()}}), "");
  EXPECT_NE(make({{"", Vec3::Zero()}}), "");
  EXPECT_NE(make({{"a", Vec3::Zero()}, {"a", Vec3::UnitX()}}), "");
  EXPECT_NE(make({{"a", BodyPoint{BodyId(2), Vec3::Zero()}}}), "");
  EXPECT_NE(make({{"a", Vec3(0, std::nan(""), 0)}}), "");
  EXPECT_NE(make({{"a", PointPath()}}), "");
}

TEST(Puppet, TellsPlaceAndVelocityOfAllKindsOfPoints) {
  for (const int dimension : {2, 3}) {
    PuppetStage stage(dimension);
    stage.setVelocity(1, Vec3(0, 2, 0));
    stage.state.t_s = 2;
    EXPECT_LT((stage.position("right 1") - Vec3(1.2, 0, 0)).norm(), 1e-12);
    EXPECT_LT((stage.velocity("right 1") - Vec3(0, 2, 0)).norm(), 1e-12);
    EXPECT_EQ(stage.position("post"), Vec3(0.5, 1, dimension == 3 ? 0.2 : 0));
    EXPECT_EQ(stage.velocity("post"), Vec3::Zero());
    EXPECT_LT((stage.position("cart") - Vec3(0.6, 0.5, 0)).norm(), 1e-15);
    EXPECT_EQ(stage.velocity("cart"), Vec3(0.3, 0, 0));
    EXPECT_NEAR(stage.puppet->distance_m(stage["left 0"], stage["right 1"]), 1.4, 1e-12);
    EXPECT_NEAR(stage.puppet->distance_m(stage["right 0"], Vec3(0.2, 3, 0)), 3, 1e-12);
  }
}

TEST(Puppet, HoldsAPointAgainstGravityAndLetsItFallByTheClosedForm) {
  for (const int dimension : {2, 3}) {
    const Vec3 g(0, -9.81, 0);
    PuppetStage stage(dimension, 1, BodyScheme::energyConserving, g);
    stage.setVelocity(0, Vec3(1, 0, 0));
    stage.puppet->hold(stage["middle 0"]);
    EXPECT_LT(stage.velocity("middle 0").norm(), 1e-12);
    stage.stepUntil(0.5);
    EXPECT_LT(stage.position("middle 0").norm(), 1e-12);
    stage.puppet->release(stage["middle 0"]);
    // The bar may swing about its middle: what falls is its centre of mass, with what it has.
    const Vec3 start = stage.position("middle 0"), v = stage.velocity("middle 0");
    stage.stepUntil(1.0);
    const Vec3 expected = start + 0.5 * v + 0.5 * 0.25 * g;
    EXPECT_LT((stage.position("middle 0") - expected).norm(), 1e-6);
  }
}

TEST(Puppet, ReplacesAnOlderControlOfAPointByTheNewer) {
  PuppetStage stage;
  const auto first = stage.puppet->lead(stage["left 0"], &PuppetStage::cart);
  stage.puppet->hold(stage["left 0"]);
  EXPECT_FALSE(stage.puppet->leads(first));
  EXPECT_TRUE(stage.puppet->controlled(stage["left 0"]));
  EXPECT_TRUE(stage.system->redundancies(stage.state).empty());
  stage.stepUntil(0.3);
  EXPECT_LT((stage.position("left 0") - Vec3(-0.2, 0, 0)).norm(), 1e-12);
}

TEST(Puppet, KnowsAPointUnderTwoNames) {
  PuppetStage stage;
  Puppet puppet(
      *stage.system, stage.state,
      {{"a", BodyPoint{BodyId(0), Vec3::UnitX()}}, {"b", BodyPoint{BodyId(0), Vec3::UnitX()}}});
  puppet.hold(puppet.find("a"));
  EXPECT_TRUE(puppet.controlled(puppet.find("b")));
  EXPECT_THROW(puppet.connect(puppet.find("a"), puppet.find("b")), Error);
  EXPECT_THROW(puppet.run(makeConnect(puppet.find("a"), puppet.find("b"))), Error);
}

TEST(Puppet, ConnectsMovingBodiesWithoutAJumpAndKeepsTheirMomentum) {
  for (const int dimension : {2, 3}) {
    PuppetStage stage(dimension);
    stage.setVelocity(0, Vec3(2, 1, 0)), stage.setVelocity(1, Vec3(-1, 0, 0));
    const Vec3 momentum = stage.system->model().momentum_Ns(stage.state.v);
    const double distance = stage.puppet->distance_m(stage["right 0"], stage["left 1"]);
    stage.puppet->connect(stage["right 0"], stage["left 1"]);
    EXPECT_LT((stage.velocity("right 0") - stage.velocity("left 1")).norm(), 1e-12);
    EXPECT_GT(stage.velocity("right 0").norm(), 0.1);
    double last = distance;
    while (stage.state.t_s < Puppet::kClosing_s) {
      stage.step();
      const double now = stage.puppet->distance_m(stage["right 0"], stage["left 1"]);
      EXPECT_LT(now, last);
      EXPECT_GT(now, last - 2 * distance * PuppetStage::kStep_s / Puppet::kClosing_s) << "a jump";
      last = std::max(now, 1e-15);
    }
    EXPECT_LT(last, 1e-12);
    EXPECT_LT((stage.system->model().momentum_Ns(stage.state.v) - momentum).norm(), 1e-9);
    EXPECT_TRUE(stage.puppet->connected(stage["left 1"], stage["right 0"]));
    stage.puppet->disconnect(stage["left 1"], stage["right 0"]);
    EXPECT_EQ(stage.puppet->connectionCount(), 0u);
  }
}

TEST(Puppet, NailsAPointToAPlaceThatMoves) {
  PuppetStage stage;
  stage.puppet->connect(stage["left 0"], stage["cart"]);
  stage.stepUntil(0.5);
  EXPECT_LT((stage.position("left 0") - stage.position("cart")).norm(), 1e-12);
  EXPECT_LT((stage.velocity("left 0") - Vec3(0.3, 0, 0)).norm(), 1e-9);
}

TEST(Puppet, StopsAPointDeadAndLetsItGo) {
  PuppetStage stage;
  stage.setVelocity(0, Vec3(1, 2, 0));
  stage.puppet->lead(stage["left 0"], &PuppetStage::cart);
  stage.puppet->stop(stage["left 0"]);
  EXPECT_LT(stage.velocity("left 0").norm(), 1e-12);
  EXPECT_GT(stage.velocity("right 0").norm(), 0.1);
  EXPECT_FALSE(stage.puppet->controlled(stage["left 0"]));
}

TEST(Puppet, GivesThePushedBodyItsImpulseWhateverTheStep) {
  const Vec3 force(3, -1, 0);
  for (const double h : {1.0 / 60, 0.037, 0.5}) {
    PuppetStage stage(3, 1);
    stage.puppet->push(stage["middle 0"], force, 0.1);
    EXPECT_EQ(stage.puppet->pushCount(), 1u);
    stage.stepUntil(1, h);
    const Vec3 momentum = stage.system->model().momentum_Ns(stage.state.v);
    EXPECT_LT((momentum - 0.1 * force).norm(), 1e-9) << h;
    EXPECT_EQ(stage.puppet->pushCount(), 0u);
  }
}

TEST(Puppet, LeavesForcesOfOthersAlone) {
  PuppetStage stage(3, 1);
  stage.system->addPointForce({BodyId(0), Vec3::Zero()}, Vec3(0, 2, 0));
  stage.puppet->push(stage["middle 0"], Vec3(1, 0, 0), 0.1);
  stage.stepUntil(0.5);
  const Vec3 momentum = stage.system->model().momentum_Ns(stage.state.v);
  EXPECT_LT((momentum - Vec3(0.1, 0.5 * 2, 0)).norm(), 1e-9);
}

TEST(Puppet, PullsAPointAfterATargetThatIsSetEveryFrame) {
  for (const int dimension : {2, 3}) {
    PuppetStage stage(dimension, 1);
    stage.puppet->pull(stage["middle 0"], Vec3(0, 0, 0), 200, 40);
    const int version = stage.system->constraintVersion();
    for (int i = 0; i < 120; ++i) {
      stage.puppet->pull(stage["middle 0"], Vec3(0.01 * i, 0.3, 0), 200, 40);
      stage.step();
    }
    EXPECT_EQ(stage.system->constraintVersion(), version) << "made anew";
    for (int i = 0; i < 120; ++i) stage.step();
    EXPECT_LT((stage.position("middle 0") - Vec3(1.19, 0.3, 0)).norm(), 1e-3);
    stage.puppet->release(stage["middle 0"]);
    stage.setVelocity(0, Vec3(0, 1, 0));
    stage.step();
    EXPECT_LT((stage.velocity("middle 0") - Vec3(0, 1, 0)).norm(), 1e-9) << "still pulled";
  }
}

TEST(Puppet, PullsPointsTogether) {
  PuppetStage stage;
  stage.puppet->pull(stage["right 0"], stage["left 1"], 100, 10);
  for (int i = 0; i < 600; ++i) stage.step();
  EXPECT_LT(stage.puppet->distance_m(stage["right 0"], stage["left 1"]), 0.01);
}

TEST(Puppet, RefusesToControlPlaces) {
  PuppetStage stage;
  const std::string said = errorOf([&] { stage.puppet->hold(stage["post"]); });
  EXPECT_NE(said.find("'post' is a place"), std::string::npos) << said;
  EXPECT_THROW(stage.puppet->connect(stage["cart"], stage["left 0"]), Error);
  EXPECT_THROW(stage.puppet->impulse(stage["left 0"], Vec3(std::nan(""), 0, 0)), Error);
  EXPECT_THROW(stage.puppet->push(stage["left 0"], Vec3::UnitX(), -1), Error);
  EXPECT_THROW(stage.puppet->pull(stage["left 0"], PuppetPointId(99), 1, 0), Error);
  EXPECT_THROW(stage.puppet->run(makeHold(PuppetPointId())), Error);
}

}  // namespace
}  // namespace fascia
