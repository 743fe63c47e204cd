#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/math/types.h>
#include <fascia/rig/rigged_model.h>

namespace fascia {

// Carries points of an imported mesh along with its joints: where the flesh under each point goes
// when only the bones move. Rotations are blended as quaternions about a centre of rotation, the
// translation follows from the linear blend of that centre (Le & Hodgins 2016), so that nothing
// collapses or twists shut at a joint as under linear blend skinning. The centre is found in closed
// form: joints count by how much of the point's weight hangs on either side of them, s (1 − s);
// a point between two bones turns about the joint that connects them.
class JointCarrier {
 public:
  struct Joint {
    std::size_t skeletonJoint;  // index into the pose's joints
    int parent;                 // index of another entry, smaller; -1: a root
    Transform rest_world;       // of the skeleton's joint
  };
  struct Point {
    std::size_t point;  // storage index
    Vec3 rest_world;
    PointWeights weights;  // joint: index into `joints`
  };

  JointCarrier() = default;
  JointCarrier(std::vector<Joint> joints, std::span<const Point> points);

  std::size_t pointCount() const { return storage_.size(); }
  // Writes where each point is carried; other entries of `out` keep what is there.
  // `motion` is scratch.
  struct Motion {
    Eigen::Vector4f turn;       // quaternion (x, y, z, w), from rest to now
    Eigen::Vector4f column[4];  // of the 3 x 4 matrix, w = 0
  };
  void place(std::span<const Transform> joints, std::vector<Motion>& motion,
             VectorArray& out) const;

 private:
  struct Influence {
    std::uint32_t joint;
    float weight;
  };
  void placeRange(const std::vector<Motion>& motion, std::size_t begin, std::size_t end,
                  VectorArray& out) const;

  std::vector<Joint> joints_;
  std::vector<Transform> inverseRest_;
  std::vector<std::uint32_t> storage_;         // per point
  std::vector<std::uint32_t> firstInfluence_;  // per point, one more at the end
  std::vector<Influence> influences_;          // heaviest first
  std::vector<Eigen::Vector4f> center_;        // per point, w = 1
  std::vector<Eigen::Vector4f> arm_;           // from the centre to the point, w = 0
};

// How much of a point hangs on each joint or one beyond it, one entry per joint.
void subtreeShares(std::span<const JointCarrier::Joint> joints, const PointWeights& weights,
                   std::span<double> shares);

}  // namespace fascia
