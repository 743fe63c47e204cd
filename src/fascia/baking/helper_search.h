#pragma once

#include <span>
#include <vector>

#include <fascia/baking/bone_tracks.h>
#include <fascia/baking/helper_seeds.h>
#include <fascia/baking/point_graph.h>
#include <fascia/baking/weight_fit.h>

namespace fascia {

// Looks for helper bones and weights in frames that are all known: bones against weights, in turn.
//
// Helpers come in batches, where the error is largest; each batch is fitted before the next sees
// what is left. Then rounds refine all of them, as long as they help. If the error is above the
// tolerance after that, more helpers come.
class HelperSearch {
 public:
  // `motions`: the frames of the problem that are each one motion; errors count in these.
  HelperSearch(const SkinningProblem& problem, std::vector<FrameRange> motions,
               const PointGraph& graph, std::span<const PointWeights> rigWeights, BoneTracks bones,
               const DecompositionOptions& options);

  void run();

  const BoneTracks& bones() const { return bones_; }  // the rig's, then helpers
  const std::vector<HelperPlace>& helpers() const { return helpers_; }
  const std::vector<PointWeights>& weights() const { return weights_; }

 private:
  void grow(int wanted);
  void growFurther();
  bool mayGrow(double timesTolerance) const;
  void refine();
  void round();
  bool moveIdleHelpers();
  std::vector<HelperSeed> seeds(std::size_t count);
  void place(std::size_t helper, const HelperSeed& seed);
  void updateReach();
  int nextCount() const;
  double rms_m();  // of the motion that has the largest
  static double workOf(int from, int to);
  double refiningOf(int helpers) const;

  const SkinningProblem& problem_;
  std::vector<FrameRange> motions_;
  const PointGraph& graph_;
  std::span<const PointWeights> rig_;
  std::size_t rigBoneCount_;
  const DecompositionOptions& options_;
  WeightFit fit_;
  BoneTracks bones_;
  std::vector<HelperPlace> helpers_;
  std::vector<PointWeights> weights_;
  std::vector<std::uint32_t> seeds_;
  std::vector<double> error_m2_;
  double size_m_ = 0, error_m_ = 0;
  bool exhausted_ = false;         // there is no place for another helper
  double done_ = 0, planned_ = 1;  // of the work, in rounds times bones
  double told_ = 0;
};

}  // namespace fascia
