#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <fascia/pose/joint_motion.h>
#include <fascia/pose/limb_parts.h>

namespace fascia {

// Skin against skin in creases: where the limb of a point, A, has sunk into the limb B that it
// hangs together with, both sides meet on the surface of equal depth f_A = f_B (the exact contact
// surface of Cani-Gascuel & Desbrun 1997). With h = f_A - f_B - c, c what A and B overlap at rest
// at that point, a point with h > 0 is moved by -h ∇h / |∇h|². Everything that decides whether a
// touch counts is a smooth gate between 0 and 1 (the gradient-controlled operators of Gourmel et
// al. 2013 in spirit): a contact comes and goes without a jump as joints turn.
class LimbContact {
 public:
  struct Hit {
    std::int32_t pair = -1;  // of pairs_, or none
    float depth_m = 0;       // h
    float gate = 0;
  };
  // Of one frame.
  struct Scratch {
    std::vector<Hit> hit;          // per point
    std::vector<float> pairDepth;  // per pair: deepest gated h
    std::vector<float> pairGate;
    std::vector<std::vector<std::uint32_t>> near;  // per cluster: pairs
    std::vector<std::uint32_t> active;             // points that the last word moves
    std::vector<std::uint8_t> ring;                // per point: 0 untouched, 1 hit, 2 … near it
    std::vector<float> influence, influenceNext;   // per point: of the hits around it, 0 … 1
    FrameArray before, next;
    bool touched = false;
  };

  LimbContact() = default;
  LimbContact(const PoseSource& source, const PoseMesh& mesh,
              std::shared_ptr<const LimbParts> parts, std::span<const char> rigid);

  // How far each joint is bent against the body above it: 0 straight … 1. A twist makes no crease.
  void measureBend(std::span<const JointMotion> motion, std::span<float> bend) const;
  // Brings both sides of every contact together; hit points turn with their own bone.
  void meet(std::span<const JointMotion> motion, std::span<const float> bend,
            std::span<Vector4f> position, std::span<Vector4f> turn,
            std::span<WideRotation> rotation, Scratch& scratch) const;
  // 1 where meet() found nothing, down to 0 where a point is in contact.
  static float freedom(const Scratch& scratch, std::size_t point) {
    return scratch.hit[point].pair < 0 ? 1.f : 1 - scratch.hit[point].gate;
  }
  // The last word of a frame, after what other stages displaced: the surroundings of contacts relax
  // towards the rotated rest shape, and hit points end on their side, exactly.
  void finish(std::span<const JointMotion> motion, std::span<const WideRotation> rotation,
              std::span<Vector4f> position, Scratch& scratch) const;

 private:
  struct Pair {
    std::uint32_t a, b;     // skin of a against the body of b
    std::int32_t mirror;    // the pair (b, a), or none
    std::uint32_t bending;  // the joint whose bend makes the crease
    std::uint32_t overlap;  // first of overlap_m_, one per skin point of a
  };
  struct Cluster {
    std::uint32_t home;
    std::vector<std::uint32_t> points;
  };
  struct Edge {
    Vector4f weighted;  // w (X_i - X_j), and w
    std::uint32_t to;
  };

  void findPairs(const PoseSource& source, const PoseMesh& mesh);
  bool addPair(const PoseSource& source, const PoseMesh& mesh, std::uint32_t a, std::uint32_t b);
  void findClusters(const PoseMesh& mesh, std::span<const char> rigid);
  void storeEdges(const PoseMesh& mesh);

  void cull(std::span<const JointMotion> motion, std::span<const float> bend,
            std::span<const Vector4f> position, Scratch& scratch) const;
  void findHits(std::span<const JointMotion> motion, std::span<const Vector4f> position,
                Scratch& scratch) const;
  void gatePairs(std::span<const float> bend, Scratch& scratch) const;
  Hit find(std::span<const JointMotion> motion, std::span<const std::uint32_t> near,
           std::uint32_t point, const Vector4f& x) const;
  Vector4f pushOut(std::span<const JointMotion> motion, const Pair& pair, std::uint32_t point,
                   const Vector4f& x, float share, float depth_m) const;
  void spreadActive(Scratch& scratch) const;

  std::shared_ptr<const LimbParts> parts_;
  std::vector<Pair> pairs_;
  std::vector<std::vector<std::uint32_t>> pairsOf_;  // per joint
  std::vector<float> overlap_m_;
  std::vector<Cluster> clusters_;
  std::vector<std::int32_t> clusterOf_;  // per point; -1: it meets nobody
  FrameArray rest_, normal_;
  std::vector<std::uint32_t> firstEdge_;
  std::vector<Edge> edges_;
  float noise_m_ = 0;
};

}  // namespace fascia
