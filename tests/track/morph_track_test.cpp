// What sources on top of others make of morphs' weights.
#include <fascia/track/blend_source.h>
#include <fascia/track/drag_source.h>
#include <fascia/track/reach_source.h>
#include <fascia/track/stream_source.h>

#include "figure.h"

namespace fascia {
namespace {

constexpr std::size_t kSmile = 0, kFrown = 1;

// Holds weights, moves nothing else.
class Face final : public PostureSource {
 public:
  Face(const test::Figure& figure, std::vector<double> weights)
      : rest_(figure.skeleton.restPosture()), weights_(std::move(weights)) {}
  void sample(double, PostureSample& out) const override {
    out.posture = rest_;
    out.parameters.clear();
    out.morphs.weights = weights_;
    out.morphs.rates.clear();
  }

 private:
  Posture rest_;
  std::vector<double> weights_;
};

class MorphTracks : public testing::Test {
 protected:
  test::Figure figure;
  Face laugh{figure, {1, 0.5}};
  test::Swing talk{figure, 1};

  MorphPose see(const PostureSource& source, double time_s) const {
    return test::Seen(figure, source, time_s).sample.morphs;
  }
  void expectRatesAreDerivatives(const PostureSource& source, double time_s) const {
    constexpr double kStep_s = 1e-5;
    const MorphPose now = see(source, time_s), before = see(source, time_s - kStep_s),
                    after = see(source, time_s + kStep_s);
    EXPECT_GT(std::abs(now.rates[kSmile]), 0.01) << time_s;
    for (const std::size_t m : {kSmile, kFrown})
      EXPECT_NEAR(now.rates[m], (after.weights[m] - before.weights[m]) / (2 * kStep_s), 1e-5)
          << time_s;
  }
};

TEST_F(MorphTracks, ABlendByHalfHalvesWeights) {
  BlendSource blend(figure);
  blend.add(laugh, {0.5, 0.5});
  const MorphPose half = see(blend, 1);
  EXPECT_EQ(half.weights[kSmile], 0.5);
  EXPECT_EQ(half.weights[kFrown], 0.375);  // from rest, 0.25, to 0.5
}

TEST_F(MorphTracks, ABlendFadesThemWithTheirRates) {
  BlendSource blend(figure);
  blend.add(talk);
  blend.add(laugh, {0, 1, 1, 0.5});
  EXPECT_EQ(see(blend, 0.9).weights, see(talk, 0.9).weights);
  EXPECT_EQ(see(blend, 1.6).weights, see(laugh, 1.6).weights);
  for (const double time_s : {1.1, 1.25, 1.4}) expectRatesAreDerivatives(blend, time_s);
}

TEST_F(MorphTracks, ALayerOfSomeJointsLeavesThemAloneUnlessAsked) {
  const std::vector<double> arm = shareBelow(figure.skeleton, figure.joint("shoulder"));
  BlendSource blend(figure);
  blend.add(talk);
  const std::vector<double> before = see(blend, 0.7).weights;
  blend.add(laugh, {}, arm);
  EXPECT_EQ(see(blend, 0.7).weights, before);
  blend.add(laugh, {}, arm, {1, 0});
  EXPECT_EQ(see(blend, 0.7).weights[kSmile], 1);
  EXPECT_EQ(see(blend, 0.7).weights[kFrown], before[kFrown]);
}

TEST_F(MorphTracks, AHandHoldsOneAndLetsItGoSmoothly) {
  DragSource drag(figure, talk, 0.1);
  const double before = see(drag, 1).weights[kSmile];
  drag.holdMorph(1, kSmile, 0.9);
  drag.holdMorph(1, 99, 0.9);  // there is none
  EXPECT_NEAR(see(drag, 1).weights[kSmile], before, 1e-12);
  expectRatesAreDerivatives(drag, 1.05);
  EXPECT_NEAR(see(drag, 3).weights[kSmile], 0.9, 1e-9);
  EXPECT_EQ(see(drag, 3).weights[kFrown], 0.25);
  drag.releaseMorph(3, kSmile);
  EXPECT_NEAR(see(drag, 3).weights[kSmile], 0.9, 1e-9);
  EXPECT_NEAR(see(drag, 5).weights[kSmile], see(talk, 5).weights[kSmile], 1e-9);
}

TEST_F(MorphTracks, AStreamPassesThroughThoseThatCame) {
  StreamSource stream(figure, {.delay_s = 0.1});
  PostureSample pushed;
  for (int f = 0; f < 40; ++f) {
    const double time_s = f / 50.0;
    ask(talk, time_s, pushed);
    pushed.morphs.rates.clear();  // are not read
    if (f == 20) pushed.morphs.weights[kSmile] = std::nan("");
    stream.push(time_s, pushed);
    stream.receive(time_s);
  }
  EXPECT_NEAR(see(stream, 0.7).weights[kSmile], see(talk, 0.6).weights[kSmile], 1e-12);
  expectRatesAreDerivatives(stream, 0.71);
  EXPECT_EQ(see(stream, 0.5).weights[kSmile], 0);  // no number: at rest
}

TEST_F(MorphTracks, InverseKinematicsLeavesThemAsTheyAre) {
  ReachSource reach(figure, talk);
  reach.add({figure.joint("shoulder"), figure.joint("wrist")},
            [](double) { return ReachGoal{.position_m = Vec3(0.4, 1.5, 0.2)}; });
  EXPECT_EQ(see(reach, 0.8).weights, see(talk, 0.8).weights);
  EXPECT_EQ(see(reach, 0.8).rates, see(talk, 0.8).rates);
}

}  // namespace
}  // namespace fascia
