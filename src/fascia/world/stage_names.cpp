// The points of a stage by name, and what its file ties and leads by them.

#include <algorithm>
#include <cmath>

#include <fascia/base/suggest.h>
#include <fascia/world/stage.h>

namespace fascia {
namespace {

using Kind = SceneConstraintDef::Kind;

// How many points a constraint takes.
struct Takes {
  std::size_t least, most;
};
Takes pointsOf(Kind kind) {
  switch (kind) {
    case Kind::attach:
    case Kind::rod:
    case Kind::spring:
      return {2, 2};
    case Kind::nail:
      return {1, 2};
    case Kind::line:
    case Kind::plane:
      break;
  }
  return {1, 1};
}

}  // namespace

void Stage::addNames(Diagnostics& diagnostics) {
  for (std::size_t b = 0; b < def_.bodies.size(); ++b) {
    const SceneBodyDef& body = def_.bodies[b];
    const std::string pointer = entryOf("/bodies", b);
    if (body.name.find('.') != std::string::npos)
      diagnostics.error(pointer + "/name", "found " + quotedName(body.name),
                        "a body's name has no '.': its points are called \"body.point\"");
    points_.push_back({body.name, {BodyId(b), model_.shape(BodyId(b)).center_m()}});
    for (const NamedPlaceDef& point : body.points)
      points_.push_back({body.name + "." + point.name, {BodyId(b), point.position_m}});
  }
  std::ranges::sort(points_, {}, &NamedBodyPoint::name);
  for (std::size_t i = 0; i < def_.places.size(); ++i)
    if (findPoint(def_.places[i].name))
      diagnostics.error(entryOf("/places", i) + "/name",
                        quotedName(def_.places[i].name) + " is a body already",
                        "give the place another name");
}

const BodyPoint* Stage::findPoint(std::string_view name) const {
  const auto found = std::ranges::lower_bound(points_, name, {}, &NamedBodyPoint::name);
  return found != points_.end() && found->name == name ? &found->point : nullptr;
}

const Vec3* Stage::findPlace(std::string_view name) const {
  const auto found = std::ranges::find(def_.places, name, &NamedPlaceDef::name);
  return found != def_.places.end() ? &found->position_m : nullptr;
}

void Stage::checkPoint(const std::string& name, bool orPlace, const std::string& pointer,
                       Diagnostics& diagnostics) const {
  if (findPoint(name) || (orPlace && findPlace(name))) return;
  if (findPlace(name)) {
    diagnostics.error(pointer, quotedName(name) + " is a place, expected a body's point",
                      "name a point as \"body.point\"");
    return;
  }
  NearestName nearest(name);
  for (const NamedBodyPoint& point : points_) nearest.offer(point.name);
  if (orPlace)
    for (const NamedPlaceDef& place : def_.places) nearest.offer(place.name);
  diagnostics.error(pointer, "no point is named " + quotedName(name), nearest.hint());
}

void Stage::checkConstraints(Diagnostics& diagnostics) const {
  for (std::size_t i = 0; i < def_.constraints.size(); ++i) {
    const SceneConstraintDef& def = def_.constraints[i];
    const std::string pointer = entryOf("/constraints", i);
    const Takes takes = pointsOf(def.kind);
    if (def.points.size() < takes.least || def.points.size() > takes.most) {
      diagnostics.error(pointer + "/points",
                        "found " + std::to_string(def.points.size()) + " points, expected " +
                            std::to_string(takes.least) +
                            (takes.most > takes.least ? " or " + std::to_string(takes.most) : ""));
      continue;
    }
    for (std::size_t p = 0; p < def.points.size(); ++p)
      checkPoint(def.points[p], p > 0, entryOf(pointer + "/points", p), diagnostics);
    if ((def.kind == Kind::line || def.kind == Kind::plane) && !(def.direction.norm() > 0))
      diagnostics.error(pointer + "/direction", "found no direction, expected any length but 0");
  }
}

void Stage::checkPaths(Diagnostics& diagnostics) const {
  for (std::size_t i = 0; i < def_.paths.size(); ++i) {
    const ScenePathDef& path = def_.paths[i];
    const std::string pointer = entryOf("/paths", i);
    checkPoint(path.point, false, pointer + "/point", diagnostics);
    if (path.keys.empty())
      diagnostics.error(pointer + "/keys", "found no keys, expected at least one");
    for (std::size_t k = 1; k < path.keys.size(); ++k)
      if (!(path.keys[k].time_s > path.keys[k - 1].time_s))
        diagnostics.error(entryOf(pointer + "/keys", k) + "/time_s",
                          "found " + shortNumber(path.keys[k].time_s) + " after " +
                              shortNumber(path.keys[k - 1].time_s),
                          "keys are in the order of their times");
  }
}

void Stage::checkScheme(Diagnostics& diagnostics) const {
  const std::string& scheme = def_.simulation.scheme;
  const bool contact = def_.ground || !def_.props.empty() || !def_.characters.empty();
  if ((scheme == "explicit" || scheme == "energy") && contact)
    diagnostics.error("/simulation/scheme",
                      "found " + quotedName(scheme) + ", but contact needs \"implicit\"",
                      "without ground, props and characters the others can be used");
}

namespace {

// Without a name of its own it is known by what it ties.
std::string nameOf(const SceneConstraintDef& def) {
  std::string name = def.name;
  if (name.empty())
    for (const std::string& point : def.points) name += (name.empty() ? "" : " – ") + point;
  return name;
}

}  // namespace

Stage::Tie Stage::tie(const SceneConstraintDef& def, const OdeState& start) const {
  const BodyPoint a = *findPoint(def.points[0]);
  const BodyPoint* b = def.points.size() > 1 ? findPoint(def.points[1]) : nullptr;
  const Vec3 placeA = model_.point(start.r, a);
  const Vec3 placeB = def.points.size() < 2 ? placeA
                      : b                   ? model_.point(start.r, *b)
                                            : *findPlace(def.points[1]);
  const std::string name = nameOf(def);
  switch (def.kind) {
    case Kind::line:
      return {makePointOnLine(name, a, placeA, def.direction)};
    case Kind::plane:
      return {makePointOnPlane(name, a, placeA, def.direction)};
    case Kind::rod:
    case Kind::spring: {
      const bool spring = def.kind == Kind::spring;
      const double atStart = spring ? 0 : (placeA - placeB).norm();
      const double length = def.length_m > 0 ? def.length_m : atStart;
      ConstraintPtr made = length == 0 ? b ? makeAttachment(name, a, *b) : makeNail(name, a, placeB)
                           : b ? makeRod(name, a, *b, length)
                                       : makeTether(name, a, placeB, length);
      return {std::move(made), spring, def.stiffness_N_per_m, def.damping_Ns_per_m};
    }
    case Kind::attach:
    case Kind::nail:
      break;
  }
  return {b ? makeAttachment(name, a, *b) : makeNail(name, a, placeB)};
}

std::vector<Stage::Tie> Stage::ties(const OdeState& start) const {
  std::vector<Tie> out;
  for (const SceneConstraintDef& def : def_.constraints) out.push_back(tie(def, start));
  return out;
}

}  // namespace fascia
