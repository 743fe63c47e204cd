#pragma once

#include <memory>
#include <string>
#include <vector>

#include <fascia/field/field.h>
#include <fascia/field/solid.h>
#include <fascia/skeleton/skeleton.h>

namespace fascia {

// "The biceps swells as the elbow bends": a joint value drives a solid's parameter.
struct DriverDef {
  enum class Interpolation { piecewise, smooth };  // linear pieces, or a monotone cubic
  struct Point {
    double jointValue;  // metre or radian
    double parameter;   // the parameter's own unit
  };
  std::string parameter;  // path, e.g. "radius_m", "taper.amount"
  std::string joint;
  Dof dof = Dof::rx;
  std::vector<Point> points;  // increasing jointValue, at least two; constant outside
  Interpolation interpolation = Interpolation::smooth;
};

struct Color {
  float r = 0.8f, g = 0.8f, b = 0.8f;  // linear is not meant: sRGB, each in [0, 1]
};

// A solid on a joint. Flesh solids shape the skin; ornaments (eyes, beak, claws) are only seen.
struct FleshSolidDef {
  std::string name;
  std::string joint;
  Vec3 position_m = Vec3::Zero();       // in the joint's frame
  Vec3 orientation_rad = Vec3::Zero();  // intrinsic Rz·Ry·Rx
  SolidDef solid;
  std::vector<DriverDef> drivers;
  Color color{0.72f, 0.28f, 0.26f};
};

struct FleshDef {
  std::vector<FleshSolidDef> solids;
};

class Flesh;

// The flesh at one moment.
class PosedFlesh final : public Field {
 public:
  std::size_t solidCount() const override;
  Box bounds(SolidId solid) const override;
  void evaluate(SolidId solid, ConstVectors points, float* distance_m, Vectors normal) const override;
  void velocity(SolidId solid, ConstVectors points, Vectors velocity) const override;
  Vec3 materialFromWorld(SolidId solid, const Vec3& world) const override;
  Vec3 worldFromMaterial(SolidId solid, const Vec3& material) const override;

  const Solid& solid(SolidId id) const { return posed_[id.index()].solid; }
  const Transform& frame(SolidId id) const { return posed_[id.index()].world; }

 private:
  friend class Flesh;
  struct Posed {
    Solid solid;              // with the current parameters
    Transform world;
    Twist twist;
    Vec3 swellRate = Vec3::Zero();  // d(half extents)/dt over half extents, 1/s
    Box bounds;
  };
  std::vector<Posed> posed_;
};

// Constant once built: which solid sits on which joint, and what drives it.
class Flesh {
 public:
  Flesh() = default;
  Flesh(const FleshDef& def, const Skeleton& skeleton, const std::string& pointer,
        Diagnostics& diagnostics);

  std::size_t solidCount() const { return solids_.size(); }
  const FleshSolidDef& def(SolidId id) const { return defs_[id.index()]; }
  SolidId find(std::string_view name) const;  // invalid if there is none
  JointId joint(SolidId id) const { return solids_[id.index()].joint; }
  const Solid& restSolid(SolidId id) const { return solids_[id.index()].rest; }

  // An animated parameter: overrides the rest value; drivers add nothing to a keyed parameter.
  struct ParameterOverride {
    SolidId solid;
    int parameter;
    double value, rate;  // its unit, and per second
  };
  // Allocation-free after the first call with the same `out`.
  void pose(const Posture& posture, const PosedSkeleton& skeleton,
            std::span<const ParameterOverride> overrides, PosedFlesh& out) const;

 private:
  struct Driver;
  struct Entry {
    JointId joint;
    Transform inJoint;
    Solid rest;
    std::size_t firstDriver = 0, driverCount = 0;
  };
  std::vector<FleshSolidDef> defs_;
  std::vector<Entry> solids_;
  std::shared_ptr<const std::vector<Driver>> drivers_;
};

}  // namespace fascia
