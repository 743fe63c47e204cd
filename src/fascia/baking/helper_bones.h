#pragma once

#include <span>
#include <vector>

#include <fascia/baking/bone_tracks.h>
#include <fascia/baking/point_graph.h>

namespace fascia {

// The rotation and translation that bring points nearest to targets, weighted, by the singular
// values of their correlation (Kabsch 1976). Sums are collected first, then solved.
class RigidFit {
 public:
  explicit RigidFit(const Vec3& origin_m) : origin_m_(origin_m) {}

  // Minimises Σ |share (T p) - target|²: share 1 is the usual fit; others are Le & Deng 2012,
  // eqs. 8 to 12, where the bone carries only a part of the point.
  void add(const Vec3& p, double share, const Vec3& target);

  // `like` decides what the points leave open (fewer than three, or all in a line).
  Transform solve(const Transform& like) const;

 private:
  Vec3 origin_m_;  // sums are taken from here, near the points, to keep digits
  double mass_ = 0, spread_ = 0;
  Vec3 point_ = Vec3::Zero(), target_ = Vec3::Zero();
  Mat3 correlation_ = Mat3::Zero();
};

// Refits the motion of every bone from `firstHelper` on to what the other bones leave of the
// targets, one after the other, `sweeps` times; weights stay. All frames of `bones`.
void fitHelperMotions(const SkinningProblem& problem, std::span<const PointWeights> weights,
                      std::size_t firstHelper, int sweeps, BoneTracks& bones);

// A new helper for where the error is largest: its motion follows a patch of points rigidly.
struct HelperSeed {
  std::uint32_t point = 0;
  double radius_m = 0;  // of the patch
  int parent = 0;       // the rig's joint that moves most like it
  std::vector<Transform> track;
};

// At most `count` of them, far enough from each other to be fitted at once; fewer where no error is
// left. Places near `seeds`, those of helpers before, count less, as a helper that could not mend
// them will not the next time either; the new ones are added to them.
std::vector<HelperSeed> seedHelpers(const SkinningProblem& problem, const PointGraph& graph,
                                    std::span<const PointWeights> rigWeights,
                                    const BoneTracks& bones, std::span<const double> squaredError,
                                    std::size_t patchSize, std::size_t count,
                                    std::vector<std::uint32_t>& seeds);

}  // namespace fascia
