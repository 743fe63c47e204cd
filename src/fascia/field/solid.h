#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/base/error.h>
#include <fascia/field/deformation.h>
#include <fascia/field/kernels.h>
#include <fascia/field/shape.h>
#include <fascia/geometry/triangle_mesh.h>
#include <fascia/math/types.h>

namespace fascia {

std::span<const Shape* const> shapes();              // every shape that files may name
std::span<const Deformation* const> deformations();  // every deformation
const Shape* findShape(std::string_view name);       // nullptr if there is none
const Deformation* findDeformation(std::string_view name);

// A shape with its parameters and the deformations applied to it in order; plain value.
// A parameter's path is "radius_m", or "taper.amount" (second taper: "taper2.amount").
struct SolidDef {
  struct Step {
    std::string type;                // a Deformation's name
    std::vector<double> parameters;  // in the order of its parameters(); missing = standard
    bool operator==(const Step&) const = default;
  };
  std::string shape = "sphere";
  std::vector<double> parameters;  // in the order of Shape::parameters(); missing = standard
  std::vector<Step> deformations;  // at most kMaxDeformations
  bool operator==(const SolidDef&) const = default;
};

// A SolidDef made ready: all parameters present in one flat array that keys and drivers write.
// Copying from a solid of the same definition allocates nothing.
class Solid {
 public:
  Solid() = default;  // empty: evaluate as the unit sphere, no parameters
  Solid(const SolidDef& def, const std::string& pointer, Diagnostics& diagnostics);

  std::size_t parameterCount() const { return values_.size(); }
  int parameterIndex(std::string_view path) const;  // -1 if there is none
  const ParameterInfo& parameterInfo(int index) const {
    return *layout_->infos[static_cast<std::size_t>(index)];
  }
  const std::string& parameterPath(int index) const {
    return layout_->paths[static_cast<std::size_t>(index)];
  }
  double parameter(int index) const { return values_[static_cast<std::size_t>(index)]; }
  void setParameter(int index, double value);          // clamped to its range; NaN is ignored
  void setParameters(std::span<const double> values);  // all of them, in one go

  const Shape& shape() const { return *layout_->shape; }
  bool deformed() const { return !layout_->steps.empty(); }
  const Box& bounds() const { return bounds_; }          // local, encloses the deformed surface
  Vec3 halfExtents_m() const { return halfExtents_m_; }  // of the undeformed shape
  // Corners around the shape that follow every change of its parameters: half sizes and
  // deformations as their own matter would, exponents by as much as the surface towards a corner.
  const std::array<Vec3, 8>& outline_m() const { return outline_m_; }
  double volume_m3() const;  // closed form; with deformations: of the tessellation
  TriangleMesh tessellate(int detail) const;

  // Signed distance estimate (m, negative inside) and outward unit normal at local points, batch.
  // Of an undeformed shape it never exceeds the true signed distance. Largest error for |d| up to a
  // tenth (a quarter) of the smallest half size, relative to that limit, half sizes within 1 : 4:
  //   sphere, capsule     exact (float rounding: 1e-6 of the largest half size)
  //   ellipsoid           0.02 % (6 %, near the inner focal points; 0.01 % for typical points)
  //   superellipsoid      exponents in [0.5, 1.25]: 1 % (6 %);  in [0.2, 2]: 10 % (20 %), at rims;
  //                       99 of 100 points: 0.05 % (1 %)
  //   deformed            first order in d: an undeformed distance over its gradient's length
  // p − d n lies on the surface up to that error, and never inside an undeformed shape.
  void evaluate(ConstVectors points_local, float* distance_m, Vectors normal_local) const;

  // Coordinates that follow the matter while parameters change. Undo the deformations; then the
  // shape's surface is mapped to the unit sphere and its inside to the unit ball, along rays.
  Vec3 materialFromLocal(const Vec3& local) const;
  Vec3 localFromMaterial(const Vec3& material) const;
  Vec3 deformedFromShape(const Vec3& x) const;    // all the deformations, in order
  Vec3 shapeFromDeformed(const Vec3& x) const;    // the exact inverse
  Mat3 deformationJacobian(const Vec3& x) const;  // of deformedFromShape
  // The same for the distance at x: where deformations are steep off the surface, as on it.
  Mat3 distanceJacobian(const Vec3& x) const;

  const SolidKernel& kernel() const { return kernel_; }

 private:
  struct Step {
    const Deformation* type;
    std::size_t first, count;  // its slice of values_
  };
  // What no parameter changes; shared by all copies.
  struct Layout {
    const Shape* shape = shapes().front();
    std::vector<Step> steps;
    std::vector<const ParameterInfo*> infos;
    std::vector<std::string> paths;
    std::size_t shapeCount = 0;  // the shape's parameters come first
  };

  void readShape(const SolidDef& def, const std::string& pointer, Diagnostics& diagnostics,
                 Layout& layout);
  void readStep(const SolidDef::Step& step, const std::string& pointer, Diagnostics& diagnostics,
                Layout& layout);
  void addParameters(std::span<const ParameterInfo> infos, std::span<const double> given,
                     const std::string& prefix, const std::string& pointer,
                     Diagnostics& diagnostics, Layout& layout);
  std::span<const double> shapeParameters() const { return {values_.data(), layout_->shapeCount}; }
  std::span<const double> stepParameters(const Step& s) const {
    return {effective_.data() + s.first, s.count};
  }
  bool write(std::size_t index, double value);  // whether that changed anything
  void refresh();                               // all that depends on values_
  void refreshOutline(const PrimitiveKernel& before);

  std::shared_ptr<const Layout> layout_ = std::make_shared<Layout>();
  std::vector<double> values_;
  std::vector<double> effective_;  // values_ with amounts held to where the map is one-to-one
  SolidKernel kernel_;
  Vec3 halfExtents_m_ = Vec3::Ones();
  Box bounds_{-Vec3::Ones(), Vec3::Ones()};
  double cornerGauge_ = 0;  // at (a, b, c); 0: not known yet
  std::array<Vec3, 8> outline_m_{};
};

KernelFrame kernelFrame(const Transform& world);

// Distance and normal of a solid that stands in the world: transform, evaluate and turn the normals
// in one pass over the points. Arrays need no alignment; outputs must not overlap the inputs.
void evaluatePosed(const Solid& solid, const Transform& world, ConstVectors points_world,
                   float* distance_m, Vectors normal_world);

}  // namespace fascia
