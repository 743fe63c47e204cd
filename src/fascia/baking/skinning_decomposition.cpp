#include <fascia/baking/skinning_decomposition.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fascia/baking/blended_frames.h>
#include <fascia/baking/bone_tracks.h>
#include <fascia/baking/helper_moments.h>
#include <fascia/baking/helper_search.h>
#include <fascia/base/error.h>
#include <fascia/base/parallel.h>

namespace fascia {
namespace {

// Longer motions are fitted in this many frames, evenly spread; all frames are fitted at the end
// with the weights found. More frames hardly change the weights, but cost time in proportion.
constexpr std::size_t kFramesOfOneMotion = 90;
// … and so many more for every further motion, up to a bound.
constexpr std::size_t kMoreFrames = 8, kMostFramesOfAll = 240;
// Frames whose helpers are fitted at once: bounds the memory that long motions take.
constexpr std::size_t kFramesPerBlock = 128;
constexpr int kLastSweeps = 6, kSweepsFromRest = 30;  // the latter have a longer way to go
// Of the model's size: a surface that stays this near to the rig's own skinning needs no helpers.
constexpr double kPlain = 2e-5;

struct FittedFrames {
  std::vector<std::size_t> frames;  // increasing
  std::vector<FrameRange> motions;  // which of them are each one motion
};

// Each motion gets its share, and both of its ends.
FittedFrames fittedFrames(std::size_t count, std::vector<std::size_t> motionFrames) {
  if (motionFrames.empty()) motionFrames.push_back(count);
  const std::size_t budget =
      std::min(kMostFramesOfAll, kFramesOfOneMotion + kMoreFrames * (motionFrames.size() - 1));
  FittedFrames out;
  std::size_t first = 0;
  for (const std::size_t length : motionFrames) {
    const std::size_t before = out.frames.size();
    const std::size_t share =
        std::min(length, std::max<std::size_t>(2, budget * length / std::max(count, budget)));
    for (std::size_t k = 0; k < share; ++k) {
      out.frames.push_back(first + (share < 2 ? 0 : k * (length - 1) / (share - 1)));
    }
    if (share > 0) out.motions.push_back({before, out.frames.size()});
    first += length;
  }
  return out;
}

std::vector<Vec3> doubles(std::span<const Eigen::Vector3f> points) {
  std::vector<Vec3> out;
  out.reserve(points.size());
  for (const Eigen::Vector3f& p : points) out.push_back(p.cast<double>());
  return out;
}

// Frames of a surface, and those in which it shall be kept, as one.
SkinningProblem problemOf(std::span<const Eigen::Vector3f> rest, const PointFrames& frames,
                          std::span<const std::size_t> chosen, const PointFrames& kept = {}) {
  SkinningProblem problem;
  problem.frameCount = chosen.size() + kept.size();
  problem.rest_m = doubles(rest);
  problem.target_m.resize(rest.size() * problem.frameCount);
  for (std::size_t k = 0; k < problem.frameCount; ++k) {
    const std::vector<Eigen::Vector3f>& frame =
        k < chosen.size() ? frames[chosen[k]] : kept[k - chosen.size()];
    for (std::size_t i = 0; i < rest.size(); ++i) {
      problem.target_m[i * problem.frameCount + k] = frame[i];
    }
  }
  return problem;
}

BoneTracks tracksOf(const BoneFrames& bones, std::span<const std::size_t> chosen,
                    const BoneFrames& kept = {}) {
  BoneTracks tracks(chosen.size() + kept.size());
  std::vector<Transform> track;
  for (std::size_t b = 0; b < bones[0].size(); ++b) {
    track.clear();
    for (const std::size_t f : chosen) track.push_back(bones[f][b]);
    for (const std::vector<Transform>& pose : kept) track.push_back(pose[b]);
    tracks.add(track);
  }
  return tracks;
}

// Helpers' motions in all frames: at first as they lie to their parents in the nearest fitted
// frame; on them where there is none.
class HelperSpread {
 public:
  HelperSpread(std::span<const Eigen::Vector3f> rest, const SkinningDecomposition& found,
               const BoneFrames& bones)
      : rest_(rest), found_(found), bones_(bones) {}

  // The frames of `bones` that the helpers' tracks belong to, increasing.
  void startFrom(std::span<const std::size_t> fitted) { fitted_ = fitted; }

  // Helper, frame.
  std::vector<std::vector<Transform>> run(const PointFrames& targets) {
    return run(&targets, {}, false);
  }
  // … and the errors.
  std::vector<std::vector<Transform>> runAndMeasure(const PointFrames& targets) {
    return run(&targets, {}, true);
  }
  // … where the targets are what these weights make of the rig's own bones.
  std::vector<std::vector<Transform>> runTo(std::span<const PointWeights> targetWeights) {
    return run(nullptr, targetWeights, false);
  }
  double rms_m() const {
    return std::sqrt(sum_m2_ / static_cast<double>(rest_.size() * bones_.size()));
  }
  double max_m() const { return std::sqrt(max_m2_); }

 private:
  std::vector<std::vector<Transform>> run(const PointFrames* targets,
                                          std::span<const PointWeights> targetWeights,
                                          bool measured) {
    std::vector<std::vector<Transform>> tracks(found_.helpers.size());
    const std::vector<Vec3> rest = doubles(rest_);
    const std::size_t rigBones = bones_.empty() ? 0 : bones_[0].size();
    const HelperMoments moments(rest, found_.weights, rigBones, rigBones + tracks.size(),
                                targetWeights);
    for (std::size_t first = 0; first < bones_.size(); first += kFramesPerBlock) {
      const std::size_t last = std::min(bones_.size(), first + kFramesPerBlock);
      block(moments, targets, first, last, measured, tracks);
    }
    return tracks;
  }

  void block(const HelperMoments& moments, const PointFrames* targets, std::size_t first,
             std::size_t last, bool measured, std::vector<std::vector<Transform>>& tracks) {
    std::vector<std::size_t> chosen(last - first);
    std::iota(chosen.begin(), chosen.end(), first);
    SkinningProblem problem;
    if (targets) problem = problemOf(rest_, *targets, chosen);
    BoneTracks all = tracksOf(bones_, chosen);
    const std::size_t rigBones = all.boneCount();
    for (std::size_t h = 0; h < tracks.size(); ++h) all.add(start(h, first, last));
    moments.fit(targets ? &problem : nullptr, fitted_.empty() ? kSweepsFromRest : kLastSweeps, all);
    for (std::size_t h = 0; h < tracks.size(); ++h) {
      const std::span<const Transform> track = all.track(rigBones + h);
      tracks[h].insert(tracks[h].end(), track.begin(), track.end());
    }
    if (!measured) return;
    for (const PointError& e : pointErrors(problem, found_.weights, all, {0, chosen.size()})) {
      sum_m2_ += e.sum_m2;
      max_m2_ = std::max(max_m2_, e.largest_m2);
    }
  }

  std::vector<Transform> start(std::size_t helper, std::size_t first, std::size_t last) const {
    const auto parent = static_cast<std::size_t>(found_.helpers[helper].parent);
    std::vector<Transform> track;
    std::size_t k = 0;
    for (std::size_t f = first; f < last; ++f) {
      while (k + 1 < fitted_.size() && fitted_[k + 1] + fitted_[k] <= 2 * f) ++k;
      if (fitted_.empty()) {
        track.push_back(bones_[f][parent]);
      } else if (f == fitted_[k]) {
        track.push_back(found_.helpers[helper].world[k]);
      } else {
        track.push_back(bones_[f][parent] * bones_[fitted_[k]][parent].inverse() *
                        found_.helpers[helper].world[k]);
      }
    }
    return track;
  }

  std::span<const Eigen::Vector3f> rest_;
  const SkinningDecomposition& found_;
  const BoneFrames& bones_;
  std::span<const std::size_t> fitted_;
  double sum_m2_ = 0, max_m2_ = 0;
};

// Leaves out helpers that nothing follows.
void collect(std::span<const Eigen::Vector3f> rest, const HelperSearch& fitted,
             SkinningDecomposition& out) {
  const std::size_t helpers = fitted.helpers().size();
  const std::size_t rigBones = fitted.bones().boneCount() - helpers;
  std::vector<double> mass(helpers, 0.0);
  std::vector<Vec3> moment(helpers, Vec3::Zero());
  out.weights = fitted.weights();
  for (std::size_t i = 0; i < out.weights.size(); ++i) {
    for (std::size_t k = 0; k < PointWeights::kMost && out.weights[i].weight[k] > 0; ++k) {
      if (out.weights[i].joint[k] < rigBones) continue;
      const std::size_t h = out.weights[i].joint[k] - rigBones;
      const auto w = static_cast<double>(out.weights[i].weight[k]);
      mass[h] += w;
      moment[h] += w * rest[i].cast<double>();
    }
  }
  std::vector<std::uint16_t> number(helpers, 0);
  for (std::size_t h = 0; h < helpers; ++h) {
    if (mass[h] <= 0) continue;
    number[h] = static_cast<std::uint16_t>(rigBones + out.helpers.size());
    const std::span<const Transform> track = fitted.bones().track(rigBones + h);
    out.helpers.push_back(
        {{track.begin(), track.end()}, moment[h] / mass[h], fitted.helpers()[h].parent});
  }
  for (std::size_t i = 0; i < out.weights.size(); ++i) {
    PointWeights& w = out.weights[i];
    for (std::size_t k = 0; k < PointWeights::kMost && w.weight[k] > 0; ++k) {
      if (w.joint[k] < rigBones) continue;
      w.joint[k] = number[w.joint[k] - rigBones];
      SkinningDecomposition::Helper& helper = out.helpers[w.joint[k] - rigBones];
      helper.radius_m =
          std::max(helper.radius_m, (rest[i].cast<double>() - helper.center_m).norm());
    }
  }
}

// Whether the rig's own skinning does it; fills in its errors.
bool isPlain(std::span<const Eigen::Vector3f> rest, std::span<const PointWeights> weights,
             const BoneFrames& bones, const PointFrames& frames, SkinningDecomposition& out) {
  const SkinningDecomposition plain{{}, {weights.begin(), weights.end()}};
  HelperSpread spread(rest, plain, bones);
  spread.runAndMeasure(frames);
  Box box;
  for (const Eigen::Vector3f& p : rest) box.add(p.cast<double>());
  if (spread.max_m() > kPlain * box.size().norm()) return false;
  out.weights = plain.weights;
  out.rms_m = spread.rms_m();
  out.max_m = spread.max_m();
  out.plain = true;
  return true;
}

void check(std::span<const Eigen::Vector3f> rest, std::span<const PointWeights> weights,
           const BoneFrames& bones, const PointFrames& frames,
           const DecompositionOptions& options) {
  if (rest.empty() || frames.empty() || bones.size() != frames.size() || bones[0].empty() ||
      weights.size() != rest.size()) {
    throw Error("a skinning decomposition needs points, weights, and bones for every frame");
  }
  if (options.influences < 1 || options.influences > static_cast<int>(PointWeights::kMost) ||
      std::min(options.helperBones, options.mostHelpers) < 0 ||
      std::max(options.helperBones, options.mostHelpers) > 512) {
    throw Error("a skinning decomposition takes 1 to 8 influences and 0 to 512 helper bones");
  }
  const std::vector<std::size_t>& lengths = options.motionFrames;
  if (!lengths.empty() &&
      std::accumulate(lengths.begin(), lengths.end(), std::size_t{0}) != frames.size()) {
    throw Error("the motions of a skinning decomposition must have all of its frames");
  }
  for (const std::vector<Transform>& pose : options.kept) {
    if (pose.size() != bones[0].size()) throw Error("every kept pose must have all bones");
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

PointFrames plainSkinning(std::span<const Eigen::Vector3f> rest,
                          std::span<const PointWeights> weights, const BoneFrames& bones) {
  PointFrames frames(bones.size(), std::vector<Eigen::Vector3f>(rest.size()));
  parallelFor(frames.size(), [&](std::size_t f) {
    for (std::size_t i = 0; i < rest.size(); ++i) {
      frames[f][i] = blendBones(weights[i], bones[f]).point(rest[i].cast<double>()).cast<float>();
    }
  });
  return frames;
}

std::vector<std::vector<Transform>> fitHelpers(std::span<const Eigen::Vector3f> rest,
                                               const SkinningDecomposition& found,
                                               const BoneFrames& bones,
                                               const PointFrames& targets) {
  return HelperSpread(rest, found, bones).run(targets);
}

std::vector<std::vector<Transform>> fitHelpersToSkinning(std::span<const Eigen::Vector3f> rest,
                                                         const SkinningDecomposition& found,
                                                         const BoneFrames& bones,
                                                         std::span<const PointWeights> weights) {
  return HelperSpread(rest, found, bones).runTo(weights);
}

double restingError_m(std::span<const Eigen::Vector3f> rest, const SkinningDecomposition& found,
                      const BoneFrames& bones, const PointFrames& targets) {
  std::vector<double> largest(bones.size(), 0.0);
  parallelFor(bones.size(), [&](std::size_t f) {
    std::vector<Transform> all = bones[f];
    for (const auto& helper : found.helpers) {
      all.push_back(bones[f][static_cast<std::size_t>(helper.parent)]);
    }
    for (std::size_t i = 0; i < rest.size(); ++i) {
      const Vec3 p = blendBones(found.weights[i], all).point(rest[i].cast<double>());
      largest[f] = std::max(largest[f], (p - targets[f][i].cast<double>()).norm());
    }
  });
  return largest.empty() ? 0 : *std::max_element(largest.begin(), largest.end());
}

SkinningDecomposition decomposeSkinning(std::span<const Eigen::Vector3f> rest,
                                        std::span<const std::array<std::uint32_t, 3>> triangles,
                                        std::span<const PointWeights> weights,
                                        const BoneFrames& bones, const PointFrames& frames,
                                        const DecompositionOptions& options) {
  check(rest, weights, bones, frames, options);
  SkinningDecomposition out;
  if (isPlain(rest, weights, bones, frames, out)) return out;
  const PointGraph graph(rest.size(), triangles);
  const FittedFrames fitted = fittedFrames(frames.size(), options.motionFrames);
  const std::vector<std::size_t>& chosen = fitted.frames;
  const SkinningProblem problem =
      problemOf(rest, frames, chosen, plainSkinning(rest, weights, options.kept));
  HelperSearch search(problem, fitted.motions, graph, weights,
                      tracksOf(bones, chosen, options.kept), options);
  search.run();
  collect(rest, search, out);
  HelperSpread spread(rest, out, bones);
  spread.startFrom(chosen);
  std::vector<std::vector<Transform>> tracks = spread.runAndMeasure(frames);
  for (std::size_t h = 0; h < tracks.size(); ++h) out.helpers[h].world = std::move(tracks[h]);
  out.rms_m = spread.rms_m();
  out.max_m = spread.max_m();
  return out;
}

}  // namespace fascia
