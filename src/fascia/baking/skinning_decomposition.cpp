#include <fascia/baking/skinning_decomposition.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fascia/baking/bone_tracks.h>
#include <fascia/baking/helper_bones.h>
#include <fascia/baking/point_graph.h>
#include <fascia/baking/weight_fit.h>
#include <fascia/base/error.h>
#include <fascia/base/parallel.h>

namespace fascia {
namespace {

// Longer motions are fitted in this many frames, evenly spread; all frames are fitted at the end
// with the weights found. More frames hardly change the weights, but cost time in proportion.
constexpr std::size_t kMostFittedFrames = 90;
// Another round that lowers the error by less than this share is not worth its time.
constexpr double kLeastGain = 5e-4;
// Of the model's size: below this, an error is that of the single-precision input.
constexpr double kNoError = 1e-7;
// Helpers that carry fewer points than this are moved to where they are needed.
constexpr double kLeastCarried = 0.5;

std::vector<std::size_t> fittedFrames(std::size_t count) {
  std::vector<std::size_t> frames(std::min(count, kMostFittedFrames));
  for (std::size_t k = 0; k < frames.size(); ++k) {
    frames[k] = frames.size() < 2 ? 0 : k * (count - 1) / (frames.size() - 1);
  }
  return frames;
}

SkinningProblem problemOf(std::span<const Eigen::Vector3f> rest, const PointFrames& frames,
                          std::span<const std::size_t> chosen) {
  SkinningProblem problem;
  problem.frameCount = chosen.size();
  problem.rest_m.reserve(rest.size());
  for (const Eigen::Vector3f& p : rest) problem.rest_m.push_back(p.cast<double>());
  problem.target_m.resize(rest.size() * chosen.size());
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    for (std::size_t i = 0; i < rest.size(); ++i) {
      problem.target_m[i * chosen.size() + k] = frames[chosen[k]][i];
    }
  }
  return problem;
}

BoneTracks tracksOf(const std::vector<std::vector<Transform>>& bones,
                    std::span<const std::size_t> chosen) {
  BoneTracks tracks(chosen.size());
  std::vector<Transform> track(chosen.size());
  for (std::size_t b = 0; b < bones[0].size(); ++b) {
    for (std::size_t k = 0; k < chosen.size(); ++k) track[k] = bones[chosen[k]][b];
    tracks.add(track);
  }
  return tracks;
}

double rmsOf(std::span<const double> squaredError, std::size_t frames) {
  const double sum = std::accumulate(squaredError.begin(), squaredError.end(), 0.0);
  return std::sqrt(sum / static_cast<double>(squaredError.size() * frames));
}

// Bones against weights, in the fitted frames.
class Alternation {
 public:
  Alternation(const SkinningProblem& problem, const PointGraph& graph,
              std::span<const PointWeights> rigWeights, BoneTracks bones,
              const DecompositionOptions& options)
      : problem_(problem),
        graph_(graph),
        rig_(rigWeights),
        rigBoneCount_(bones.boneCount()),
        options_(options),
        fit_(problem, graph, rigWeights, rigBoneCount_, options.influences),
        bones_(std::move(bones)),
        weights_(rigWeights.begin(), rigWeights.end()),
        everyPoint_(problem.pointCount()) {
    std::iota(everyPoint_.begin(), everyPoint_.end(), 0u);
    Box box;
    for (const Vec3& p : problem.rest_m) box.add(p);
    noError_m_ = kNoError * box.size().norm();
  }

  void run() {
    fitWeights(everyPoint_);
    for (int h = 0; h < options_.helperBones && rms_m() > noError_m_; ++h) {
      tell(h);
      addHelper();
    }
    double before = rms_m();
    for (int round = 0; round < options_.iterations && !parents_.empty(); ++round) {
      tell(options_.helperBones + round);
      fitHelperMotions(problem_, weights_, rigBoneCount_, 1, bones_);
      fitWeights(everyPoint_);
      const bool moved = moveIdleHelpers();
      const double now = rms_m();
      if (now <= noError_m_ || (!moved && now > (1 - kLeastGain) * before)) break;
      before = now;
    }
  }

  const BoneTracks& bones() const { return bones_; }
  const std::vector<int>& parents() const { return parents_; }
  const std::vector<PointWeights>& weights() const { return weights_; }

 private:
  void tell(int done) const {
    const double all = std::max(1, options_.helperBones + options_.iterations);
    if (options_.progress) options_.progress(done / all);
  }
  double rms_m() {
    squaredErrors(problem_, weights_, bones_, error_m2_);
    return rmsOf(error_m2_, problem_.frameCount);
  }
  void fitWeights(std::span<const std::uint32_t> points) {
    fit_.fit(bones_, parents_, points, weights_);
  }
  HelperSeed seed() {
    squaredErrors(problem_, weights_, bones_, error_m2_);
    const auto helpers = static_cast<std::size_t>(options_.helperBones);
    const std::size_t patch = std::max<std::size_t>(12, problem_.pointCount() / (4 * helpers));
    const HelperSeed found = seedHelper(problem_, graph_, rig_, bones_, error_m2_, seeds_, patch);
    seeds_.push_back(found.point);
    return found;
  }
  // Fitted to its surroundings at once, so that the next one sees what is left.
  void settle(int parent) {
    std::vector<std::uint32_t> around;
    for (const std::uint32_t i : everyPoint_) {
      if (fit_.mayFollow(i, parent)) around.push_back(i);
    }
    fitWeights(around);
    fitHelperMotions(problem_, weights_, rigBoneCount_, 1, bones_);
    fitWeights(around);
  }
  void addHelper() {
    const HelperSeed found = seed();
    bones_.add(found.track);
    parents_.push_back(found.parent);
    settle(found.parent);
  }
  bool moveIdleHelpers() {
    std::vector<double> carried(parents_.size(), 0.0);
    for (const PointWeights& w : weights_) {
      for (std::size_t k = 0; k < PointWeights::kMost && w.weight[k] > 0; ++k) {
        if (w.joint[k] >= rigBoneCount_) {
          carried[w.joint[k] - rigBoneCount_] += static_cast<double>(w.weight[k]);
        }
      }
    }
    bool moved = false;
    for (std::size_t h = 0; h < parents_.size(); ++h) {
      if (carried[h] >= kLeastCarried) continue;
      const HelperSeed found = seed();
      std::copy(found.track.begin(), found.track.end(), bones_.track(rigBoneCount_ + h).begin());
      parents_[h] = found.parent;
      settle(found.parent);
      moved = true;
    }
    return moved;
  }

  const SkinningProblem& problem_;
  const PointGraph& graph_;
  std::span<const PointWeights> rig_;
  std::size_t rigBoneCount_;
  const DecompositionOptions& options_;
  WeightFit fit_;
  BoneTracks bones_;
  std::vector<int> parents_;  // per helper
  std::vector<PointWeights> weights_;
  std::vector<std::uint32_t> everyPoint_, seeds_;
  std::vector<double> error_m2_;
  double noError_m_ = 0;
};

// Helpers' motions in all frames: at first as they lie to their parents in the nearest fitted
// frame.
BoneTracks spreadHelpers(const Alternation& fitted, std::span<const std::size_t> chosen,
                         BoneTracks all) {
  const std::size_t rigBones = all.boneCount();
  for (std::size_t h = 0; h < fitted.parents().size(); ++h) {
    const auto parent = static_cast<std::size_t>(fitted.parents()[h]);
    std::vector<Transform> track(all.frameCount());
    std::size_t k = 0;
    for (std::size_t f = 0; f < track.size(); ++f) {
      while (k + 1 < chosen.size() && chosen[k + 1] + chosen[k] <= 2 * f) ++k;
      track[f] = f == chosen[k] ? fitted.bones().at(rigBones + h, k)
                                : all.at(parent, f) * all.at(parent, chosen[k]).inverse() *
                                      fitted.bones().at(rigBones + h, k);
    }
    all.add(track);
  }
  return all;
}

// Leaves out helpers that nothing follows.
void collect(const SkinningProblem& problem, const Alternation& fitted, const BoneTracks& bones,
             SkinningDecomposition& out) {
  const std::size_t rigBones = bones.boneCount() - fitted.parents().size();
  std::vector<double> mass(fitted.parents().size(), 0.0);
  std::vector<Vec3> moment(mass.size(), Vec3::Zero());
  out.weights = fitted.weights();
  for (std::size_t i = 0; i < out.weights.size(); ++i) {
    for (std::size_t k = 0; k < PointWeights::kMost && out.weights[i].weight[k] > 0; ++k) {
      if (out.weights[i].joint[k] < rigBones) continue;
      const std::size_t h = out.weights[i].joint[k] - rigBones;
      const auto w = static_cast<double>(out.weights[i].weight[k]);
      mass[h] += w;
      moment[h] += w * problem.rest_m[i];
    }
  }
  std::vector<std::uint16_t> number(mass.size(), 0);
  for (std::size_t h = 0; h < mass.size(); ++h) {
    if (mass[h] <= 0) continue;
    number[h] = static_cast<std::uint16_t>(rigBones + out.helpers.size());
    const std::span<const Transform> track = bones.track(rigBones + h);
    out.helpers.push_back({{track.begin(), track.end()}, moment[h] / mass[h], fitted.parents()[h]});
  }
  for (PointWeights& w : out.weights) {
    for (std::size_t k = 0; k < PointWeights::kMost && w.weight[k] > 0; ++k) {
      if (w.joint[k] >= rigBones) w.joint[k] = number[w.joint[k] - rigBones];
    }
  }
}

void check(std::span<const Eigen::Vector3f> rest, std::span<const PointWeights> weights,
           const std::vector<std::vector<Transform>>& bones, const PointFrames& frames,
           const DecompositionOptions& options) {
  if (rest.empty() || frames.empty() || bones.size() != frames.size() || bones[0].empty() ||
      weights.size() != rest.size()) {
    throw Error("a skinning decomposition needs points, weights, and bones for every frame");
  }
  if (options.influences < 1 || options.influences > static_cast<int>(PointWeights::kMost) ||
      options.helperBones < 0 || options.helperBones > 512) {
    throw Error("a skinning decomposition takes 1 to 8 influences and 0 to 512 helper bones");
  }
  for (std::size_t f = 0; f < frames.size(); ++f) {
    if (frames[f].size() != rest.size() || bones[f].size() != bones[0].size()) {
      throw Error("every frame of a skinning decomposition must be as long as the rest shape");
    }
    for (const Eigen::Vector3f& p : frames[f]) {
      if (!p.allFinite()) throw Error("a simulated point is not a number");
    }
  }
}

}  // namespace

SkinningDecomposition decomposeSkinning(std::span<const Eigen::Vector3f> rest,
                                        std::span<const std::array<std::uint32_t, 3>> triangles,
                                        std::span<const PointWeights> weights,
                                        const std::vector<std::vector<Transform>>& bones,
                                        const PointFrames& frames,
                                        const DecompositionOptions& options) {
  check(rest, weights, bones, frames, options);
  const PointGraph graph(rest.size(), triangles);
  const std::vector<std::size_t> chosen = fittedFrames(frames.size());
  const SkinningProblem some = problemOf(rest, frames, chosen);
  Alternation alternation(some, graph, weights, tracksOf(bones, chosen), options);
  alternation.run();

  std::vector<std::size_t> every(frames.size());
  std::iota(every.begin(), every.end(), std::size_t{0});
  const SkinningProblem all = problemOf(rest, frames, every);
  BoneTracks tracks = spreadHelpers(alternation, chosen, tracksOf(bones, every));
  fitHelperMotions(all, alternation.weights(), bones[0].size(), 4, tracks);

  SkinningDecomposition out;
  std::vector<double> error_m2;
  squaredErrors(all, alternation.weights(), tracks, error_m2);
  out.rms_m = rmsOf(error_m2, frames.size());
  out.max_m = largestError(all, alternation.weights(), tracks);
  collect(all, alternation, tracks, out);
  return out;
}

}  // namespace fascia
