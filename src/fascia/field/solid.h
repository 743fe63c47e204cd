#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/base/error.h>
#include <fascia/geometry/triangle_mesh.h>
#include <fascia/math/types.h>

namespace fascia {

// One tunable number of a shape or deformation.
struct ParameterInfo {
  std::string_view name;  // with its unit: "radius_m", "exponent_e1", "angle_rad"
  double standard;        // value if the file gives none
  double min, max;        // closed range
  std::string_view help;
};

// A primitive around its own origin, along its z axis where it has one (superquadrics: Barr 1981).
// Parameters come as a span in the order of parameters().
class Shape {
 public:
  virtual ~Shape() = default;
  virtual std::string_view name() const = 0;  // as in files: "sphere"
  virtual std::span<const ParameterInfo> parameters() const = 0;
  virtual double volume_m3(std::span<const double> p) const = 0;  // closed form
  // Half sizes along x, y, z: a material point is a local point divided by these, so that an anchor
  // stays on the surface while the parameters change.
  virtual Vec3 halfExtents_m(std::span<const double> p) const = 0;
  // Signed distance estimate (m, negative inside) and outward unit normal at local points.
  virtual void evaluate(std::span<const double> p, ConstVectors points, float* distance_m,
                        Vectors normal) const = 0;
  // The surface as a closed mesh for display and export; `detail` = segments around.
  virtual TriangleMesh tessellate(std::span<const double> p, int detail) const = 0;
};

// A global deformation of space along the local z axis (Barr 1984), exactly invertible.
class Deformation {
 public:
  virtual ~Deformation() = default;
  virtual std::string_view name() const = 0;  // "taper", "twist", "bend"
  virtual std::span<const ParameterInfo> parameters() const = 0;
  // zRange_m: the z interval of the undeformed shape; deformations are parametrised over it.
  virtual Vec3 forward(std::span<const double> p, double zHalf_m, const Vec3& x) const = 0;
  virtual Vec3 inverse(std::span<const double> p, double zHalf_m, const Vec3& x) const = 0;
  virtual Mat3 jacobian(std::span<const double> p, double zHalf_m, const Vec3& x) const = 0;
};

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
  };
  std::string shape = "sphere";
  std::vector<double> parameters;  // in the order of Shape::parameters(); missing = standard
  std::vector<Step> deformations;
};

// A SolidDef made ready: all parameters present in one flat array that keys and drivers write.
class Solid {
 public:
  Solid() = default;
  Solid(const SolidDef& def, const std::string& pointer, Diagnostics& diagnostics);

  std::size_t parameterCount() const { return values_.size(); }
  int parameterIndex(std::string_view path) const;  // -1 if there is none
  const ParameterInfo& parameterInfo(int index) const { return *infos_[static_cast<std::size_t>(index)]; }
  const std::string& parameterPath(int index) const { return paths_[static_cast<std::size_t>(index)]; }
  double parameter(int index) const { return values_[static_cast<std::size_t>(index)]; }
  void setParameter(int index, double value);  // clamped to its range; NaN is ignored

  const Shape& shape() const { return *shape_; }
  bool deformed() const { return !steps_.empty(); }
  Box bounds() const;            // local, encloses the deformed surface
  double volume_m3() const;      // closed form; with deformations: of the tessellation
  TriangleMesh tessellate(int detail) const;

  // Signed distance estimate (m, negative inside) and outward unit normal at local points, batch.
  // Error bound: see field/distance.md of the tests: stated per shape near the surface.
  void evaluate(ConstVectors points_local, float* distance_m, Vectors normal_local) const;

  Vec3 materialFromLocal(const Vec3& local) const;  // undo deformations, divide by half extents
  Vec3 localFromMaterial(const Vec3& material) const;

 private:
  struct Step {
    const Deformation* type;
    std::size_t first, count;  // its slice of values_
  };
  const Shape* shape_ = nullptr;
  std::vector<Step> steps_;
  std::vector<double> values_;
  std::vector<const ParameterInfo*> infos_;
  std::vector<std::string> paths_;
};

}  // namespace fascia
