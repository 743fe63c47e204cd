#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fascia/deformable/body/body_model.h>
#include <fascia/deformable/surfaces/body_surface.h>
#include <fascia/world/scene_def.h>

namespace fascia {

// A constant, validated scene, ready for any number of performances.
class Stage {
 public:
  // Throws Error with all faults of `def` (JSON pointers, no file or line). Characters, meshes and
  // the script must have been read.
  explicit Stage(SceneDef def);

  // What stops nothing but is hardly meant, of the scene's own and of its characters' files; see
  // Character.
  const std::vector<Issue>& warnings() const { return warnings_; }
  void setWarnings(std::vector<Issue> warnings) { warnings_ = std::move(warnings); }

  const SceneDef& def() const { return def_; }
  const BodyModel& bodies() const { return model_; }
  const SceneBodyDef& body(BodyId id) const { return def_.bodies[id.index()]; }
  const BodySurfacePtr& surface(BodyId id) const { return surfaces_[id.index()]; }
  std::span<const BodySurfacePtr> surfaces() const { return surfaces_; }
  // What a body looks like, as a mesh of undeformed points, and its ornaments likewise, in the
  // order of its definition.
  const TriangleMesh& look(BodyId id) const { return looks_[id.index()]; }
  const std::vector<TriangleMesh>& ornaments(BodyId id) const { return ornaments_[id.index()]; }
  // The things that stand: a field of one rigid solid each.
  const PosedFlesh& prop(std::size_t i) const { return props_[i].posed; }
  std::size_t stepsPerFrame(double frameRate_hz) const;

  // A material point of a body by name: "body.point", or "body" for its centre of mass.
  struct NamedBodyPoint {
    std::string name;
    BodyPoint point;
  };
  std::span<const NamedBodyPoint> points() const { return points_; }
  // nullptr if there is none.
  const BodyPoint* findPoint(std::string_view name) const;
  const Vec3* findPlace(std::string_view name) const;

  // The bodies as the file puts them; scattered by the seed unless that is 0.
  OdeState startState(std::uint64_t seed) const;
  // What ties points from the start, made for bodies in that state. Springs are soft.
  struct Tie {
    ConstraintPtr constraint;
    bool soft = false;
    double stiffness_N_per_m = 0, damping_Ns_per_m = 0;
  };
  std::vector<Tie> ties(const OdeState& start) const;

 private:
  void addBody(std::size_t index, Diagnostics& diagnostics);
  void addKind(const SceneBodyDef& body, const std::string& pointer, Diagnostics& diagnostics);
  void countNumbers(int coordinates);
  void addNames(Diagnostics& diagnostics);
  void addProps(Diagnostics& diagnostics);
  void checkConstraints(Diagnostics& diagnostics) const;
  void checkPaths(Diagnostics& diagnostics) const;
  void checkScheme(Diagnostics& diagnostics) const;
  void checkPoint(const std::string& name, bool orPlace, const std::string& pointer,
                  Diagnostics& diagnostics) const;
  Tie tie(const SceneConstraintDef& def, const OdeState& start) const;

  SceneDef def_;
  BodyModel model_;
  std::vector<std::size_t> kinds_;                    // bodies that differ in more than their place
  std::vector<BodyShapePtr> shapes_;                  // per body
  std::size_t matrixNumbers_ = 0;                     // of all bodies' matrices
  std::vector<BodySurfacePtr> surfaces_;              // per body
  std::vector<TriangleMesh> looks_;                   // per body
  std::vector<std::vector<TriangleMesh>> ornaments_;  // per body
  std::vector<NamedBodyPoint> points_;
  struct Prop {
    Flesh flesh;
    PosedFlesh posed;
  };
  std::vector<Prop> props_;
  std::vector<Issue> warnings_;
};

}  // namespace fascia
