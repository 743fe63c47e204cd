#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <fascia/base/shared_list.h>
#include <fascia/math/types.h>

namespace fascia {

// Everything a person tunes about a skin. All amounts are per square metre of rest surface, so that
// they mean the same at every resolution. Ranges are checked by the file reader and the builder.

struct SkinMaterialDef {
  double density_kg_per_m2 = 4;    // [0.01, 1000]; heavier: more follow-through
  double stretch_u_N_per_m = 150;  // (0, 1e6], around the tube (u1)
  double stretch_v_N_per_m = 150;  // (0, 1e6], along the tube (u2)
  double shear_N_per_m = 60;       // [0, 1e6]
  double bending_Nm = 0;           // [0, 1e3]; 0 = the paper's pure membrane
  double drag_Ns_per_m3 = 4;       // [0, 1e5]; the global damping −γ v
  double prestretch = 1.08;        // [0.5, 3]; > 1: the skin is a taut stocking
  double max_stretch = 1.4;        // [1.01, 4]; beyond it the stress no longer grows
  double friction_per_s = 8;       // [0, 1e4]; rate at which sliding on flesh dies away
  double restitution = 0;          // [0, 1]; the paper's k_n: bounce off the flesh
  bool operator==(const SkinMaterialDef&) const = default;
};

struct SkinFatDef {
  double thickness_m = 0.01;  // [0, 1]; of an imported mesh: at most, what lies between mesh and
                              // flesh counts
  double compressible = 0;    // [0, 0.95]; share of the thickness that pressing can take away
  double bulk_Pa = 0;         // [0, 1e5]; resistance of each solid's fat to a change of its volume
  bool operator==(const SkinFatDef&) const = default;
};

struct SkinTissueDef {
  double stiffness_N_per_m3 = 4000;     // [0, 1e8]; pull per metre beyond rest, per square metre
  double damping_Ns_per_m3 = 60;        // [0, 1e6]
  std::optional<double> rest_length_m;  // [0, 1]; none = the length at attachment
  double carry = 0;  // [0, 1]; share of its anchor's changes of velocity that a point takes over at
                     // once: 0 shakes like jelly, 1 not at all
  bool operator==(const SkinTissueDef&) const = default;
};

// One end of the tube: a small ring of points fixed to a joint.
struct SkinEndDef {
  std::string joint;
  Vec3 position_m = Vec3::Zero();  // in the joint's frame; the ring's centre lies on the flesh
                                   // surface on the ray from here along axis
  Vec3 axis = Vec3::Zero();        // in the joint's frame; zero = away from the other end
  double radius_m = 0;             // of the ring; 0 = 0.022 of the distance of the two ends
  bool operator==(const SkinEndDef&) const = default;
};

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

// How an imported mesh follows its joints (pose_skin.h); each in [0, 1].
struct SkinPoseDef {
  double jiggle = 0.5;     // flesh that moves by itself: 0 none, 0.5 as flesh is, 1 jelly
  double muscle = 0.3;     // flexors that swell in a bend: 0 none, 0.3 natural, 1 bodybuilder
  double volume = 0.9;     // share of what a bend takes from a joint that comes out around it
  double tightness = 0.5;  // how far the skin evens out: 0 slack, 1 taut
  // Beyond the pose: elastic skin with the material and tissue below is simulated, its strands'
  // inner ends where the pose function has the mesh.
  bool simulate = false;
  bool operator==(const SkinPoseDef&) const = default;
};

// A named part of the skin in material coordinates, and what differs there.
struct SkinRegionDef {
  struct Edit {
    SkinQuantity quantity;
    enum class Mode { set, scale, add } mode = Mode::set;
    double value = 0;  // the quantity's unit; scale: a factor
    bool operator==(const Edit&) const = default;
  };
  std::string name;
  double u_min = 0, u_max = 1;  // around, in [0, 1]; u_min > u_max wraps around
  double v_min = 0, v_max = 1;  // along, from the bottom end (0) to the top end (1)
  std::string solid;            // if given: instead, all points anchored to this solid
  std::string joint;            // of an imported mesh, if given: instead, by the joint's weights
  double feather = 0.05;        // [0, 0.5]; width of the smooth border in u and v
  std::vector<Edit> edits;
  bool operator==(const SkinRegionDef&) const = default;
};

// A Gaussian dab, as the paper's liposuction tool leaves it.
struct SkinBrushDef {
  SkinQuantity quantity = SkinQuantity::fat;
  Vec3 center_m = Vec3::Zero();  // in `joint`'s frame in the rest posture; acts on nearby points
  std::string joint;
  double radius_m = 0.1;  // one standard deviation
  double amount = 0;      // added at the centre; the result never falls below 0
  bool operator==(const SkinBrushDef&) const = default;
};

// One end point of a tissue strand, moved by hand.
struct SkinAnchorDef {
  double u = 0, v = 0;  // the skin point nearest to these material coordinates
  std::string solid;
  Vec3 position_m = Vec3::Zero();  // in the solid's frame, put onto its surface
  bool operator==(const SkinAnchorDef&) const = default;
};

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

// The skin against itself (spec L22).
struct SkinContactDef {
  bool self = false;
  double gap_m = 0.002;  // (0, 1]; kept between two sheets of skin
  bool operator==(const SkinContactDef&) const = default;
};

// What becomes of a piece of an imported mesh, named by its part or material.
struct SkinPartDef {
  std::string name;
  // Carried by its joints as it is: armour, buckles, a robot. Pieces that a single joint carries
  // are, unless a rule with false makes them skin.
  bool rigid = true;
  bool operator==(const SkinPartDef&) const = default;
};

struct SkinDef {
  int columns = 32, rows = 32;  // [8, 4096] each; columns go around, rows from bottom to top
  SkinEndDef bottom, top;
  SkinMaterialDef material;
  SkinFatDef fat;
  SkinTissueDef tissue;
  SkinPoseDef pose;    // of an imported mesh
  double cling = 0.3;  // [0, 1]; shrink-wrap: 0 spans hollows like a stocking, 1 fills every valley
  std::string texture;  // PNG or JPEG beside the character file; empty = color
  std::array<float, 3> color{0.86f, 0.66f, 0.56f};  // sRGB
  std::vector<SkinRegionDef> regions;
  std::vector<SkinBrushDef> brushes;
  std::vector<SkinAnchorDef> anchors;
  std::optional<SkinPointsDef> points;
  SkinContactDef contact;
  std::vector<SkinPartDef> parts;  // of an imported mesh
  bool operator==(const SkinDef&) const = default;
};

}  // namespace fascia
