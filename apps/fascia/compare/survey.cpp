#include "compare/survey.h"

#include <algorithm>

#include <fascia/base/parallel.h>

namespace fascia {
namespace {

constexpr std::size_t kAtATime = 16;  // frames held in memory; fewer leave threads idle

}  // namespace

void Moment::forgetTriangles() {
  weights = {};
  for (const Side side : kSides) faults[side].per_triangle = {};
}

Surveyor::Seen Surveyor::see(std::size_t frame) {
  Seen seen;
  seen.frame = frame;
  sides_.joints(frame, seen.motion);
  for (const Side side : kSides) sides_.points(frame, side, seen.points[side]);
  return seen;
}

Moment Surveyor::measure(const Seen& seen) const {
  Moment moment;
  moment.frame = seen.frame;
  for (const Side side : kSides) moment.faults[side] = finder_.find(seen.points[side], seen.motion);
  std::vector<float> apart_m;
  for (std::size_t p = 0; p < seen.points.plain.size(); ++p)
    apart_m.push_back((seen.points.ours[p] - seen.points.plain[p]).norm());
  for (const float d : apart_m) moment.apart_m = std::max<double>(moment.apart_m, d);

  if (worst_ == Worst::difference) {
    const RiggedModel& model = sides_.model();
    for (std::size_t t = 0; t < model.triangles.size(); ++t) {
      float mean_m = 0;
      for (const std::uint32_t p : model.triangles[t]) mean_m += apart_m[p] / 3;
      moment.weights.push_back(mean_m * finder_.areas()[t]);
    }
  } else {
    moment.weights =
        (worst_ == Worst::plain ? moment.faults.plain : moment.faults.ours).per_triangle;
  }
  for (const float weight : moment.weights) moment.badness += weight;
  return moment;
}

Moment Surveyor::look(std::size_t frame) {
  return measure(see(frame));
}

std::vector<Moment> Surveyor::look(std::span<const std::size_t> frames,
                                   const std::function<void(double)>& progress) {
  std::vector<Moment> moments(frames.size());
  for (std::size_t from = 0; from < frames.size(); from += kAtATime) {
    std::vector<Seen> seen;
    for (std::size_t i = from; i < std::min(from + kAtATime, frames.size()); ++i)
      seen.push_back(see(frames[i]));
    parallelFor(seen.size(), [&](std::size_t i) {
      moments[from + i] = measure(seen[i]);
      moments[from + i].forgetTriangles();
    });
    progress(static_cast<double>(from + seen.size()) / static_cast<double>(frames.size()));
  }
  return moments;
}

std::size_t worstOf(std::span<const Moment> moments) {
  const auto worst =
      std::max_element(moments.begin(), moments.end(),
                       [](const Moment& a, const Moment& b) { return a.badness < b.badness; });
  return static_cast<std::size_t>(worst - moments.begin());
}

ClipFigures figuresOf(std::span<const Moment> moments) {
  ClipFigures out;
  for (const Moment& moment : moments) {
    out.apart_m = std::max(out.apart_m, moment.apart_m);
    for (const Side side : kSides) {
      const Faults& faults = moment.faults[side];
      out.crossings[side] = std::max(out.crossings[side], faults.crossings);
      out.turned[side] = std::max(out.turned[side], faults.turned);
      out.stretch[side] = std::max(out.stretch[side], faults.stretch);
    }
  }
  return out;
}

}  // namespace fascia
