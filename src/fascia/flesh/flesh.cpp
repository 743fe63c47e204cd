#include <fascia/flesh/flesh.h>

#include <map>

#include <fascia/base/assert.h>
#include <fascia/base/suggest.h>
#include <fascia/flesh/flesh_bound.h>
#include <fascia/flesh/names.h>
#include <fascia/motion/motion.h>
#include <fascia/skeleton/euler.h>

namespace fascia {
namespace {

// Joint values closer than this make slopes that overflow.
constexpr double kShortestInterval = 1e-9;

void validateNames(const FleshDef& def, const std::string& pointer, Diagnostics& diagnostics) {
  std::map<std::string_view, std::size_t> seen;
  for (std::size_t i = 0; i < def.solids.size(); ++i) {
    const std::string& name = def.solids[i].name;
    const std::string namePointer = pointer + "/" + std::to_string(i) + "/name";
    const auto [first, fresh] = seen.try_emplace(name, i);
    if (name.empty()) {
      diagnostics.error(namePointer, "a solid needs a name");
    } else if (!fresh) {
      diagnostics.error(namePointer, "a second solid named " + quotedName(name),
                        "the first is solid " + std::to_string(first->second));
    }
  }
}

void validatePoint(const DriverDef& def, std::size_t index, const ParameterInfo* info,
                   const std::string& pointer, Diagnostics& diagnostics) {
  const DriverDef::Point& point = def.points[index];
  const DriverDef::Point* before = index > 0 ? &point - 1 : nullptr;
  const std::size_t errorsBefore = diagnostics.errors().size();
  checkNumber(dofInfo(def.dof), point.jointValue, pointer + "/0", diagnostics);
  checkNumber(kKeyValue, point.parameter, pointer + "/1", diagnostics);
  if (diagnostics.errors().size() > errorsBefore) return;
  if (before && !(point.jointValue - before->jointValue >= kShortestInterval)) {
    diagnostics.error(pointer, "joint values must increase from point to point");
  } else if (info && (point.parameter < info->min || point.parameter > info->max)) {
    diagnostics.error(pointer, "found " + shortNumber(point.parameter) + ", expected " +
                                   std::string(info->name) + " in [" + shortNumber(info->min) +
                                   ", " + shortNumber(info->max) + "]");
  }
}

void validatePoints(const DriverDef& def, const ParameterInfo* info, const std::string& pointer,
                    Diagnostics& diagnostics) {
  if (def.points.size() < 2 || def.points.size() > DriverDef::kMost) {
    diagnostics.error(pointer, "found " + std::to_string(def.points.size()) +
                                   " points, expected 2 to " + std::to_string(DriverDef::kMost));
    return;
  }
  for (std::size_t i = 0; i < def.points.size(); ++i) {
    validatePoint(def, i, info, pointer + "/" + std::to_string(i), diagnostics);
  }
}

}  // namespace

Flesh::Flesh(const FleshDef& def, const Skeleton& skeleton, const std::string& pointer,
             Diagnostics& diagnostics, Role role) {
  if (def.solids.size() > kMostSolids) {
    diagnostics.error(pointer, "found " + std::to_string(def.solids.size()) +
                                   " solids, expected at most " + std::to_string(kMostSolids));
    return;
  }
  validateNames(def, pointer, diagnostics);
  defs_ = def.solids;
  auto bound = std::make_shared<Bound>();
  for (std::size_t i = 0; i < def.solids.size(); ++i) {
    const FleshSolidDef& solid = def.solids[i];
    const std::string solidPointer = pointer + "/" + std::to_string(i);
    validateTunables(solid, solidPointer, diagnostics);
    Entry entry;
    entry.joint = resolveJoint(skeleton, solid.joint, solidPointer + "/joint", diagnostics);
    entry.inJoint = {rotationZyx(solid.orientation_rad), solid.position_m};
    const Solid& rest = bound->rest.emplace_back(solid.solid, solidPointer, diagnostics);
    entry.firstDriver = bound->drivers.size();
    if (role == Role::ornament && !solid.drivers.empty()) {
      diagnostics.error(solidPointer + "/drivers", "an ornament is rigid: it cannot be driven",
                        "make it one of the solids");
    } else {
      addDrivers(solid, rest, skeleton, solidPointer, diagnostics, bound->drivers);
    }
    entry.driverCount = bound->drivers.size() - entry.firstDriver;
    solids_.push_back(std::move(entry));
  }
  bound_ = std::move(bound);
}

void Flesh::addDrivers(const FleshSolidDef& def, const Solid& solid, const Skeleton& skeleton,
                       const std::string& pointer, Diagnostics& diagnostics,
                       std::vector<Driver>& drivers) {
  std::map<int, std::size_t> driven;
  for (std::size_t k = 0; k < def.drivers.size(); ++k) {
    const DriverDef& driver = def.drivers[k];
    const std::string at = pointer + "/drivers/" + std::to_string(k);
    const int parameter = resolveParameter(solid, driver.parameter, at + "/parameter", diagnostics);
    const JointId joint = resolveJoint(skeleton, driver.joint, at + "/joint", diagnostics);
    const int value =
        joint.valid() ? resolveDof(skeleton, joint, driver.dof, at + "/dof", diagnostics) : -1;
    const bool known = parameter >= 0;
    const std::size_t errorsBefore = diagnostics.errors().size();
    validatePoints(driver, known ? &solid.parameterInfo(parameter) : nullptr, at + "/points",
                   diagnostics);
    if (known && !driven.try_emplace(parameter, k).second) {
      diagnostics.error(at + "/parameter", "a second driver for " + quotedName(driver.parameter),
                        "the first is driver " + std::to_string(driven[parameter]));
    }
    if (!known || value < 0 || diagnostics.errors().size() > errorsBefore) continue;
    drivers.push_back({value, parameter, DriverCurve(driver.points, driver.interpolation)});
  }
}

const Solid& Flesh::restSolid(SolidId id) const {
  FASCIA_ASSERT(bound_ && id.index() < bound_->rest.size(), "the solid is of this flesh");
  return bound_->rest[id.index()];
}

SolidId Flesh::find(std::string_view name) const {
  for (std::size_t i = 0; i < defs_.size(); ++i) {
    if (defs_[i].name == name) return SolidId{static_cast<std::int64_t>(i)};
  }
  return {};
}

}  // namespace fascia
