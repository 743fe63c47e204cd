#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <fascia/skin/mesh/triangle_membrane.h>
#include <fascia/skin/point/tissue.h>
#include <fascia/skin/skin.h>

namespace fascia {

// What the builders of grid and mesh skins share.

// Reports faults of a skin's definition, and looks up what it names.
class SkinReport {
 public:
  SkinReport(const SkinBase& base, std::string pointer, Diagnostics& diagnostics)
      : base_(base), pointer_(std::move(pointer)), diagnostics_(diagnostics) {}

  void error(const std::string& where, std::string message, std::string hint = {}) const;
  // Of a grid: columns or rows.
  bool checkSide(const std::string& where, int side) const;
  // Everything that has a range, whatever the skin lies on. True: all is within it.
  bool checkValues(const SkinDef& def) const;
  // Saved per-point lists: `count` values within their ranges each, or none.
  bool checkPointLists(const SkinPointsDef& points, std::size_t count,
                       const std::string& expected) const;
  JointId findJoint(const std::string& where, const std::string& name) const;
  SolidId findSolid(const std::string& where, const std::string& name) const;

 private:
  void checkRegion(const SkinRegionDef& region, std::size_t index) const;

  const SkinBase& base_;
  std::string pointer_;
  Diagnostics& diagnostics_;
};

// Strands as long at rest as in the rest posture; unless the definition says otherwise.
void setNaturalLengths(const SkinDef& def, const PosedFlesh& flesh,
                       const std::vector<TissueAnchors::Anchor>& anchors, const VectorArray& rest,
                       FloatArray& restLength_m);

// What a membrane of triangles is made of, but for its directions: v runs along, as on a grid.
TriangleMaterial triangleMaterial(const SkinQuantities& quantities, double maxStretch);

// The solid nearest to a point, and how far away it is.
struct NearestFlesh {
  float distance = 3e38f;
  SolidId solid;
  Vec3 normal = Vec3::UnitY();
};
NearestFlesh nearestFlesh(const DistanceField& field, const Vec3& p,
                          std::span<const SolidId> solids);
NearestFlesh nearestFlesh(const DistanceField& field, const Vec3& p);  // of all

// Regions and brushes on the points of a skin. A grid has u and v; others have weights.
struct EditPoint {
  std::size_t point;                      // storage index
  double u, v;                            // material coordinates; not read if the skin has none
  SolidId solid;                          // that the point is tied to; invalid: none
  const PointWeights* weights = nullptr;  // not of a grid; by the numbers of EditedSkin::joints
};
enum class SkinKind { grid, rig, surface };
struct EditedSkin {
  SkinKind kind;
  std::span<const std::string> joints;  // that points have weights for
};
// Only quantities that `changes` are touched.
using QuantityMask = std::array<bool, kSkinQuantities>;
void applySkinEdits(const SkinDef& def, const SkinBase& base, const SkinReport& report,
                    std::span<const EditPoint> points, const EditedSkin& skin,
                    const VectorArray& rest, const QuantityMask& changes,
                    SkinQuantities& quantities);
// Where a brush is in the rest posture; none if its joint is not found.
std::optional<Vec3> brushCenter(const SkinBrushDef& brush, const SkinBase& base);

// Fills what stepping needs to know of the points from their quantities and areas (m²).
// `tied`: storage indices of the points with a tissue strand.
struct PointModelInput {
  const SkinQuantities& quantities;
  const FloatArray& area;
  const FloatArray& stiffness;  // of the surface itself, N/m
  double leastArea_m2;          // rest cells that are nearly nothing still need a mass
  std::span<const std::size_t> points, fixedPoints, tied;
};
PointModel makePointModel(const PointModelInput& input);

}  // namespace fascia
