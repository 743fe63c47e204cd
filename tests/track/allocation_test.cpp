#include <fascia/track/blend_source.h>
#include <fascia/track/drag_source.h>
#include <fascia/track/reach_source.h>
#include <fascia/track/stream_source.h>

#include "figure.h"
#include "support/count_allocations.h"

namespace fascia {
namespace {

// Rest with a ball joint as a rotation: allocates nothing by itself.
class Plain final : public PostureSource {
 public:
  explicit Plain(const test::Figure& figure) : rest_(figure.skeleton.restPosture()) {
    rest_.rotations = {{figure.joint("spine"), Quat::Identity(), Vec3::Zero()}};
  }
  void sample(double time_s, PostureSample& out) const override {
    out.posture = rest_;
    out.posture.values[0] = time_s, out.posture.rates[0] = 1;
    out.parameters.clear();
    out.parameters.push_back({SolidId(0), 0, 0.06, 0});
    out.morphs.weights.push_back(0.5), out.morphs.rates.push_back(0);
  }

 private:
  Posture rest_;
};

TEST(TrackAllocation, SamplingMakesNoneAfterWarmUp) {
  const test::Figure figure;
  const Skeleton& skeleton = figure.skeleton;
  const Plain plain(figure);
  StreamSource stream(figure);
  DragSource drag(figure, stream);
  BlendSource blend(figure);
  blend.add(plain);
  blend.add(drag, {0.5, 0.5});
  ReachSource reach(figure, blend);
  reach.add({figure.joint("shoulder"), figure.joint("wrist")}, [](double time_s) {
    ReachGoal goal;
    goal.position_m = Vec3(0.4, 1.5, 0.1 * time_s);
    return goal;
  });
  PostureSample pushed, out;
  const Posture former = skeleton.restPosture();
  const auto frame = [&](int f) {
    const double time_s = f / 60.0;
    ask(plain, time_s, pushed);
    stream.push(time_s, pushed);
    stream.receive(time_s);
    drag.hold(time_s, 5, 0.01 * f);
    reach.sample(time_s, out);
    admit(figure, former, out);
  };
  const long before = allocations;
  frame(0);
  EXPECT_GT(allocations, before);  // the counter counts
  // Every place of the stream's rings has to be warm.
  for (int f = 1; f < 200; ++f) frame(f);
  const long warm = allocations;
  for (int f = 200; f < 300; ++f) frame(f);
  EXPECT_EQ(allocations, warm);
}

}  // namespace
}  // namespace fascia
