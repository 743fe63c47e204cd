#pragma once

#include <array>
#include <memory>
#include <vector>

#include <fascia/base/shared_list.h>
#include <fascia/flesh/flesh.h>
#include <fascia/skin/def/skin_def.h>
#include <fascia/skin/grid/grid_layout.h>
#include <fascia/skin/grid/wrap.h>
#include <fascia/skin/point/face_samples.h>
#include <fascia/skin/point/tissue.h>

namespace fascia {

struct SkinFit;

// What of a definition decides how a grid is laid around the flesh. An edit that leaves it alone
// keeps the wrap.
struct GridWrapKey {
  int columns, rows;
  SkinEndDef bottom, top;  // without their joints' names
  JointId endJoints[2];
  double cling;
  int savedColumns, savedRows;  // of the lists; 0: none
  SharedList<std::array<float, 3>> savedRest, savedAnchor;
  SharedList<int> savedAnchorSolid;

  static GridWrapKey of(const SkinDef& def, JointId bottom, JointId top);
  bool operator==(const GridWrapKey&) const = default;
};

// A grid laid around the flesh, and what it was laid around: made once, by shrink-wrapping or from
// saved lists. While solids and joints are edited, rest shapes follow from it (follow). Constant.
struct GridWrap {
  GridWrapKey key;
  GridLayout layout;
  VectorArray rest;                               // storage order, pads filled
  double fat_m = 0;                               // that the flesh was wrapped at a distance of
  EndRing ends[2];                                // bottom, top
  std::vector<TissueAnchors::Anchor> anchors;     // the strands' inner ends, point by point
  std::vector<TissueAnchors::Anchor> placements;  // every point in its nearest solid
  VectorArray placed;                             // where those are: `rest`, but for rounding
  std::shared_ptr<const SkinFit> fit;             // of the shape that was wrapped
  std::shared_ptr<const FaceSamples> faces;       // nullptr: none are needed

  // The rest posture that it lies around.
  Flesh flesh;
  PosedFlesh posedFlesh;
};

// The rest posture that a rest shape lies in: all that it depends on besides its wrap.
struct GridRestKey {
  std::vector<Transform> frames;                // of the solids
  std::vector<std::vector<double>> parameters;  // of the solids
  std::vector<Transform> endJoints;             // bottom, top
  double fat_m = 0;
  std::vector<SkinAnchorDef> anchors;  // moved by hand
  bool operator==(const GridRestKey&) const = default;
};

// Where a grid's rest shape comes from. Constant.
struct GridRest {
  std::shared_ptr<const GridWrap> wrap;
  GridRestKey key;
  FloatArray area_m2;  // of the rest shape, per point
};

// What decides a grid's quantities besides its rest shape and strands. Constant.
struct GridQuantitySource {
  SkinDef def;
  std::vector<Vec3> brushCenters_m;  // in the rest posture

  // Whether regions, brushes and saved lists do to a quantity what they did.
  bool editsAlike(const GridQuantitySource& other) const {
    return def.regions == other.def.regions && def.brushes == other.def.brushes &&
           def.points == other.def.points && brushCenters_m == other.brushCenters_m;
  }
};

// What a wrap becomes around other solids and joints of the same structure, or with other fat.
struct FollowedGrid {
  VectorArray rest;
  std::vector<TissueAnchors::Anchor> anchors, placements;
};

// The flesh and joints to follow, in the rest posture, and where the ends are there.
struct FollowInput {
  const Flesh& flesh;
  const PosedFlesh& posedFlesh;
  EndRing ends[2];
  double fat_m;
};

// Whether a wrap around the one can follow the other: as many solids, each with the same shape and
// deformations as before, renamed at most.
bool sameStructure(const Flesh& a, const Flesh& b);

// Points go with the matter of their nearest solids, evenly where neighbours' solids differ; end
// rows go with their rings; a change of the fat is added along the normals; then all is moved out
// of the flesh. Strands keep their matter. Depends on its arguments only, not on edits in between,
// and has the wrap's own bits where nothing was edited.
FollowedGrid follow(const GridWrap& wrap, const FollowInput& input);

// The wrap's own rest shape, with material points of the flesh as it is now.
FollowedGrid followMatter(const GridWrap& wrap, const Flesh& flesh);
// Puts the placements where the rest shape is; each point stays in its solid.
void placeIn(const PosedFlesh& flesh, FollowedGrid& grid);

}  // namespace fascia
