#include <fascia/baking/helper_search.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fascia/baking/helper_moments.h>

namespace fascia {
namespace {

// Another round that lowers the error by less than this share is not worth its time.
constexpr double kLeastGain = 1e-3;
// Of the model's size: below this, an error is that of the single-precision input.
constexpr double kNoError = 1e-7;
// Helpers that carry fewer points than this are moved to where they are needed.
constexpr double kLeastCarried = 0.5;
// A batch is this share of the helpers so far. More at once see less of what the others leave.
constexpr double kBatchShare = 0.25;
constexpr int kLeastBatch = 4;
constexpr int kRoundsPerBatch = 2;
constexpr int kSweeps = 2;  // over the helpers' motions in a round
// What refining usually takes off: growing stops so far above the tolerance.
constexpr double kRefined = 1.15;
// A helper is offered to points so many times farther away than those that it carries, so that it
// can spread; the second share is of the model's size.
constexpr double kReach = 1.25, kLeastReach = 0.02;

int batchAfter(int helpers) {
  return std::max(kLeastBatch, static_cast<int>(kBatchShare * helpers));
}

double roundOf(int helpers) {
  return helpers + 10;
}

}  // namespace

HelperSearch::HelperSearch(const SkinningProblem& problem, std::vector<FrameRange> motions,
                           const PointGraph& graph, std::span<const PointWeights> rigWeights,
                           BoneTracks bones, const DecompositionOptions& options)
    : problem_(problem),
      motions_(std::move(motions)),
      graph_(graph),
      rig_(rigWeights),
      rigBoneCount_(bones.boneCount()),
      options_(options),
      fit_(problem, graph, rigWeights, bones, options.influences),
      bones_(std::move(bones)),
      weights_(rigWeights.begin(), rigWeights.end()),
      size_m_(sizeOf(problem.rest_m)) {}

void HelperSearch::run() {
  fit_.fit(bones_, helpers_, weights_);
  planned_ = workOf(0, options_.helperBones) + refiningOf(options_.helperBones);
  grow(options_.helperBones);
  while (mayGrow(kRefined)) growFurther();
  refine();
  while (mayGrow(1)) {
    growFurther();
    planned_ = done_ + refiningOf(static_cast<int>(helpers_.size()));
    refine();
  }
}

bool HelperSearch::mayGrow(double timesTolerance) const {
  return options_.tolerance_m > 0 && error_m_ > timesTolerance * options_.tolerance_m &&
         static_cast<int>(helpers_.size()) < options_.mostHelpers && !exhausted_;
}

void HelperSearch::growFurther() {
  const int now = static_cast<int>(helpers_.size()), wanted = nextCount();
  planned_ = std::max(planned_, done_ + workOf(now, wanted) + refiningOf(wanted));
  grow(wanted);
}

// A round costs about as much as there are helpers, and something for the rest.
double HelperSearch::workOf(int from, int to) {
  double work = 0;
  while (from < to) {
    from = std::min(to, from + batchAfter(from));
    work += kRoundsPerBatch * roundOf(from);
  }
  return work;
}
double HelperSearch::refiningOf(int helpers) const {
  return options_.iterations * roundOf(helpers);
}

// The error falls about with the square root of the number of helpers.
int HelperSearch::nextCount() const {
  const auto now = static_cast<double>(helpers_.size());
  const double ratio = error_m_ / options_.tolerance_m;
  const double wanted = now * std::clamp(ratio * ratio, 1.1, 1.5) + kLeastBatch;
  return std::min(options_.mostHelpers, static_cast<int>(wanted));
}

void HelperSearch::grow(int wanted) {
  error_m_ = rms_m();
  while (static_cast<int>(helpers_.size()) < wanted && error_m_ > kNoError * size_m_) {
    const int now = static_cast<int>(helpers_.size());
    const int batch = std::min(wanted - now, batchAfter(now));
    const std::vector<HelperSeed> fresh = seeds(static_cast<std::size_t>(batch));
    exhausted_ = fresh.empty();
    if (exhausted_) break;
    for (const HelperSeed& seed : fresh) {
      bones_.add(seed.track);
      helpers_.emplace_back();
      place(helpers_.size() - 1, seed);
    }
    fit_.fit(bones_, helpers_, weights_);
    for (int k = 0; k < kRoundsPerBatch; ++k) round();
    error_m_ = rms_m();
  }
}

void HelperSearch::refine() {
  error_m_ = rms_m();
  for (int k = 0; k < options_.iterations && !helpers_.empty(); ++k) {
    const double before = error_m_;
    round();
    const bool moved = moveIdleHelpers();
    error_m_ = rms_m();
    if (error_m_ <= kNoError * size_m_ || (!moved && error_m_ > (1 - kLeastGain) * before)) break;
  }
}

void HelperSearch::round() {
  const HelperMoments moments(problem_.rest_m, weights_, rigBoneCount_, bones_.boneCount());
  moments.fit(&problem_, kSweeps, bones_);
  updateReach();
  fit_.fit(bones_, helpers_, weights_);
  done_ += roundOf(static_cast<int>(helpers_.size()));
  told_ = std::max(told_, std::min(done_ / planned_, 1.0));
  if (options_.progress) options_.progress(told_);
}

double HelperSearch::rms_m() {
  double largest = 0;
  for (const FrameRange& motion : motions_) {
    squaredErrors(problem_, weights_, bones_, motion, error_m2_);
    const double sum = std::accumulate(error_m2_.begin(), error_m2_.end(), 0.0);
    const auto frames = static_cast<double>(motion.end - motion.first);
    largest = std::max(largest, sum / (static_cast<double>(error_m2_.size()) * frames));
  }
  return std::sqrt(largest);
}

std::vector<HelperSeed> HelperSearch::seeds(std::size_t count) {
  squaredErrors(problem_, weights_, bones_, {0, problem_.frameCount}, error_m2_);
  const std::size_t patch =
      std::max<std::size_t>(12, problem_.pointCount() / (4 * (helpers_.size() + count)));
  return seedHelpers(problem_, graph_, rig_, bones_, error_m2_, patch, count, seeds_);
}

void HelperSearch::place(std::size_t helper, const HelperSeed& seed) {
  helpers_[helper] = {seed.parent, problem_.rest_m[seed.point],
                      2 * seed.radius_m + kLeastReach * size_m_};
}

void HelperSearch::updateReach() {
  std::vector<double> mass(helpers_.size(), 0.0), farthest(helpers_.size(), 0.0);
  std::vector<Vec3> moment(helpers_.size(), Vec3::Zero());
  const auto forEachUse = [&](const auto& visit) {
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      const PointWeights& w = weights_[i];
      for (std::size_t k = 0; k < PointWeights::kMost && w.weight[k] > 0; ++k) {
        if (w.joint[k] < rigBoneCount_) continue;
        visit(w.joint[k] - rigBoneCount_, problem_.rest_m[i], static_cast<double>(w.weight[k]));
      }
    }
  };
  forEachUse([&](std::size_t h, const Vec3& p, double w) {
    mass[h] += w;
    moment[h] += w * p;
  });
  for (std::size_t h = 0; h < helpers_.size(); ++h) {
    if (mass[h] > 0) helpers_[h].center_m = moment[h] / mass[h];
  }
  forEachUse([&](std::size_t h, const Vec3& p, double) {
    farthest[h] = std::max(farthest[h], (p - helpers_[h].center_m).norm());
  });
  for (std::size_t h = 0; h < helpers_.size(); ++h) {
    if (mass[h] > 0) helpers_[h].reach_m = kReach * farthest[h] + kLeastReach * size_m_;
  }
}

bool HelperSearch::moveIdleHelpers() {
  std::vector<double> carried(helpers_.size(), 0.0);
  for (const PointWeights& w : weights_) {
    for (std::size_t k = 0; k < PointWeights::kMost && w.weight[k] > 0; ++k) {
      if (w.joint[k] >= rigBoneCount_) {
        carried[w.joint[k] - rigBoneCount_] += static_cast<double>(w.weight[k]);
      }
    }
  }
  std::vector<std::size_t> idle;
  for (std::size_t h = 0; h < carried.size(); ++h) {
    if (carried[h] < kLeastCarried) idle.push_back(h);
  }
  if (idle.empty()) return false;
  const std::vector<HelperSeed> fresh = seeds(idle.size());
  for (std::size_t k = 0; k < fresh.size(); ++k) {
    const std::span<Transform> track = bones_.track(rigBoneCount_ + idle[k]);
    std::copy(fresh[k].track.begin(), fresh[k].track.end(), track.begin());
    place(idle[k], fresh[k]);
  }
  if (fresh.empty()) return false;
  fit_.fit(bones_, helpers_, weights_);
  round();
  return true;
}

}  // namespace fascia
