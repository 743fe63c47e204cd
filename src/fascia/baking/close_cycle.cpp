#include <fascia/baking/close_cycle.h>

#include <algorithm>
#include <cassert>

#include <fascia/base/parallel.h>

namespace fascia {
namespace {

// The last part, of a cycle's length. A longer one changes more of what was simulated, a shorter
// one moves faster: flesh swings once or twice in a cycle.
constexpr double kBlended = 0.4;

// From 0 to 1, with a steady speed at both ends.
double smooth(double t) {
  return t * t * (3 - 2 * t);
}

}  // namespace

double closeCycle(PointFrames& frames, const BoneFrames& bones,
                  std::span<const std::uint32_t> carrier, const Vec3& travel_m) {
  if (frames.size() < 2) return 0;
  assert(bones.size() == frames.size() && carrier.size() == frames[0].size());
  const std::size_t last = frames.size() - 1, points = frames[0].size();
  std::vector<Vec3> gap(points);
  double largest = 0;
  for (std::size_t i = 0; i < points; ++i) {
    gap[i] = (frames[last][i] - frames[0][i]).cast<double>() - travel_m;
    largest = std::max(largest, gap[i].norm());
  }
  const double first = (1 - kBlended) * static_cast<double>(last);
  parallelFor(last, [&](std::size_t f) {
    const double t = (static_cast<double>(f) - first) / (static_cast<double>(last) - first);
    if (t <= 0) return;
    for (std::size_t i = 0; i < points; ++i) {
      const Mat3& now = bones[f][carrier[i]].rotation;
      const Mat3& then = bones[last][carrier[i]].rotation;
      const Vec3 turned = now * (then.transpose() * gap[i]);
      frames[f][i] -= (smooth(t) * turned).cast<float>();
    }
  });
  for (std::size_t i = 0; i < points; ++i) {
    frames[last][i] = frames[0][i] + travel_m.cast<float>();
  }
  return largest;
}

}  // namespace fascia
