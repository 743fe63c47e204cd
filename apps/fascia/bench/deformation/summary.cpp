#include "bench/deformation/summary.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fascia {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Ours over theirs; infinite if only they have nothing.
double ratio(double ours, double theirs) {
  if (theirs > 0) return ours / theirs;
  return ours > 0 ? HUGE_VAL : kNone;
}

// Less than this nobody sees, and its ratios say nothing: of lumpiness (in edges), and of jitter
// (of the model's size: 0.02 mm on a person).
constexpr double kLeastLump = 1e-3, kLeastJitter = 1e-5;

// Ratios over stages.
class Ratios {
 public:
  explicit Ratios(double least) : least_(least) {}
  void add(double ours, double theirs) {
    if (!(ours <= least_) || !(theirs <= least_))
      values_.push_back(std::max(ours, least_) / std::max(theirs, least_));
  }
  double worst() const {
    return values_.empty() ? kNone : *std::max_element(values_.begin(), values_.end());
  }
  double median() const {
    if (values_.empty()) return kNone;
    std::vector<double> sorted = values_;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t half = sorted.size() / 2;
    return sorted.size() % 2 == 1 ? sorted[half] : 0.5 * (sorted[half - 1] + sorted[half]);
  }

 private:
  double least_;
  std::vector<double> values_;
};

// Two sums of counts over stages: against nothing, each counts as one.
struct Counts {
  std::size_t ours = 0, theirs = 0;
  void add(std::size_t a, std::size_t b) { ours += a, theirs += b; }
  double value() const {
    if (ours + theirs == 0) return kNone;
    return static_cast<double>(ours) / static_cast<double>(std::max<std::size_t>(theirs, 1));
  }
};

struct Totals {
  double mostCrossings = kNone, mostGain = kNone, restError_m = kNone;
  int clipsNotFewer = 0, clips = 0;
  Counts clipCrossings, poseTurned;
  double bendLoss = 0, bendLossOfTheirs = 0;
  Ratios lumpiness{kLeastLump}, stretch{0}, jitter;
  double frame_s = 0;
  int timed = 0;

  explicit Totals(double size_m) : jitter(kLeastJitter * size_m) {}
};

void addPose(const StageResult& stage, const Score& ours, const Score& theirs, Totals& t) {
  t.mostCrossings = std::fmax(t.mostCrossings, static_cast<double>(ours.crossings_in_piece));
  // Where linear blending gains, too, the pose is what makes the gain: an arm raised opens its pit.
  const double gain = std::min(0.0, theirs.volume_loss) - ours.volume_loss;
  t.mostGain = std::fmax(t.mostGain, std::max(0.0, gain));
  t.restError_m = std::fmax(t.restError_m, ours.rest_error_m);
  t.poseTurned.add(ours.turned, theirs.turned);
  if (!stage.isBend) return;
  t.bendLoss += std::max(0.0, ours.volume_loss);
  t.bendLossOfTheirs += std::max(0.0, theirs.volume_loss);
}

void addClip(const Score& ours, const Score& theirs, Totals& t) {
  ++t.clips;
  t.clipsNotFewer += ours.turned > 0 && ours.turned >= theirs.turned ? 1 : 0;
  t.clipCrossings.add(ours.crossings, theirs.crossings);
  t.jitter.add(ours.jitter_m, theirs.jitter_m);
}

Totals totalsOf(const std::vector<StageResult>& stages, std::size_t number, double size_m) {
  Totals t(size_m);
  const bool anyClip = std::any_of(stages.begin(), stages.end(),
                                   [](const StageResult& stage) { return !stage.isPose; });
  for (const StageResult& stage : stages) {
    const Score& ours = stage.scores[number];
    const Score& theirs = stage.scores.front();
    if (stage.isPose)
      addPose(stage, ours, theirs, t);
    else
      addClip(ours, theirs, t);
    t.lumpiness.add(ours.lumpiness.rms, theirs.lumpiness.rms);
    t.stretch.add(ours.stretch.percentile99, theirs.stretch.percentile99);
    // Poses rest half of their time: clips tell better what a frame costs.
    if (stage.isPose && anyClip) continue;
    t.frame_s += stage.frame_s[number];
    ++t.timed;
  }
  return t;
}

}  // namespace

std::vector<SummaryMeasure> summarize(const RiggedModel& model,
                                      const std::vector<StageResult>& stages, std::size_t number,
                                      double jitterGoal) {
  const Totals t = totalsOf(stages, number, model.size_m());
  const auto points = static_cast<double>(model.points_m.size());
  return {
      {"pose_crossings", "crossings of one piece in a pose", t.mostCrossings, 3},
      {"clip_crossings", "crossings in clips", t.clipCrossings.value(), 0.75},
      {"pose_turned", "turned triangles in poses", t.poseTurned.value(), 0.25},
      {"clips_with_more_turned", "clips without fewer turned triangles",
       t.clips > 0 ? t.clipsNotFewer : kNone, 0},
      {"lumpiness_median", "lumpiness, median", t.lumpiness.median(), 0.8},
      {"lumpiness_worst", "lumpiness, worst", t.lumpiness.worst(), 1},
      {"bend_volume_loss", "volume lost in bends", ratio(t.bendLoss, t.bendLossOfTheirs), 0.5},
      {"volume_gain", "largest gain of volume", t.mostGain, 0.1},
      {"stretch_median", "99 % stretch, median", t.stretch.median(), 0.85},
      {"stretch_worst", "99 % stretch, worst", t.stretch.worst(), 1},
      {"jitter_worst", "jitter, worst", t.jitter.worst(), jitterGoal > 0 ? jitterGoal : kNone},
      {"rest_error", "error at rest, of the height",
       model.height_m() > 0 ? t.restError_m / model.height_m() : kNone, 1e-6},
      {"point_frame_us", "µs per point and frame",
       t.timed > 0 && points > 0 ? 1e6 * t.frame_s / t.timed / points : kNone, 0.2},
  };
}

}  // namespace fascia
