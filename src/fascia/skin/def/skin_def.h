#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <fascia/base/shared_list.h>
#include <fascia/base/tunable.h>
#include <fascia/math/types.h>

namespace fascia {

// Everything a person tunes about a skin. All amounts are per square metre of rest surface, so that
// they mean the same at every resolution. Units, ranges and help are in the tables.

struct SkinMaterialDef {
  double density_kg_per_m2 = 4;
  double stretch_u_N_per_m = 150, stretch_v_N_per_m = 150;
  double shear_N_per_m = 60;
  double bending_Nm = 0;      // 0 = the paper's pure membrane
  double drag_Ns_per_m3 = 4;  // the paper's global damping −γ v
  double prestretch = 1.08;
  double max_stretch = 1.4;
  double friction_per_s = 8;
  double restitution = 0;  // the paper's k_n
  bool operator==(const SkinMaterialDef&) const = default;
};
constexpr auto tunables(const SkinMaterialDef*) {
  using M = SkinMaterialDef;
  return std::tuple{
      tunable(&M::density_kg_per_m2, "density_kg_per_m2", "kg/m²", {0.01, 1000},
              "Heavier: more follow-through. On a simulated rig times 0.3 to 1.5: less where its "
              "fat is thinner than usual, more where it is thicker"),
      // Softer than this, and what holds the skin together is lost in rounding.
      tunable(&M::stretch_u_N_per_m, "stretch_u_N_per_m", "N/m", {1e-3, 1e6},
              "Stiffness around the tube"),
      tunable(&M::stretch_v_N_per_m, "stretch_v_N_per_m", "N/m", {1e-3, 1e6},
              "Stiffness along the tube"),
      tunable(&M::shear_N_per_m, "shear_N_per_m", "N/m", {0, 1e6}, "Stiffness against shear"),
      tunable(&M::bending_Nm, "bending_Nm", "N m", {0, 1e3}, "0: a pure membrane"),
      tunable(&M::drag_Ns_per_m3, "drag_Ns_per_m3", "N s/m³", {0, 1e5}, "Damps all motion"),
      tunable(&M::prestretch, "prestretch", "", {0.5, 3}, "Above 1: a taut stocking"),
      tunable(&M::max_stretch, "max_stretch", "", {1.01, 4},
              "Edges grow no longer than so many times their rest length, but for a tenth where "
              "flesh pushes; nor does stress grow there"),
      tunable(&M::friction_per_s, "friction_per_s", "1/s", {0, 1e4},
              "Rate at which sliding on flesh dies away"),
      tunable(&M::restitution, "restitution", "", {0, 1}, "Bounce off the flesh")};
}

struct SkinFatDef {
  double thickness_m = 0.01;
  double compressible = 0;
  double bulk_Pa = 0;
  bool operator==(const SkinFatDef&) const = default;
};
constexpr auto tunables(const SkinFatDef*) {
  using F = SkinFatDef;
  return std::tuple{
      tunable(&F::thickness_m, "thickness_m", "m", {0, 1},
              "Its thickness; on a rig at most, and never more than lies between mesh and flesh"),
      tunable(&F::compressible, "compressible", "", {0, 0.95},
              "No effect: of older files, whose fat gave way"),
      tunable(&F::bulk_Pa, "bulk_Pa", "Pa", {0, 1e5},
              "Of surfaces of solids and simulated rigs: pressure of each solid's fat per share of "
              "its volume that it has lost. 0: none")};
}

struct SkinTissueDef {
  double stiffness_N_per_m3 = 4000;
  double damping_Ns_per_m3 = 60;
  std::optional<double> rest_length_m;
  double carry = 0;
  bool operator==(const SkinTissueDef&) const = default;
};
constexpr auto tunables(const SkinTissueDef*) {
  using T = SkinTissueDef;
  return std::tuple{
      tunable(
          &T::stiffness_N_per_m3, "stiffness_N_per_m3", "N/m³", {0, 1e8},
          "Pull per metre beyond rest, per square metre. On a simulated rig times 0.7 to 6, most "
          "where its fat is thin, and no less than keeps a strand from sagging by a quarter "
          "of an edge"),
      tunable(&T::damping_Ns_per_m3, "damping_Ns_per_m3", "N s/m³", {0, 1e6},
              "Damping along a strand"),
      tunable(&T::carry, "carry", "", {0, 1},
              "Share of the flesh's changes of velocity that the skin takes over at once: 0 shakes "
              "like jelly, 1 not at all"),
      tunable(&T::rest_length_m, "rest_length_m", "m", {0, 1}, "None: the length at attachment")};
}

// One end of the tube: a small ring of points fixed to a joint.
struct SkinEndDef {
  std::string joint;
  Vec3 position_m = Vec3::Zero();  // in the joint's frame; the ring's centre lies on the flesh
                                   // surface on the ray from here along axis
  Vec3 axis = Vec3::Zero();        // in the joint's frame; zero = away from the other end
  double radius_m = 0;
  bool operator==(const SkinEndDef&) const = default;
};
constexpr auto tunables(const SkinEndDef*) {
  using E = SkinEndDef;
  return std::tuple{tunable(&E::position_m, "position_m", "m", {-1e6, 1e6}, "In the joint's frame"),
                    tunable(&E::axis, "axis", "", {-1e6, 1e6},
                            "Towards the end, in the joint's frame; none: away from the other end"),
                    tunable(&E::radius_m, "radius_m", "m", {0, 1000},
                            "Of the ring; 0: 0.022 of the distance of the two ends")};
}

// The named per-point quantities that region edits and brushes change.
enum class SkinQuantity {
  density,
  stretch_u,
  stretch_v,
  shear,
  bending,
  drag,
  prestretch,
  fat,
  tissue_stiffness,
  tissue_damping,
  tissue_rest_length,
  jiggle,  // from here on: of an imported mesh, see SkinPoseDef
  muscle,
  volume,
  tightness
};

// How an imported mesh follows its joints (pose_skin.h).
struct SkinPoseDef {
  double jiggle = 0.5;
  double muscle = 0.3;
  double volume = 0.9;
  double tightness = 0.5;
  // The strands' inner ends are where the pose function has the mesh.
  bool simulate = false;
  bool operator==(const SkinPoseDef&) const = default;
};
constexpr auto tunables(const SkinPoseDef*) {
  using P = SkinPoseDef;
  return std::tuple{
      tunable(&P::jiggle, "jiggle", "", {0, 1},
              "Flesh that moves by itself: 0 none, 0.5 as flesh is, 1 jelly"),
      tunable(&P::muscle, "muscle", "", {0, 1},
              "Flexors that swell in a bend: 0 none, 0.3 natural, 1 bodybuilder"),
      tunable(&P::volume, "volume", "", {0, 1},
              "Share of what a bend takes from a joint that comes out around it"),
      tunable(&P::tightness, "tightness", "", {0, 1},
              "How far the skin evens out: 0 slack, 1 taut"),
      tunable(&P::simulate, "simulate",
              "Beyond the pose: elastic skin of the material and tissue here hangs on it")};
}

// A named part of the skin in material coordinates, and what differs there.
struct SkinRegionDef {
  struct Edit {
    SkinQuantity quantity;
    enum class Mode { set, scale, add } mode = Mode::set;
    double value = 0;
    bool operator==(const Edit&) const = default;
  };
  std::string name;
  double u_min = 0, u_max = 1;  // around; u_min > u_max wraps around
  double v_min = 0, v_max = 1;  // along, from the bottom end (0) to the top end (1)
  std::string solid;            // if given: instead, all points anchored to this solid
  std::string joint;            // of an imported mesh, if given: instead, by the joint's weights
  double feather = 0.05;
  std::vector<Edit> edits;
  bool operator==(const SkinRegionDef&) const = default;
};
constexpr auto tunables(const SkinRegionDef::Edit*) {
  return std::tuple{tunable(&SkinRegionDef::Edit::value, "value", "", {-1e8, 1e8},
                            "In the quantity's SI unit; scale: a factor")
                        .required()};
}
constexpr auto tunables(const SkinRegionDef*) {
  return std::tuple{tunable(&SkinRegionDef::feather, "feather", "", {0, 0.5},
                            "Width of the smooth border in u and v")};
}
inline constexpr TunableInfo kRegionU{
    "u", "", {0, 1}, "Around, [from, to] in 0 to 1; from > to wraps around"};
inline constexpr TunableInfo kRegionV{
    "v", "", {0, 1}, "Along, [from, to] from the bottom end (0) to the top (1)"};

// A Gaussian dab, as the paper's liposuction tool leaves it.
struct SkinBrushDef {
  SkinQuantity quantity = SkinQuantity::fat;
  Vec3 center_m = Vec3::Zero();  // in `joint`'s frame in the rest posture; acts on nearby points
  std::string joint;
  double radius_m = 0.1;
  double amount = 0;
  bool operator==(const SkinBrushDef&) const = default;
};
constexpr auto tunables(const SkinBrushDef*) {
  using B = SkinBrushDef;
  return std::tuple{
      tunable(&B::center_m, "center_m", "m", {-1e6, 1e6}, "In the joint's frame, rest posture"),
      tunable(&B::radius_m, "radius_m", "m", {1e-6, 1000}, "One standard deviation"),
      tunable(&B::amount, "amount", "", {-1e8, 1e8}, "Added at the centre; never below 0")};
}

// One end point of a tissue strand, moved by hand.
struct SkinAnchorDef {
  double u = 0, v = 0;  // the skin point nearest to these material coordinates
  std::string solid;
  Vec3 position_m = Vec3::Zero();
  bool operator==(const SkinAnchorDef&) const = default;
};
constexpr auto tunables(const SkinAnchorDef*) {
  using A = SkinAnchorDef;
  return std::tuple{tunable(&A::u, "u", "", {0, 1}, "Around").required(),
                    tunable(&A::v, "v", "", {0, 1}, "Along").required(),
                    tunable(&A::position_m, "position_m", "m", {-1e6, 1e6},
                            "In the solid's frame; put onto its surface")};
}

// Per-point values that replace the defaults above, row by row from the bottom end: what a studio
// saves after sculpting. Each list is empty, or has columns x rows entries (anchors: see skin.h).
// Of an imported mesh: in the order of RiggedModel::points_m, without anchors and rest positions.
struct SkinPointsDef {
  int columns = 0, rows = 0;
  SharedList<float> density, stretch_u, stretch_v, shear, bending, drag, prestretch, fat,
      tissue_stiffness, tissue_damping, tissue_rest_length, jiggle, muscle, volume, tightness;
  SharedList<int> anchor_solid;                      // -1: no tissue
  SharedList<std::array<float, 3>> anchor;           // material coordinates on that solid
  SharedList<std::array<float, 3>> rest_position_m;  // world, rest posture
  bool operator==(const SkinPointsDef&) const = default;
};

// The skin against itself.
struct SkinContactDef {
  bool self = false;
  double gap_m = 0.002;
  bool operator==(const SkinContactDef&) const = default;
};
constexpr auto tunables(const SkinContactDef*) {
  using C = SkinContactDef;
  return std::tuple{tunable(&C::self, "self", "Whether sheets of skin keep out of each other"),
                    tunable(&C::gap_m, "gap_m", "m", {1e-9, 1}, "Kept between two of them")};
}

// What becomes of a piece of an imported mesh, named by its part or material.
struct SkinPartDef {
  std::string name;
  // Carried by its joints as it is: armour, buckles, a robot. Pieces that a single joint carries
  // are, unless a rule with false makes them skin.
  bool rigid = true;
  bool operator==(const SkinPartDef&) const = default;
};
constexpr auto tunables(const SkinPartDef*) {
  return std::tuple{tunable(&SkinPartDef::rigid, "rigid", "Carried by its joints as it is")};
}

// A skin on triangles around the surface of all solids together, in place of a grid: any figure,
// with limbs and holes.
struct SkinSurfaceDef {
  std::optional<double> edge_m;
  double blend_m = 0.02;
  bool operator==(const SkinSurfaceDef&) const = default;
};
constexpr auto tunables(const SkinSurfaceDef*) {
  using S = SkinSurfaceDef;
  return std::tuple{
      tunable(&S::edge_m, "edge_m", "m", {1e-5, 100},
              "How long the triangles' edges are, shorter where the surface is curved; none: a "
              "fortieth of the figure's size"),
      tunable(&S::blend_m, "blend_m", "m", {0, 10},
              "Radius of the fillet between solids that meet; 0: a crease")};
}

// What only a skin that is a grid has: a tube around the flesh.
struct SkinGridDef {
  int columns = 32, rows = 32;  // columns go around, rows from bottom to top
  SkinEndDef bottom, top;
  double cling = 0.3;
  std::vector<SkinAnchorDef> anchors;
  bool operator==(const SkinGridDef&) const = default;
};
constexpr auto tunables(const SkinGridDef*) {
  return std::tuple{
      tunable(&SkinGridDef::cling, "cling", "", {0, 1},
              "How far the skin follows hollows: 0 spans them like a stocking, 1 fills every "
              "valley")};
}
// Each of columns and rows; and how many points both make.
inline constexpr TunableInfo kGridSide{
    "grid", "", {8, 4096}, "[columns around, rows along]; whole numbers, at most 1048576 points"};
inline constexpr int kMostGridPoints = 1 << 20;

// What only a skin that is an imported mesh has.
struct SkinMeshDef {
  SkinPoseDef pose;
  std::vector<SkinPartDef> parts;
  bool operator==(const SkinMeshDef&) const = default;
};

// A skin of a character: a mesh if that has a rig, the surface of its solids if that is asked for,
// a grid otherwise. Files have the members of `grid` and `mesh` beside the others.
struct SkinDef {
  SkinGridDef grid;
  std::optional<SkinSurfaceDef> surface;  // given: no grid
  SkinMeshDef mesh;
  SkinMaterialDef material;
  SkinFatDef fat;
  SkinTissueDef tissue;
  std::string texture;  // PNG or JPEG beside the character file; empty = color
  std::array<float, 3> color{0.86f, 0.66f, 0.56f};  // sRGB
  std::vector<SkinRegionDef> regions;
  std::vector<SkinBrushDef> brushes;
  std::optional<SkinPointsDef> points;
  SkinContactDef contact;
  bool operator==(const SkinDef&) const = default;
};

}  // namespace fascia
