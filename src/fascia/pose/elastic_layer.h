#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <fascia/math/supernodal_cholesky.h>
#include <fascia/pose/joint_motion.h>
#include <fascia/pose/limb_parts.h>

namespace fascia {

// The elastic skin, quasi-static: the shape between the base pose b and the rest shape's detail
// that costs least bending,
//   min_u |M^-1/2 (C u - e)|² + |K^1/2 u|²,   x = b + u,
//   e_i = Σ_j w_ij [½ (R_i + R_j)(X_i - X_j) - (b_i - b_j)],
// which is one linear system (C M⁻¹ C + K) u = C M⁻¹ e with a constant matrix: C cotangent weights,
// M areas, R the base pose's rotations, K_i = A_i / ℓ_i⁴ the tissue that holds the skin to its base
// (Turner & Gobbetti 1998 §3; the bending energy of Sorkine et al. 2004 with rotations known from
// the weights instead of fitted). ℓ is the length over which the skin evens out: a share of the
// local radius. Exact where b is rigid.
class ElasticLayer {
 public:
  struct Scratch {
    FrameArray residual;
    std::vector<float> x, y, z;
    SupernodalCholesky::Scratch solver;
  };

  ElasticLayer() = default;
  // `tightness` per point, 0 … 1; 0.5 is the usual skin.
  ElasticLayer(const PoseSource& source, const PoseMesh& mesh, const LimbParts& parts,
               std::span<const float> tightness, std::span<const char> rigid);

  std::size_t nonZeros() const { return system_.nonZeros(); }
  void relax(std::span<const WideRotation> rotation, std::span<Vector4f> position,
             Scratch& scratch) const;

 private:
  struct Edge {
    Vector4f weighted;  // w_ij (X_i - X_j), and w_ij
    std::uint32_t to;
  };
  struct Point {
    Vector4f weightedSum;  // of its edges
    std::uint32_t point;
    float inverseArea;
    float noise;  // residual below which nothing has bent here, squared
  };
  void number(const PoseMesh& mesh, std::span<const float> way, std::span<const float> smoothing_m,
              std::span<const char> rigid);
  void storeEdges(const PoseMesh& mesh);
  void factorize(const PoseMesh& mesh, std::span<const float> smoothing_m);
  void bend(std::span<const WideRotation> rotation, std::span<const Vector4f> position,
            std::size_t begin, std::size_t end, FrameArray& residual) const;

  std::vector<std::uint32_t> solved_;  // points, the first ones of bent_ in the same order
  std::vector<Point> bent_;            // solved points, then their neighbours
  std::vector<std::uint32_t> bentOf_;  // per point: where in bent_, or none
  std::vector<std::uint32_t> firstEdge_;
  std::vector<Edge> edges_;
  SupernodalCholesky system_;
};

}  // namespace fascia
