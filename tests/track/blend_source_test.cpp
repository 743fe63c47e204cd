#include <fascia/track/blend_source.h>

#include "figure.h"

namespace fascia {
namespace {

class Blending : public testing::Test {
 protected:
  test::Figure figure;
  test::Swing walk{figure, 1, true}, wave{figure, 2}, nod{figure, 3, true};
  BlendSource blend{figure};

  test::Seen see(const PostureSource& source, double time_s) const {
    return {figure, source, time_s};
  }
};

TEST_F(Blending, OfOneSourceIsThatSourceBitForBit) {
  blend.add(wave);
  const test::Seen blended = see(blend, 0.7), alone = see(wave, 0.7);
  EXPECT_EQ(blended.sample.posture.values, alone.sample.posture.values);
  EXPECT_EQ(blended.sample.posture.rates, alone.sample.posture.rates);
  EXPECT_EQ(test::radiusOf(blended.sample), test::radiusOf(alone.sample));
}

TEST_F(Blending, OfNothingIsRest) {
  EXPECT_EQ(see(blend, 1).sample.posture.values, figure.skeleton.restPosture().values);
}

TEST_F(Blending, ReplacesByItsWeight) {
  blend.add(walk);
  blend.add(wave, {0.3, 0.3});
  const test::Seen blended = see(blend, 0.7), a = see(walk, 0.7), b = see(wave, 0.7);
  const std::size_t elbow = figure.value("elbow", Dof::ry);
  const auto mixed = [](double x, double y) { return 0.7 * x + 0.3 * y; };
  EXPECT_NEAR(blended.sample.posture.values[elbow],
              mixed(a.sample.posture.values[elbow], b.sample.posture.values[elbow]), 1e-15);
  EXPECT_NEAR(test::radiusOf(blended.sample),
              mixed(test::radiusOf(a.sample), test::radiusOf(b.sample)), 1e-15);
  // A ball joint has gone three tenths of the way from one rotation to the other.
  const Mat3 &from = a.posed.joint_world[1].rotation, &to = b.posed.joint_world[1].rotation,
             &here = blended.posed.joint_world[1].rotation;
  const Vec3 whole = vectorOf(Quat(Mat3(from.transpose() * to)));
  const Vec3 part = vectorOf(Quat(Mat3(from.transpose() * here)));
  ASSERT_GT(whole.norm(), 0.2);
  EXPECT_LT((part - 0.3 * whole).norm(), 1e-12);
}

TEST_F(Blending, CrossFadesFromOneToTheOther) {
  blend.add(walk);
  const std::size_t upper = blend.add(wave, {0, 0});
  blend.fade(upper, 1, 1, 0.5);
  const std::size_t hip = figure.value("hip", Dof::tx);
  EXPECT_EQ(see(blend, 0.9).sample.posture.values[hip], see(walk, 0.9).sample.posture.values[hip]);
  EXPECT_EQ(see(blend, 1.6).sample.posture.values, see(wave, 1.6).sample.posture.values);
  EXPECT_NEAR(blend.weight(upper, 1.25).weight, 0.5, 1e-15);
  for (const double time_s : {1.01, 1.2, 1.4, 1.49})
    test::expectRatesAreDerivatives(figure, blend, time_s);
}

TEST_F(Blending, HasRatesThatAreDerivativesOfAllThatItMixes) {
  blend.add(walk, {0.2, 0.9, 0, 2});
  blend.add(wave, {0.5, 0.1, 0.5, 1}, shareBelow(figure.skeleton, figure.joint("shoulder")));
  blend.add(nod, {0, 0.6, 0, 3});
  for (const double time_s : {0.3, 0.8, 1.2, 1.9}) {
    test::expectRatesAreDerivatives(figure, blend, time_s);
    const double h = 1e-5;
    const double measured = (test::radiusOf(see(blend, time_s + h).sample) -
                             test::radiusOf(see(blend, time_s - h).sample)) /
                            (2 * h);
    ASSERT_GT(std::abs(measured), 1e-4);
    EXPECT_NEAR(test::radiusRateOf(see(blend, time_s).sample), measured, 1e-8);
  }
}

TEST_F(Blending, LeavesJointsAloneThatALayerHasNoShareIn) {
  blend.add(walk);
  blend.add(wave, {}, shareBelow(figure.skeleton, figure.joint("elbow")));
  const test::Seen blended = see(blend, 0.4), below = see(walk, 0.4), above = see(wave, 0.4);
  for (std::size_t v = 0; v < figure.skeleton.valueCount(); ++v) {
    const JointId joint = figure.skeleton.valueJoint(static_cast<int>(v));
    const bool upper = joint == figure.joint("elbow") || joint == figure.joint("wrist");
    EXPECT_NEAR(blended.sample.posture.values[v], (upper ? above : below).sample.posture.values[v],
                1e-12)
        << v;
  }
  EXPECT_NEAR(test::radiusOf(blended.sample), test::radiusOf(above.sample),
              1e-15);  // the fist is there
}

TEST_F(Blending, FadesAParameterThatOnlyOneAnimatesToWhatDriversSay) {
  struct Still final : PostureSource {
    const test::Figure* figure;
    void sample(double, PostureSample& out) const override {
      out.posture = figure->skeleton.restPosture();
      out.parameters.clear();
    }
  } still;
  still.figure = &figure;
  blend.add(wave);
  blend.add(still, {0.25, 0.25});
  const double keyed = test::radiusOf(see(wave, 0.2).sample);
  EXPECT_NEAR(test::radiusOf(see(blend, 0.2).sample), 0.75 * keyed + 0.25 * 0.05, 1e-15);
}

TEST_F(Blending, TakesWhatIsNotFitForTheFigure) {
  struct Broken final : PostureSource {
    void sample(double, PostureSample& out) const override {
      out.posture.values.assign(99, std::nan(""));
      out.posture.rates.assign(99, HUGE_VAL);
      out.posture.rotations = {{JointId(50), Quat(0, 0, 0, 0), Vec3::Zero()}};
      out.parameters = {{SolidId(50), 3, 1, 1}};
    }
  } broken;
  blend.add(broken, {0.5, 0.5});
  const test::Seen seen = see(blend, 1);
  for (const double value : seen.sample.posture.values) EXPECT_TRUE(std::isfinite(value));
}

}  // namespace
}  // namespace fascia
