#include <fascia/track/stream_source.h>

#include <thread>

#include "figure.h"

namespace fascia {
namespace {

class Streaming : public testing::Test {
 protected:
  test::Figure figure;
  test::Swing actor{figure, 4, true};
  StreamSource stream{figure, {.delay_s = 0.1}};

  void push(double time_s) {
    PostureSample sample;
    actor.sample(time_s, sample);
    stream.push(time_s, sample);
  }
  test::Seen see(const PostureSource& source, double time_s) const {
    return {figure, source, time_s};
  }
  // How far joints of two moments are apart, as matrices.
  double apart(const test::Seen& a, const test::Seen& b) const {
    double most = 0;
    for (std::size_t j = 0; j < figure.skeleton.jointCount(); ++j)
      most = std::max(
          {most, (a.posed.joint_world[j].rotation - b.posed.joint_world[j].rotation).norm(),
           (a.posed.joint_world[j].translation_m - b.posed.joint_world[j].translation_m).norm()});
    return most;
  }
};

TEST_F(Streaming, RestsUntilSomethingComes) {
  EXPECT_EQ(see(stream, 1).sample.posture.values, figure.skeleton.restPosture().values);
  EXPECT_EQ(stream.receive(1), 0u);
}

TEST_F(Streaming, ShowsWhatWasPushedSmoothlyAndLater) {
  for (int i = 0; i <= 30; ++i) push(i / 30.0);
  EXPECT_EQ(stream.receive(0), 31u);
  EXPECT_LT(apart(see(stream, 0.5 + 0.1), see(actor, 0.5)), 1e-12);     // a moment that was pushed
  EXPECT_LT(apart(see(stream, 0.517 + 0.1), see(actor, 0.517)), 2e-4);  // between two
  for (const double time_s : {0.31, 0.52, 0.777})
    test::expectRatesAreDerivatives(figure, stream, time_s);
}

TEST_F(Streaming, PutsLatePosturesInTheirPlace) {
  for (const int i : {0, 3, 1, 2, 5, 4, 3}) push(i / 30.0);
  stream.receive(0);
  for (const int i : {1, 2, 3, 4})
    EXPECT_LT(apart(see(stream, i / 30.0 + 0.1), see(actor, i / 30.0)), 1e-12);
}

TEST_F(Streaming, CoastsForAMomentThenHolds) {
  for (int i = 0; i <= 10; ++i) push(i / 30.0);
  stream.receive(0);
  const double last = 10 / 30.0 + 0.1;
  test::expectRatesAreDerivatives(figure, stream, last + 0.05);
  const test::Seen held = see(stream, last + 0.1), later = see(stream, last + 5);
  EXPECT_GT(apart(see(stream, last), held), 1e-3);
  EXPECT_LT(apart(held, later), 1e-15);
  for (const double rate : later.sample.posture.rates) EXPECT_EQ(rate, 0);
  for (const Twist& twist : later.posed.twist_world)
    EXPECT_EQ(twist.angular_rad_per_s.norm() + twist.linear_m_per_s.norm(), 0);
}

TEST_F(Streaming, CatchesUpAfterAGapWithoutAJump) {
  for (int i = 0; i <= 10; ++i) push(i / 30.0);
  stream.receive(0);
  const double now = 1.0;  // it stands since long
  const test::Seen before = see(stream, now);
  for (int i = 25; i <= 40; ++i) push(i / 30.0);
  stream.receive(now);
  EXPECT_LT(apart(see(stream, now), before), 1e-12);
  test::expectRatesAreDerivatives(figure, stream, now + 0.02, 1e-5);
  ASSERT_GT(apart(before, see(actor, now - 0.1)), 0.1);
  EXPECT_LT(apart(see(stream, now + 0.4), see(actor, now + 0.3)), 5e-3);
}

TEST_F(Streaming, TakesInAtReceiveOnly) {
  for (int i = 0; i <= 10; ++i) push(i / 30.0);
  stream.receive(0);
  const test::Seen before = see(stream, 0.6);
  push(0.5);
  EXPECT_EQ(see(stream, 0.6).sample.posture.values, before.sample.posture.values);
  EXPECT_EQ(stream.receive(0.6), 1u);
}

TEST_F(Streaming, KeepsTheNewestWhenMoreWaitThanThereIsRoom) {
  for (int i = 0; i <= 200; ++i) push(i / 30.0);
  EXPECT_EQ(stream.receive(0), 64u);
  EXPECT_LT(apart(see(stream, 200 / 30.0 + 0.1), see(actor, 200 / 30.0)), 1e-12);
}

TEST_F(Streaming, MayBePushedByOtherThreads) {
  std::vector<std::jthread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([this, t] {
      for (int i = 0; i < 500; ++i) push((4 * i + t) / 400.0);
    });
  std::size_t taken = 0;
  for (int f = 0; f < 100; ++f) {
    taken += stream.receive(f / 60.0);
    for (const double value : see(stream, f / 60.0).sample.posture.values)
      ASSERT_TRUE(std::isfinite(value));
  }
  threads.clear();
  taken += stream.receive(2);
  EXPECT_GT(taken, 0u);
  EXPECT_LE(taken, 2000u);
}

}  // namespace
}  // namespace fascia
