#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <fascia/base/error.h>
#include <fascia/character/character.h>
#include <fascia/skin/grid/grid_skin.h>

namespace fascia::test {

inline FleshSolidDef ball(const std::string& name, const std::string& joint, double height_m,
                          double radius_m) {
  FleshSolidDef def;
  def.name = name;
  def.joint = joint;
  def.position_m = Vec3(0, height_m, 0);
  def.solid.parameters = {radius_m};
  return def;
}

inline TrackDef track(const std::string& joint, const std::string& dof, std::vector<Key> keys) {
  return {TrackDef::Target::joint, joint, dof, std::move(keys)};
}

// Hip, spine and neck; belly, chest and a head that swells when the neck bends.
inline CharacterDef smallCharacter() {
  CharacterDef def;
  def.name = "doll";
  const double quarter = kPi / 2;
  def.skeleton.joints = {
      {"hip", "", Vec3(0, 1, 0), Vec3::Zero(), {{Dof::tx}, {Dof::ty}, {Dof::tz}, {Dof::ry}}},
      {"spine",
       "hip",
       Vec3(0, 0.25, 0),
       Vec3::Zero(),
       {{Dof::rx, -quarter, quarter, 0}, {Dof::rz, -quarter, quarter, 0}}},
      {"neck", "spine", Vec3(0, 0.25, 0), Vec3::Zero(), {{Dof::rx, -quarter, quarter, 0}}}};
  def.flesh.solids = {ball("belly", "hip", 0, 0.25), ball("chest", "spine", 0.05, 0.2),
                      ball("head", "neck", 0.15, 0.15)};
  def.flesh.solids[2].drivers = {{"radius_m", "neck", Dof::rx, {{0, 0.15}, {quarter, 0.18}}}};
  def.skin.emplace();
  def.skin->grid.columns = 12;
  def.skin->grid.rows = 16;
  def.skin->grid.bottom.joint = "hip";
  def.skin->grid.top.joint = "neck";
  def.simulation.settle_s = 0.1;

  MotionDef sway{"sway", 2, true, {}};
  sway.tracks = {track("hip", "tx", {{0, 0}, {0.5, 0.3}, {1.5, -0.3}, {2, 0}}),
                 track("hip", "ry", {{0, 0}, {1, 1.5}, {2, 0}}),
                 track("spine", "rz", {{0, 0}, {0.4, 0.8}, {1.2, -0.8}, {2, 0}}),
                 track("neck", "rx", {{0, 0}, {0.7, 1.2}, {2, 0}})};
  def.motions = {sway};
  return def;
}

// Fine and stiff enough to ride on a coarse copy of itself.
inline CharacterDef fineCharacter(int side) {
  CharacterDef def = smallCharacter();
  def.skin->grid.columns = def.skin->grid.rows = side;
  def.skin->material.stretch_u_N_per_m = def.skin->material.stretch_v_N_per_m = 1500;
  def.skin->material.shear_N_per_m = 600;
  return def;
}

// From one posture to another and back, each time within a tenth of a millisecond, every `every_s`.
inline MotionDef teleport(double every_s, int times, double angle_rad, double way_m) {
  const auto keys = [&](double value) {
    std::vector<Key> out;
    const auto add = [&](double t, double v) { out.push_back({t, v, 1, 0, 0}); };
    add(0, 0);
    for (int n = 1; n <= times; ++n) {
      add((n - 0.5) * every_s - 1e-4, n % 2 ? 0 : value);
      add((n - 0.5) * every_s, n % 2 ? value : 0);
    }
    return out;
  };
  MotionDef motion{"teleport", (times + 1) * every_s, false, {}};
  motion.tracks = {track("hip", "tx", keys(way_m)), track("hip", "ry", keys(angle_rad)),
                   track("spine", "rx", keys(angle_rad)), track("spine", "rz", keys(-angle_rad)),
                   track("neck", "rx", keys(angle_rad))};
  return motion;
}

// Fixed points are placed, not moved: their velocities are made anew for every interval.
inline bool allFinite(const Character& character, const CharacterState& state) {
  const Skin& skin = *character.skin();
  std::vector<char> fixed(skin.topology().storage(), 0);
  for (const std::size_t k : skin.fixedPoints()) fixed[k] = 1;
  bool finite = true;
  for (std::size_t p = 0; p < skin.pointCount(); ++p) {
    const std::size_t k = skin.storageIndex(p);
    for (const auto axis : VectorArray::kAxes)
      finite = finite && std::isfinite((state.skin.position.*axis)[k]) &&
               (fixed[k] || std::isfinite((state.skin.velocity.*axis)[k]));
  }
  return finite;
}

inline bool sameBits(const VectorArray& a, const VectorArray& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}

// The longest edge over the size of the whole skin: an exploded skin is larger than its body.
inline double longestTriangleEdge(const Skin& skin, const SkinState& state) {
  TriangleMesh mesh;
  skin.topology().surface(state.position, mesh);
  float longest = 0;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      longest = std::max(longest, (mesh.positions[t[k]] - mesh.positions[t[(k + 1) % 3]]).norm());
  return double{longest} / skin.size_m();
}
inline double longestEdge(const Skin& skin, const SkinState& state) {
  if (!skin.grid()) return longestTriangleEdge(skin, state);
  const GridLayout& g = skin.grid()->layout();
  const VectorArray& r = state.position;
  float longest = 0;
  for (int j = 0; j < g.rows; ++j) {
    for (int i = 0; i < g.columns; ++i) {
      const std::size_t k = g.at(i, j);
      for (const std::size_t q : {g.at(g.wrapped(i + 1), j), g.at(i, std::min(j + 1, g.rows - 1))})
        longest = std::max(longest, std::hypot(r.x[q] - r.x[k], r.y[q] - r.y[k], r.z[q] - r.z[k]));
    }
  }
  return longest / skin.size_m();
}

// What the frames of a run showed at their worst.
struct Worst {
  bool finite = true;
  double penetration_m = 0, longestEdge = 0;
  double stretch = 0;      // of what is simulated; stats have that of what is shown
  double lastStretch = 0;  // of the last frame
  SkinStats stats;

  void add(const Worst& other) {
    finite = finite && other.finite;
    penetration_m = std::max(penetration_m, other.penetration_m);
    stretch = std::max(stretch, other.stretch);
    longestEdge = std::max(longestEdge, other.longestEdge);
    lastStretch = std::max(lastStretch, other.lastStretch);
  }
};

inline Worst simulate(const Character& character, int motion, double frame_s, int frames,
                      const std::function<void(CharacterState&, int)>& before = {}) {
  Worst worst;
  CharacterState state = initialState(character, character.source(motion));
  for (int f = 0; f < frames; ++f) {
    if (before) before(state, f);
    advance(character, character.source(motion), frame_s, state, worst.stats);
    worst.finite = worst.finite && allFinite(character, state);
    measureSkin(*character.skin(), {&state.flesh, state.skeleton.joint_world}, state.skin,
                worst.stats);
    worst.longestEdge = std::max(worst.longestEdge, longestEdge(*character.skin(), state.skin));
    worst.lastStretch = character.skin()->topology().maxStretch(state.skin.position);
    worst.stretch = std::max(worst.stretch, worst.lastStretch);
  }
  worst.penetration_m = worst.stats.max_penetration_m;
  return worst;
}

inline std::uint64_t hashAfter(const Character& character, int frames) {
  CharacterState state = initialState(character, character.source(0));
  SkinStats stats;
  for (int f = 0; f < frames; ++f) advance(character, character.source(0), 1.0 / 60, state, stats);
  return hashOf(character, state);
}

// Where building finds something wrong.
inline std::vector<std::string> faults(const CharacterDef& def, const BuildOptions& options = {}) {
  std::vector<std::string> pointers;
  try {
    const Character character(def, options);
  } catch (const Error& error) {
    for (const Issue& issue : error.issues()) pointers.push_back(issue.where.pointer);
  }
  return pointers;
}

}  // namespace fascia::test
