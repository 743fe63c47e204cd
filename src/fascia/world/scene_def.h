#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fascia/character/character.h>
#include <fascia/geometry/triangle_mesh.h>
#include <fascia/material/body_def.h>

namespace fascia {

// A solid with a place and a colour: what a body carries for the looks, or a thing that stands.
struct PlacedSolidDef {
  std::string name;
  SolidDef solid;
  Vec3 position_m = Vec3::Zero();       // in the body's undeformed space, or the world
  Vec3 orientation_rad = Vec3::Zero();  // Rz Ry Rx
  Color color{0.8f, 0.8f, 0.8f};
  double friction = 0.5;  // [0, 10]; of things that stand
};

struct NamedPlaceDef {
  std::string name;
  Vec3 position_m = Vec3::Zero();
};

// How much a body's start differs from run to run: uniformly up to ± these (seed 0: not at all).
struct ScatterDef {
  Vec3 position_m = Vec3::Zero();  // of plates z is the layer that they are drawn in
  Vec3 orientation_rad = Vec3::Zero();
  Vec3 velocity_m_per_s = Vec3::Zero();
};

// A linear deformable body. What it is made of is one of three: a solid; in two dimensions an
// outline, which is drawn as a plate; the inside of a closed mesh.
struct SceneBodyDef : BodyMaterialDef {
  enum class Form { solid, outline, mesh };

  std::string name;  // without '.': points are "body.point"
  Form form = Form::solid;
  SolidDef solid;
  std::vector<Vec2> outline_m;  // around, in either sense
  bool smooth_outline = false;  // a closed curve through the points instead of a polygon
  double thickness_m = 0.05;    // of the plate
  bool inflated = false;        // drawn with a round rim, like a cushion
  std::string mesh_file;        // glTF beside the scene
  std::shared_ptr<const TriangleMesh> mesh;  // read from the file; not saved

  BodyBasisDef basis;
  Vec3 position_m = Vec3::Zero();  // of plates z is the layer that they are drawn in
  Vec3 orientation_rad = Vec3::Zero();
  Vec3 velocity_m_per_s = Vec3::Zero();
  Vec3 spin_rad_per_s = Vec3::Zero();
  ScatterDef scatter;
  bool collides = true;
  double friction = 0.5;              // [0, 10]; with another body: the geometric mean of both
  std::vector<NamedPlaceDef> points;  // material points, undeformed
  Color color{0.55f, 0.72f, 0.42f};
  std::vector<PlacedSolidDef> ornaments;  // carried along, without mass
};

// What ties points together from the start. Points are "body.point" or the name of a place.
struct SceneConstraintDef {
  enum class Kind { attach, nail, line, plane, rod, spring };
  std::string name;
  Kind kind = Kind::attach;
  std::vector<std::string> points;  // attach, rod, spring: two; nail: one or two; line, plane: one
  Vec3 direction{0, 1, 0};          // of the line, or the plane's normal
  double length_m = 0;              // of a rod or spring; 0 = as at the start, or 0 for a spring
  double stiffness_N_per_m = 100, damping_Ns_per_m = 0;  // of a spring
};

// A keyframed motion of a body's point.
struct ScenePathDef {
  struct Key {
    double time_s = 0;
    Vec3 position_m = Vec3::Zero();
    // Missing: as smooth as it can be. With only the first the path leaves as it arrives.
    std::optional<Vec3> velocity_m_per_s, leaving_m_per_s;
  };
  std::string point;
  std::vector<Key> keys;
  double preroll_s = 0.25;  // [0, 60]; before the first key the point is led onto the path
};

// A character that performs in the scene, in its own way.
struct SceneCharacterDef {
  std::string name;    // its joints are points "name.joint"
  std::string file;    // *.fascia.json beside the scene
  std::string motion;  // empty = its first
  Vec3 position_m = Vec3::Zero();
  double heading_rad = 0;                      // turned about y
  double friction = 0.5;                       // [0, 10]; of its flesh
  std::shared_ptr<const Character> character;  // built from the file; not saved
};

// From the character's own space into the scene's.
Transform placeOf(const SceneCharacterDef& character);

struct GroundDef {
  double height_m = 0;
  double friction = 0.6;  // [0, 10]
};

// What a picture shows by itself.
struct ViewDef {
  std::string camera;  // as on the command line; empty: "front" in two dimensions
  Vec3 low_m = Vec3::Zero(), high_m = Vec3::Zero();  // a box to be seen; equal: all that moves
};

struct SceneSimulationDef {
  double duration_s = 5;            // (0, 3600]; what a bake takes by itself
  double frame_rate_hz = 60;        // [1, 1000]
  double step_s = 1.0 / 120;        // (0, 1/12]; at most; a frame is a whole number of steps
  std::string scheme = "implicit";  // implicit, explicit, energy: see BodyScheme
  Vec3 gravity_m_per_s2{0, -9.81, 0};
};

// What a *.fascia.json of kind "scene" holds: bodies, what ties and drives them, and characters
// among them. Plain values; y is up, metres.
struct SceneDef {
  std::string name;
  std::string description;
  int dimension = 3;  // of all bodies: 2 or 3
  std::vector<SceneBodyDef> bodies;
  std::vector<NamedPlaceDef> places;
  std::vector<SceneConstraintDef> constraints;
  std::vector<ScenePathDef> paths;
  std::vector<SceneCharacterDef> characters;
  std::vector<PlacedSolidDef> props;  // rigid, at rest
  std::optional<GroundDef> ground;
  ViewDef view;
  std::string script;       // a *.lua file beside the scene
  std::string script_text;  // what is in it; not saved
  SceneSimulationDef simulation;
  std::string folder;  // where the file lies. Not saved.
};

}  // namespace fascia
