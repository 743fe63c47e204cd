#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/base/ids.h>
#include <fascia/skin/mesh/triangle_membrane.h>
#include <fascia/skin/point/point_model.h>
#include <fascia/skin/point/step_inputs.h>

namespace fascia {

// Fat that keeps its volume. The fat over one solid is a layer; ΔV is how far its volume is from
// that at rest,
//
//   V = V_c + Σ N·(r − c),   V_c = Σ N̄·(c − a),   N̄ = (N(a) + 4 N((a + c)/2) + N(c))/6,
//
// r a point of the skin, c where flesh and joints carry it, a its strand's inner end, N = N(c) a
// third of the area vectors of the triangles around it. V_c is exactly what lies between the
// triangles of a and c, whose area vectors are quadratic on the way from one to the other. ΔV
// answers with one pressure p = −B ΔV/V0 in the whole layer, a force p N on each of its points,
// where N is the gradient of V: what is pressed in at one place swells elsewhere over the same
// solid.
//
// N is that of c, halfway through an interval, not of r, which a true pressure would take: p N(r)
// makes points of fine meshes swing across each other, the more the finer they are and the longer
// N(r) waits to be computed anew. Both are the same but for what the skin has turned away from its
// flesh.
struct FatPressureModel {
  struct Layer {
    std::uint32_t first, count;  // of `points`
    double volume_m3;            // V0: between the skin and as deep below it as its fat is thick
    double rest_m3;              // V at rest
  };
  double bulk_Pa = 0;
  bool reachesAnchors = false;  // else V_c counts as 0: where c is, there is no change
  std::vector<Layer> layers;
  std::vector<std::uint32_t> points;  // storage indices, layer by layer, ascending in each
  std::vector<TriangleMembrane::Corners> triangles;  // those around `points`
};

struct FatPressureInput {
  double bulk_Pa;
  std::span<const TriangleMembrane::Corners> triangles;  // of storage indices
  const VectorArray& rest;                               // skin and anchors in the rest posture
  const VectorArray& anchor;
  const FloatArray& fat;           // m, per storage index
  std::span<const SolidId> solid;  // over which a point lies; invalid: it has no fat
  const PointModel& points;        // those that are not free have no fat either
  bool reachesAnchors;             // strands begin at the fat's inner side
};

// Without layers where no point has fat.
FatPressureModel prepareFatPressure(const FatPressureInput& input);

// The pressure's forces over one interval. Owns the memory that takes.
//
// The leapfrog takes all other forces where a step starts, and this pressure where it ends. With
// the gain G = h/M' and the change of volume ΔV⁰ before a step,
//
//   1. the step itself, with the force p⁰ N, p⁰ = −B ΔV⁰/V0, comes to ΔV*,
//   2. then v += G N δp, r += h G N δp,   δp = −(B/V0)(ΔV* − ΔV⁰)/(1 + α),   α = h (B/V0) Σ G N²,
//
// after which p = p⁰ + δp is −B ΔV/V0 again, at the step's end. α divides only the change of p: at
// rest p is the one that B names, whatever h is, and points that something holds feel it in full.
//
// It is stable with every B and h that the leapfrog is stable with. In M'(r⁺ − 2r + r⁻)/h² =
// −K r − k N Nᵀ r⁺, k = B/V0, write r⁺ = (r⁺ + r⁻)/2 + (r⁺ − r⁻)/2. The second half only damps; the
// first is Newmark's scheme with β = 1/2 for k N Nᵀ, which keeps the energy ½ vᵀ(M' − h²K/4 +
// h²k N Nᵀ/4) v + ½ r̄ᵀ(K + k N Nᵀ) r̄, r̄ the mean of r and r⁺. That is positive: h²K ≤ 4 M'
// (leapfrog.h).
class FatPressure final : public StepEnd {
 public:
  FatPressure() = default;
  // The model must outlive this.
  explicit FatPressure(const FatPressureModel& model, std::size_t storage);

  // What carries points over an interval: c and a at its start and end, between which they go
  // evenly.
  struct Way {
    const VectorArray &carried, &carriedToEnd;
    const VectorArray &anchor, &anchorAtEnd;
    double duration_s;
  };
  // For an interval that starts in the given state. `step` must outlive it.
  void begin(const StepCoefficients& step, const Way& way, const VectorArray& position);
  // In newtons, for the step that comes; 0 for points without fat.
  const VectorArray& force() const { return force_; }
  void stepped(float time_s, VectorArray& position, VectorArray& velocity) override;
  // At the end of the last step, per layer.
  std::span<const double> pressures_Pa() const { return pressures_; }

 private:
  // Of an interval.
  struct Interval {
    double carried_m3, rate_m3_per_s;  // V_c less V at rest, at the start
    double answer;                     // h Σ G N², m³/Pa
  };
  double change_m3(std::size_t layer, float time_s, const VectorArray& position) const;
  void measureCarried(const Way& way);
  double held_Pa(double pressure_Pa) const;
  void push(const FatPressureModel::Layer& layer, double pressure_Pa);

  const FatPressureModel* model_ = nullptr;
  const StepCoefficients* step_ = nullptr;
  VectorArray area_, force_;  // per storage index: N, m²; p N
  VectorArray carried_, carriedVelocity_;
  VectorArray halfway_, meanArea_;  // between a and c; N̄
  std::vector<Interval> interval_;
  std::vector<double> pressures_;
};

}  // namespace fascia
