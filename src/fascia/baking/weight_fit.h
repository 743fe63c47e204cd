#pragma once

#include <span>
#include <vector>

#include <fascia/baking/bone_tracks.h>
#include <fascia/baking/point_graph.h>
#include <fascia/baking/simplex_least_squares.h>

namespace fascia {

// Finds the weights of points for bones whose motion is known.
//
// A point is only offered bones of its own neighbourhood: joints that the rig gives to points
// around it, and helpers that hang from one of these or from a joint next to them. That keeps a
// left hand from following a right foot that happens to move alike in this one motion.
//
// Where the motion leaves a choice, two weak terms decide: weights like the neighbours' (Le & Deng
// 2014 do so with a Laplacian), and weights that agree with the rig's own when a helper counts as
// its parent joint — so that other motions, in which helpers rest on their parents, look as before.
class WeightFit {
 public:
  WeightFit(const SkinningProblem& problem, const PointGraph& graph,
            std::span<const PointWeights> rigWeights, std::size_t rigBoneCount, int influences);

  // parents: the rig's joint of every helper among the bones. `weights` is start and result.
  void fit(const BoneTracks& bones, std::span<const int> parents,
           std::span<const std::uint32_t> points, std::vector<PointWeights>& weights) const;

  // Whether a helper that hangs from a joint may be offered to a point.
  bool mayFollow(std::size_t point, int parent) const;

 private:
  PointWeights fitPoint(const BoneTracks& bones, std::span<const int> parents, std::size_t point,
                        std::span<const PointWeights> before) const;
  // At most kMostCandidates bones, those first that carry the point best by themselves.
  std::vector<std::size_t> candidates(const BoneTracks& bones, std::span<const int> parents,
                                      std::size_t point) const;
  void addNeighborTerm(std::span<const std::size_t> offered, std::size_t point,
                       std::span<const PointWeights> before, CandidateMatrix& G,
                       CandidateVector& g) const;
  void addRigTerm(std::span<const std::size_t> offered, std::span<const int> parents,
                  std::size_t point, CandidateMatrix& G, CandidateVector& g) const;
  void findNearbyJoints();
  void findAdjacentJoints();

  const SkinningProblem& problem_;
  const PointGraph& graph_;
  std::span<const PointWeights> rig_;
  std::size_t rigBoneCount_;
  int influences_;
  double stiffness_m2_;                             // of both weak terms, per frame
  std::vector<std::vector<std::uint16_t>> nearby_;  // per point: joints around it, increasing
  std::vector<bool> adjacent_;                      // joint * rigBoneCount + joint
};

}  // namespace fascia
