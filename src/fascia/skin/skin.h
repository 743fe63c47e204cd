#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/base/hash.h>
#include <fascia/flesh/flesh.h>
#include <fascia/geometry/triangle_mesh.h>
#include <fascia/pose/jiggle_state.h>
#include <fascia/rig/rigged_model.h>
#include <fascia/skin/contact/fat_pressure.h>
#include <fascia/skin/contact/skin_contact.h>
#include <fascia/skin/def/skin_def.h>
#include <fascia/skin/point/leapfrog.h>
#include <fascia/skin/point/point_kernels.h>
#include <fascia/skin/point/point_model.h>
#include <fascia/skin/point/quantities.h>
#include <fascia/skin/point/skin_attachment.h>
#include <fascia/skin/point/skin_topology.h>
#include <fascia/skin/self_contact/self_contact.h>

namespace fascia {

// How a skin is stepped through time; plain values from the character's simulation settings.
struct SkinSettings {
  Vec3 gravity_m_per_s2{0, -9.81, 0};
  // "auto": stabilised leapfrog, on two grids where the skin is fine, or the scheme of "cloth"
  // where that suits (cloth_choice.h); "leapfrog": on one grid with the step that its waves need;
  // "cloth": by limits (cloth_stepper.h), grids only; else a name of integrators().
  std::string integrator = "auto";
  double step_s = 0;  // fixed step or first guess; 0 = chosen from the material
  // Longest time over which the flesh near a point is taken as a flat half space moving at constant
  // velocity; shorter while joints turn fast. Longer saves contact tests, shorter follows curved
  // flesh more closely.
  double interval_s = 1.0 / 60;
  double min_step_s = 1e-5, max_step_s = 0.02;
  double position_tolerance_m = 1e-3;
  double velocity_tolerance = 1e-3;
  double correction_tolerance_m = 0.01;
};

// Everything below the skin in the rest posture: what a skin is built around.
struct SkinBase {
  const Skeleton& skeleton;
  const Flesh& flesh;
  const PosedSkeleton& posedSkeleton;
  const PosedFlesh& posedFlesh;
  const RiggedModel* rig = nullptr;  // the skin is this mesh; nullptr: a grid around the flesh
  // What the skeleton calls the rig's joints; empty: as the rig does.
  std::span<const std::string> rigJoints{};
};

struct FaceSamples;
struct GridSkin;
struct GridRest;
struct GridQuantitySource;
struct MeshRest;
struct SurfaceRest;
struct RiggedSkin;
struct SkinFit;
class Skin;

// The rest shape, and what follows from it alone.
struct SkinShape {
  VectorArray rest;   // storage order, padding filled
  double size_m = 0;  // diagonal of its box
  std::vector<PointBlock> blocks;
  std::vector<std::size_t> fixedPoints;      // storage indices
  std::shared_ptr<const FaceSamples> faces;  // that may have to be lifted; nullptr: none
};

// What a skin is made of: each part is constant and shared with the skins that were edited from it.
struct SkinParts {
  std::shared_ptr<const SkinShape> shape;
  std::shared_ptr<const SkinQuantities> quantities;
  std::shared_ptr<const SkinTopology> topology;      // how points hang together
  std::shared_ptr<const SkinAttachment> attachment;  // what carries them
  std::shared_ptr<const PointModel> points;
  ContactResponse contactResponse;
  double defaultStep_s = 0;
  bool cloth = false;  // stepped by limits
  std::shared_ptr<const SelfContactModel> selfContact;
  std::shared_ptr<const FatPressureModel> fatPressure;
  std::shared_ptr<const Skin> coarse;
  std::shared_ptr<const SkinFit> fit;  // as it was laid around the flesh; none of a rig's mesh
  // Of one kind of skin only:
  std::shared_ptr<const GridSkin> grid;
  std::shared_ptr<const GridRest> gridRest;
  std::shared_ptr<const GridQuantitySource> gridQuantitySource;  // none of a coarse one's
  std::shared_ptr<const RiggedSkin> rigged;
  std::shared_ptr<const MeshRest> meshRest;
  std::shared_ptr<const SurfaceRest> surfaceRest;
  bool simulated = true;
};

// A constant elastic skin: geometry of rest, material, anchors (Turner & Gobbetti 1998,
// §3 and §4.1). Copies are cheap: they share all parts.
class Skin {
 public:
  // Reports every fault of `def` with pointers below `pointer`; with errors the result must not be
  // used. A grid shrink-wraps the flesh unless `def.points` brings a rest shape. Parts of the skin
  // that it was edited from (`before`, on the same rig if any) are taken over where nothing
  // that they are made of has changed; the rest shape of a grid then follows solids and joints
  // instead of being wrapped anew.
  Skin(const SkinDef& def, const SkinSettings& settings, const SkinBase& base,
       const std::string& pointer, Diagnostics& diagnostics, const Skin* before = nullptr);
  Skin(const SkinSettings& settings, SkinParts parts);

  // The same for every copy of a skin, and for no other skin of this process.
  std::uint64_t id() const { return id_; }
  const SkinParts& parts() const { return parts_; }

  const SkinTopology& topology() const { return *parts_.topology; }
  const SkinAttachment& attachment() const { return *parts_.attachment; }
  std::unique_ptr<SkinContact> makeContact() const;  // what keeps its points out
  std::size_t pointCount() const { return topology().pointCount(); }
  std::size_t storageIndex(std::size_t p) const { return topology().storageIndex(p); }

  // What only one kind has; nullptr: it is another kind. See grid_skin.h, rigged_skin.h and
  // surface_rest.h.
  const GridSkin* grid() const { return parts_.grid.get(); }
  const RiggedSkin* rigged() const { return parts_.rigged.get(); }
  const SurfaceRest* surface() const { return parts_.surfaceRest.get(); }

  const SkinSettings& settings() const { return settings_; }
  const PointModel& points() const { return *parts_.points; }
  const ContactResponse& contactResponse() const { return parts_.contactResponse; }
  const VectorArray& restPosition() const { return parts_.shape->rest; }
  const SkinQuantities& quantities() const { return *parts_.quantities; }
  std::span<const PointBlock> blocks() const { return parts_.shape->blocks; }
  std::span<const std::size_t> fixedPoints() const { return parts_.shape->fixedPoints; }
  double defaultStep_s() const { return parts_.defaultStep_s; }
  bool isCloth() const { return parts_.cloth; }  // stepped by limits, see cloth_stepper.h
  // The same skin at a resolution whose waves a step of about a millisecond resolves; nullptr if
  // this one's does. See leapfrog.h.
  const Skin* coarse() const { return parts_.coarse.get(); }
  double size_m() const { return parts_.shape->size_m; }  // diagonal of the rest shape's box
  const SelfContactModel* selfContact() const { return parts_.selfContact.get(); }  // or nullptr
  const FatPressureModel* fatPressure() const { return parts_.fatPressure.get(); }  // or nullptr
  // How it holds the flesh that it was laid around; nullptr: it was not made from that.
  const SkinFit* fit() const { return parts_.fit.get(); }

  // Whether it is stepped through time; else it follows from a pose, but for its jiggle.
  bool isSimulated() const { return parts_.simulated; }

 private:
  std::uint64_t id_;
  SkinSettings settings_;
  SkinParts parts_;
};

// What changes over time; a plain value. Arrays are in storage order, padding filled.
struct SkinState {
  VectorArray position, velocity;  // world, m and m/s
  PointSurroundings surroundings;  // of the interval that starts now
  VectorArray coarseVelocity;      // of the coarse surface under each point (see leapfrog.h), m/s
  std::vector<SkinState> coarse;   // the coarse skin's state, or none
  std::vector<Transform> joints;   // the pose of the last interval's end
  JiggleState jiggle;              // of an imported mesh that is not simulated
  float maxSpeed_m_per_s = 0;      // at the end of the last interval
  double odeStep_s = 0;            // that an adaptive integrator goes on with; 0: its first
  bool ready = false;              // surroundings belong to this state's time
  bool starting = false;           // moves with its flesh from the first interval on, unlagging

  void addTo(StateHash& hash, const SkinTopology& topology) const;
};

struct SkinStats {
  std::uint64_t steps = 0, rejected_steps = 0;
  double step_min_s = 1e300, step_max_s = 0;
  double forces_s = 0, constraints_s = 0, other_s = 0;  // wall clock spent
  double max_penetration_m = 0;       // deepest point at the end of any measured frame
  double max_face_depth_m = -1;       // deepest cut of a drawn face into a solid; -1: not measured
  double max_edge_stretch = 0;        // edge length over rest-shape length
  std::uint64_t repaired_points = 0;  // points that had to be put back (never-explodes)
};

// The flesh at any moment of the interval being simulated. The result stays valid until the next
// call.
class SkinPoseSource {
 public:
  virtual ~SkinPoseSource() = default;
  virtual SkinPose at(double time_s) = 0;
};

// Steps one skin; owns what memory that takes.
class SkinRun {
 public:
  virtual ~SkinRun() = default;
  virtual const Skin& skin() const = 0;
  virtual void advance(SkinPoseSource& poses, double start_s, double end_s, SkinState& state,
                       SkinStats& stats) = 0;
};

// Scratch memory that belongs to one run; copying a state does not need it.
class SkinWorkspace {
 public:
  SkinWorkspace();
  ~SkinWorkspace();
  SkinWorkspace(const SkinWorkspace&);  // copies start empty
  SkinWorkspace& operator=(const SkinWorkspace&);
  SkinRun& run(const Skin& skin);  // made on first use and for another skin

 private:
  std::unique_ptr<SkinRun> run_;
};

// The rest shape where a pose puts it: where a simulation starts, and where
// points go that cannot be simulated (a jump, a broken state). Velocities become 0.
void placeSkin(const Skin& skin, const SkinPose& pose, SkinState& state);

// Advances from start_s to end_s (at most 1/12 s later). Never fails: see never-explodes in
// docs/never-explodes.md.
void advanceSkin(const Skin& skin, SkinPoseSource& poses, double start_s, double end_s,
                 SkinState& state, SkinWorkspace& workspace, SkinStats& stats);

// Adds what a finished frame shows to `stats`: deepest point, and largest stretch as it is shown.
// Measured afresh, outside of the step.
void measureSkin(const Skin& skin, const SkinPose& pose, const SkinState& state, SkinStats& stats);

// Adds how deep the faces of `surface`, the state's, cut into the flesh.
void measureFaces(const DistanceField& flesh, const TriangleMesh& surface, SkinStats& stats);

// The same grid surface at another resolution (Turner & Gobbetti 1998, §6.5), at any
// moment of a run.
SkinState resampled(const Skin& from, const SkinState& state, const Skin& to);

// The surface of a state for display and export; vertex order and triangles are the same in every
// frame. Faces that flesh of the state's time comes through are lifted off it (face_lift.h). A
// mesh: its drawn vertices (RiggedModel::vertices), without normals. A grid: the tube with its ends
// capped, row by row columns + 1 points (the seam column twice for its uv), then the centres of the
// bottom and the top cap. uv: u around, (0,0) = the top end.
void skinSurface(const Skin& skin, const DistanceField& flesh, const SkinState& state,
                 TriangleMesh& mesh);

}  // namespace fascia
