#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fascia/field/field.h>
#include <fascia/field/solid.h>
#include <fascia/material/body_def.h>
#include <fascia/skeleton/skeleton.h>

namespace fascia {

// "The biceps swells as the elbow bends": a joint value drives a solid's parameter.
struct DriverDef {
  enum class Interpolation { piecewise, smooth };  // linear pieces, or a monotone cubic
  struct Point {
    double jointValue;  // metre or radian
    double parameter;   // the parameter's own unit
    bool operator==(const Point&) const = default;
  };
  std::string parameter;  // path, e.g. "radius_m", "taper.amount"
  std::string joint;
  Dof dof = Dof::rx;
  std::vector<Point> points;  // increasing jointValue, two to kMost; constant outside
  static constexpr std::size_t kMost = 1024;
  Interpolation interpolation = Interpolation::smooth;
  bool operator==(const DriverDef&) const = default;
};

struct Color {
  float r = 0.8f, g = 0.8f, b = 0.8f;  // linear is not meant: sRGB, each in [0, 1]
  bool operator==(const Color&) const = default;
};

// A solid that is a linear deformable body instead of a rigid one: it sags, lags and jiggles
// (Witkin & Welch 1990). The joint carries some of its points, the rest follows by itself.
struct SoftSolidDef : BodyMaterialDef {
  SoftSolidDef() { rigidity_Pa = 1e3, volume_Pa = 1e4, relaxation_s = 0.01; }  // fat
  BodyBasisDef basis;
  // In the solid's frame, within its bounds; none: some at the end that is nearest to the joint.
  std::vector<Vec3> held_m;
  bool operator==(const SoftSolidDef&) const = default;
};
inline constexpr std::size_t kMostHeldPoints = 64;

// A solid on a joint. Flesh solids shape the skin; ornaments (eyes, beak, claws) are only seen.
struct FleshSolidDef {
  std::string name;  // unique
  std::string joint;
  Vec3 position_m = Vec3::Zero();       // in the joint's frame
  Vec3 orientation_rad = Vec3::Zero();  // intrinsic Rz·Ry·Rx
  SolidDef solid;
  std::vector<DriverDef> drivers;
  Color color{0.72f, 0.28f, 0.26f};
  std::optional<SoftSolidDef> soft;  // not of ornaments, and not with drivers
  bool operator==(const FleshSolidDef&) const = default;
};
constexpr auto tunables(const FleshSolidDef*) {
  using S = FleshSolidDef;
  return std::tuple{tunable(&S::position_m, "position_m", "m", {-1e6, 1e6}, "In the joint's frame"),
                    tunable(&S::orientation_rad, "orientation_deg", "deg", {-36000, 36000},
                            "Turns about x, y, z; applied as Rz Ry Rx")};
}
// More than any figure needs; bounds what a hostile file can cost.
inline constexpr std::size_t kMostSolids = 4096;

struct FleshDef {
  std::vector<FleshSolidDef> solids;
  bool operator==(const FleshDef&) const = default;
};

class Flesh;

// The flesh at one moment. Filled by Flesh::pose; a plain value, read-only for any number of
// threads. Material coordinates: where the matter was in the rest solid, in its own frame (m).
// While a solid's parameters are at rest they are its local coordinates; when it swells or deforms
// they follow Solid::materialFromLocal, so that what is on the surface stays on it.
class PosedFlesh final : public Field {
 public:
  std::size_t solidCount() const override { return posed_.size(); }
  Box bounds(SolidId solid) const override { return posed_[solid.index()].bounds; }
  void evaluate(SolidId solid, ConstVectors points, float* distance_m,
                Vectors normal) const override;
  Transform frame(SolidId solid) const override { return posed_[solid.index()].world; }
  const Outline& outline(SolidId solid) const override {
    return posed_[solid.index()].solid.outline_m();
  }
  void velocity(SolidId solid, ConstVectors points, Vectors velocity) const override;
  Vec3 materialFromWorld(SolidId solid, const Vec3& world) const override;
  Vec3 worldFromMaterial(SolidId solid, const Vec3& material) const override;
  void worldFromMaterials(SolidId solid, ConstVectors materials, Vectors world) const override;

  const Solid& solid(SolidId id) const { return posed_[id.index()].solid; }

 private:
  friend class Flesh;
  struct Parameter {
    double value, rate;  // its unit, and per second
  };
  struct Posed {
    const Solid* rest = nullptr;        // kept alive by source_
    Solid solid;                        // with the current parameters
    std::vector<Parameter> parameters;  // as drivers and tracks want them
    std::vector<double> values;         // scratch
    bool written = false;               // parameters are no longer those of rest
    Transform world;
    Twist twist;
    Box bounds;
    // Matter has moved along the axes only: local = stretch * material. Otherwise it went through
    // the shape's and the deformations' own maps.
    bool stretched = true;
    Vec3 stretch = Vec3::Ones();
    // v = v(origin) + gradient (x - origin), 1/s; plus, if it is not a mere stretching that goes
    // on, the difference of the solid a moment earlier and later. Those two are made when a
    // parameter is first written: most solids never need them.
    Mat3 velocityGradient = Mat3::Zero();
    double behindToAhead_s = 0;  // 0 = none
    Solid behind, ahead;
  };

  static void write(Posed& posed, int parameter, double value, double rate);
  static void reset(Posed& posed);
  static bool apply(Posed& posed);
  static double differentiate(Posed& posed);
  static void addSwelling(Posed& posed);
  static Vec3 movement(const Posed& posed, const Vec3& local);
  static void finish(Posed& posed);

  std::vector<Posed> posed_;
  std::shared_ptr<const void> source_;  // the Flesh::Bound that posed_ was made for
};

// Constant once built: which solid sits on which joint, and what drives it.
class Flesh {
 public:
  enum class Role { muscle, ornament };  // an ornament is rigid: it has no drivers

  Flesh() = default;
  // Reports every fault of `def` to `diagnostics`; with errors the result must not be used.
  // `pointer` leads to the array of solids: "/solids" gives "/solids/2/joint".
  Flesh(const FleshDef& def, const Skeleton& skeleton, const std::string& pointer,
        Diagnostics& diagnostics, Role role = Role::muscle);

  std::size_t solidCount() const { return solids_.size(); }
  const FleshSolidDef& def(SolidId id) const { return defs_[id.index()]; }
  SolidId find(std::string_view name) const;  // invalid if there is none
  JointId joint(SolidId id) const { return solids_[id.index()].joint; }
  const Transform& placeInJoint(SolidId id) const { return solids_[id.index()].inJoint; }
  const Solid& restSolid(SolidId id) const;

  // An animated parameter: replaces the rest value and whatever a driver says, or what an override
  // before it says, by its weight.
  struct ParameterOverride {
    SolidId solid;
    int parameter;
    double value, rate;                       // its unit, and per second
    double weight = 1, weightRate_per_s = 0;  // [0, 1]; 0 = as if it were not there
  };
  // Depends on its arguments only, not on what `out` held. Allocation-free after the first call
  // with the same `out`.
  void pose(const Posture& posture, const PosedSkeleton& skeleton,
            std::span<const ParameterOverride> overrides, PosedFlesh& out) const;

 private:
  struct Driver;
  struct Bound;
  struct Entry {
    JointId joint;
    Transform inJoint;
    std::size_t firstDriver = 0, driverCount = 0;
  };
  static void addDrivers(const FleshSolidDef& def, const Solid& solid, const Skeleton& skeleton,
                         const std::string& pointer, Diagnostics& diagnostics,
                         std::vector<Driver>& drivers);
  void prepare(PosedFlesh& out) const;

  std::vector<FleshSolidDef> defs_;
  std::vector<Entry> solids_;
  std::shared_ptr<const Bound> bound_;  // shared with every PosedFlesh made from it
};

}  // namespace fascia
