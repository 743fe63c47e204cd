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
  double friction = 0.5;  // of things that stand
};
inline constexpr NumberRange kSceneLengths{-1e6, 1e6}, kSceneAngles_deg{-36000, 36000},
    kFrictions{0, 10};
constexpr auto tunables(const PlacedSolidDef*) {
  using P = PlacedSolidDef;
  return std::tuple{tunable(&P::position_m, "position_m", "m", kSceneLengths,
                            "In the world; of an ornament in the undeformed body"),
                    tunable(&P::orientation_rad, "orientation_deg", "deg", kSceneAngles_deg,
                            "Turns about x, y, z; applied as Rz Ry Rx"),
                    tunable(&P::friction, "friction", "", kFrictions, "Coulomb's coefficient")};
}

struct NamedPlaceDef {
  std::string name;
  Vec3 position_m = Vec3::Zero();
};
// The place is the value of the name.
inline constexpr TunableInfo kNamedPlace{"places, points", "m", kSceneLengths,
                                         "A place by its name"};

// How much a body's start differs from run to run: uniformly up to ± these (seed 0: not at all).
struct ScatterDef {
  Vec3 position_m = Vec3::Zero();  // of plates z is the layer that they are drawn in
  Vec3 orientation_rad = Vec3::Zero();
  Vec3 velocity_m_per_s = Vec3::Zero();
};
constexpr auto tunables(const ScatterDef*) {
  using S = ScatterDef;
  return std::tuple{
      tunable(&S::position_m, "position_m", "m", kSceneLengths, "Each axis"),
      tunable(&S::orientation_rad, "orientation_deg", "deg", kSceneAngles_deg, "Each turn"),
      tunable(&S::velocity_m_per_s, "velocity_m_per_s", "m/s", kSceneLengths, "Each axis")};
}

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
  double friction = 0.5;              // with another body: the geometric mean of both
  std::vector<NamedPlaceDef> points;  // material points, undeformed
  Color color{0.55f, 0.72f, 0.42f};
  std::vector<PlacedSolidDef> ornaments;  // carried along, without mass
};
constexpr auto tunables(const SceneBodyDef*) {
  using B = SceneBodyDef;
  return std::tuple_cat(
      tunables(static_cast<const BodyMaterialDef*>(nullptr)),
      std::tuple{
          tunable(&B::position_m, "position_m", "m", kSceneLengths,
                  "Where its origin is at the start; of plates z is the layer they are drawn in"),
          tunable(&B::orientation_rad, "orientation_deg", "deg", kSceneAngles_deg,
                  "Turns about x, y, z; applied as Rz Ry Rx"),
          tunable(&B::velocity_m_per_s, "velocity_m_per_s", "m/s", kSceneLengths,
                  "Of its centre, at the start"),
          tunable(&B::spin_rad_per_s, "spin_deg_per_s", "deg/s", kSceneAngles_deg, "At the start"),
          tunable(&B::collides, "collides", "With ground, props, characters, other bodies"),
          tunable(&B::friction, "friction", "", kFrictions, "Coulomb's coefficient")});
}
// Of outlines only.
inline constexpr auto kSmoothOutline =
    tunable(&SceneBodyDef::smooth_outline, "smooth_outline",
            "A closed curve through the points; a point twice in a row is a corner");
inline constexpr auto kPlateThickness =
    tunable(&SceneBodyDef::thickness_m, "thickness_m", "m", positive(1e3), "Of the plate");
inline constexpr auto kInflated =
    tunable(&SceneBodyDef::inflated, "inflated", "Drawn with a round rim, like a cushion");

// What ties points together from the start. Points are "body.point" or the name of a place.
struct SceneConstraintDef {
  enum class Kind { attach, nail, line, plane, rod, spring };
  std::string name;
  Kind kind = Kind::attach;
  std::vector<std::string> points;  // attach, rod, spring: two; nail: one or two; line, plane: one
  Vec3 direction{0, 1, 0};          // of the line, or the plane's normal
  double length_m = 0;              // of a rod or spring
  double stiffness_N_per_m = 100, damping_Ns_per_m = 0;  // of a spring
};
constexpr auto tunables(const SceneConstraintDef*) {
  using C = SceneConstraintDef;
  return std::tuple{
      tunable(&C::direction, "direction", "", kSceneLengths, "Of the line, or the plane's normal"),
      tunable(&C::length_m, "length_m", "m", {0, 1e6},
              "Of a rod, 0: as at the start; of a spring, 0: pulls the points together"),
      tunable(&C::stiffness_N_per_m, "stiffness_N_per_m", "N/m", positive(1e12), "Of a spring"),
      tunable(&C::damping_Ns_per_m, "damping_Ns_per_m", "N s/m", {0, 1e12}, "Of a spring")};
}

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
  double preroll_s = 0.25;
};
constexpr auto tunables(const ScenePathDef::Key*) {
  using K = ScenePathDef::Key;
  return std::tuple{tunable(&K::time_s, "time_s", "s", {0, 86400}, "When").required(),
                    tunable(&K::position_m, "position_m", "m", kSceneLengths, "Where").required(),
                    tunable(&K::velocity_m_per_s, "velocity_m_per_s", "m/s", kSceneLengths,
                            "Missing: as smooth as can be"),
                    tunable(&K::leaving_m_per_s, "leaving_m_per_s", "m/s", kSceneLengths,
                            "If another than that of arriving: a bounce, by an impulse")};
}
constexpr auto tunables(const ScenePathDef*) {
  return std::tuple{tunable(&ScenePathDef::preroll_s, "preroll_s", "s", {0, 60},
                            "For so long before the first key the point is led onto the path")};
}

// A character that performs in the scene, in its own way.
struct SceneCharacterDef {
  std::string name;    // its joints are points "name.joint"
  std::string file;    // *.fascia.json beside the scene
  std::string motion;  // empty = its first
  Vec3 position_m = Vec3::Zero();
  double heading_rad = 0;
  double friction = 0.5;                       // of its flesh
  std::shared_ptr<const Character> character;  // built from the file; not saved
};
constexpr auto tunables(const SceneCharacterDef*) {
  using C = SceneCharacterDef;
  return std::tuple{
      tunable(&C::position_m, "position_m", "m", kSceneLengths, "Where its origin stands"),
      tunable(&C::heading_rad, "heading_deg", "deg", kSceneAngles_deg, "Turned about y"),
      tunable(&C::friction, "friction", "", kFrictions, "Of its flesh")};
}

// From the character's own space into the scene's.
Transform placeOf(const SceneCharacterDef& character);

struct GroundDef {
  double height_m = 0;
  double friction = 0.6;
};
constexpr auto tunables(const GroundDef*) {
  return std::tuple{
      tunable(&GroundDef::height_m, "height_m", "m", kSceneLengths, "Of its surface"),
      tunable(&GroundDef::friction, "friction", "", kFrictions, "Coulomb's coefficient")};
}

// What a picture shows by itself.
struct ViewDef {
  std::string camera;  // as on the command line; empty: "front" in two dimensions
  Vec3 low_m = Vec3::Zero(), high_m = Vec3::Zero();  // a box to be seen; equal: all that moves
};
constexpr auto tunables(const ViewDef*) {
  return std::tuple{tunable(&ViewDef::low_m, "low_m", "m", kSceneLengths,
                            "A corner of the box that is to be seen"),
                    tunable(&ViewDef::high_m, "high_m", "m", kSceneLengths,
                            "The other; missing: all that moves is seen")};
}

std::vector<std::string_view> bodySchemes();  // see BodyScheme

struct SceneSimulationDef {
  double duration_s = 5;
  double frame_rate_hz = 60;
  double step_s = 1.0 / 120;
  std::string scheme = "implicit";
  Vec3 gravity_m_per_s2{0, -9.81, 0};
};
constexpr auto tunables(const SceneSimulationDef*) {
  using S = SceneSimulationDef;
  return std::tuple{
      tunable(&S::duration_s, "duration_s", "s", {1e-3, 3600}, "What a bake takes by itself"),
      tunable(&S::frame_rate_hz, "frame_rate_hz", "Hz", {1, 1000}, "Frames that a bake writes"),
      tunable(&S::step_s, "step_s", "s", {1e-5, kLongestFrame_s},
              "At most; a frame is a whole number of steps"),
      wordTunable(&S::scheme, "scheme", &bodySchemes,
                  "implicit: stable at any stiffness, damps; energy: keeps energy, without "
                  "contact; explicit: cheap, for soft bodies without contact"),
      tunable(&S::gravity_m_per_s2, "gravity_m_per_s2", "m/s²", {-1000, 1000}, "y is up")};
}

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

// Reports every number and word that is out of its range, with JSON pointers.
void validateValues(const SceneDef& scene, Diagnostics& diagnostics);
// Warns of settings that differ from their defaults and have no effect where they are.
void warnOfIdleSettings(const SceneDef& scene, Diagnostics& diagnostics);

}  // namespace fascia
