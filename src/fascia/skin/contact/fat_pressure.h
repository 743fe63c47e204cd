#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/base/ids.h>
#include <fascia/skin/mesh/triangle_membrane.h>
#include <fascia/skin/point/point_model.h>

namespace fascia {

// Fat that keeps its volume. The fat over one solid is a layer with the volume change
//
//   ΔV = Σ N·(r − a) − the same at rest,   N = a third of the area vectors of the triangles around,
//
// r a point of the skin and a its strand's anchor, which goes where flesh and joints carry the
// point. ΔV answers with one pressure p = −B ΔV/V0 in the whole layer, a force p N on each of its
// points: what is pressed in at one place swells elsewhere over the same solid.
struct FatPressureModel {
  struct Layer {
    std::uint32_t first, count;  // of `points`
    double volume_m3;            // V0
    double rest_m3;              // Σ N·(r − a) at rest
    double tissueRate2_per_s2;   // ω² of the layer's volume on its strands, mass not added
  };
  double bulk_Pa = 0;
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
};

// Without layers where no point has fat.
FatPressureModel prepareFatPressure(const FatPressureInput& input);

// The pressure's forces, once per interval and constant over it. Owns the memory that takes.
class FatPressure {
 public:
  FatPressure() = default;
  // The model must outlive this.
  explicit FatPressure(const FatPressureModel& model, std::size_t storage);

  // Forces (N) for an interval that starts in the given state; 0 for points without fat. p follows
  // the volume that the layer would have at the interval's end if nothing held it, divided as
  // backward Euler does: it never takes back more than the error, however large B is.
  const VectorArray& press(const StepCoefficients& step, const PointSurroundings& around,
                           double duration_s, const VectorArray& position,
                           const VectorArray& velocity);
  // Of the last call, per layer, Pa.
  std::span<const double> pressures_Pa() const { return pressures_; }

 private:
  double pressure(const FatPressureModel::Layer& layer, const StepCoefficients& step,
                  const PointSurroundings& around, double duration_s, const VectorArray& position,
                  const VectorArray& velocity) const;

  const FatPressureModel* model_ = nullptr;
  VectorArray area_, force_;  // per storage index: N, m²; p N
  std::vector<double> pressures_;
};

}  // namespace fascia
