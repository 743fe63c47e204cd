#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <fascia/pose/joint_motion.h>
#include <fascia/pose/pose_mesh.h>

namespace fascia {

// Figures made of pieces that lie on, in or beside each other (a doll's panels, clothes, armour):
// the pieces stay to each other as linear blending has them, which the artist has seen. What the
// stages of the pose function add to that, d = x - x_blend, is one field for all of them: near
// other pieces
//   d_i = Σ_j w_ij d_j,
// over all points j around i, of whatever piece, by their area and their distance at rest. Where
// two pieces coincide they get the same d; alone, a piece keeps its own. The lips of a slit in one
// piece are treated alike. Does nothing to a figure of one skin and trifles.
class ShellNesting {
 public:
  // Of one frame.
  struct Scratch {
    FrameArray added;
  };

  ShellNesting() = default;
  // `rigid` points stay where they are.
  ShellNesting(const PoseSource& source, const PoseMesh& mesh, std::span<const char> rigid);

  std::size_t pointCount() const { return points_.size(); }
  void nest(std::span<const JointMotion> motion, std::span<Vector4f> position,
            Scratch& scratch) const;

 private:
  struct Neighbour {
    std::uint32_t seen;  // of seen_
    float weight;
  };
  // A point whose displacement is read, and how it is blended.
  struct Seen {
    std::uint32_t point;
    Vector4f rest;
    PointWeights weights;
  };
  struct Point {
    std::uint32_t seen;
    float share;  // 0 as the piece has it … 1 as all around have it
    std::uint32_t firstNeighbour, neighbours;
  };

  std::vector<Seen> seen_;
  std::vector<Point> points_;
  std::vector<Neighbour> neighbours_;
};

}  // namespace fascia
