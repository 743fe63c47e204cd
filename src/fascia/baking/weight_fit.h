#pragma once

#include <span>
#include <vector>

#include <fascia/baking/bone_moments.h>
#include <fascia/baking/bone_tracks.h>
#include <fascia/baking/point_graph.h>
#include <fascia/baking/simplex_least_squares.h>

namespace fascia {

// Where a helper is at home.
struct HelperPlace {
  int parent = 0;  // the rig's joint that it hangs from
  Vec3 center_m = Vec3::Zero();
  double reach_m = 0;  // points farther away are not offered it
};

// Finds the weights of points for bones whose motion is known.
//
// A point is only offered bones of its own neighbourhood: joints that the rig gives to points
// around it, and helpers that are near and hang from one of these or from a joint next to them.
// That keeps a left hand from following a right foot that happens to move alike in this one motion.
//
// Where the motion leaves a choice, two weak terms decide: weights like the neighbours' (Le & Deng
// 2014 do so with a Laplacian), and weights that agree with the rig's own when a helper counts as
// its parent joint — so that other motions, in which helpers rest on their parents, look as before.
class WeightFit {
 public:
  WeightFit(const SkinningProblem& problem, const PointGraph& graph,
            std::span<const PointWeights> rigWeights, const BoneTracks& rigBones, int influences);

  // Of all points. `bones`: the rig's as they were given, then helpers. `weights` is start and
  // result; neighbours count as they were before.
  void fit(const BoneTracks& bones, std::span<const HelperPlace> helpers,
           std::vector<PointWeights>& weights);

 private:
  // A bone that a point may follow.
  struct Offer {
    double error = 0;       // squared, if the bone carried the point alone
    double withTarget = 0;  // Σ (T p̃)·x
    std::size_t bone = 0;
  };
  struct Scratch;
  struct Task;
  PointWeights fitPoint(const Task& task, std::size_t point, Scratch& scratch) const;
  bool mayFollow(std::size_t point, const HelperPlace& helper) const;
  void offerBones(const Task& task, std::size_t point, Scratch& scratch) const;
  void addNeighborTerm(const Task& task, std::size_t point, Scratch& scratch) const;
  Offer offerOf(std::size_t bone, const Eigen::Vector4d& p, const Scratch& scratch) const;
  void findNearbyJoints();
  void findJointOffers();
  void findAdjacentJoints();

  const SkinningProblem& problem_;
  const PointGraph& graph_;
  std::span<const PointWeights> rig_;
  std::size_t rigBoneCount_;
  int influences_;
  double stiffness_m2_;                             // of both weak terms, per frame
  std::vector<std::vector<std::uint16_t>> nearby_;  // per point: joints around it, increasing
  std::vector<bool> adjacent_;                      // joint * rigBoneCount + joint
  BoneMoments moments_;
  std::vector<std::vector<Offer>> jointOffers_;  // per point: of its nearby joints, the same always
};

}  // namespace fascia
