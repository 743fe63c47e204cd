#include <fascia/fitting/fit_flesh.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/parallel.h>
#include <fascia/fitting/containment.h>
#include <fascia/fitting/coverage.h>
#include <fascia/fitting/muscles.h>

namespace fascia {
namespace {

constexpr double kLeastUsable = 0.2;  // share of a part's skin that must have room beneath
constexpr double kLeastArea = 2e-4;   // of the body's skin: smaller parts belong to their neighbour

std::string millimetres(double length_m) {
  return std::to_string(static_cast<long>(std::lround(1000 * length_m))) + " mm";
}

std::string whyNone(const RestSurface& surface, const FleshPart& part) {
  if (part.area_m2 <= 0) return "dominates no skin";
  if (part.area_m2 < kLeastArea * surface.area_m2())
    return "dominates next to no skin: left to its neighbour";
  if (part.usable < kLeastUsable) return "too thin for flesh under fat";
  return {};
}

PartFit fitPart(const FitSetting& setting, const std::vector<BoneFrame>& frames,
                JointMeaning meaning, std::size_t joint) {
  PartFit fit;
  const BoneFrame& frame = frames[joint];
  const FleshPart part = findFleshPart(setting.surface, setting.symmetry, frame, joint);
  fit.why = whyNone(setting.surface, part);
  if (!fit.why.empty()) return fit;
  const BoneFrame* next =
      frame.mainChild < 0 ? nullptr : &frames[static_cast<std::size_t>(frame.mainChild)];
  fit.solids = fitMuscles(setting, part, frame, next, meaning);
  if (fit.solids.empty()) {
    FittedSolid solid = wholeGuess(setting.surface, part, frame);
    const SolidTarget target = wholeTarget(setting.surface, part, frame);
    if (!fitInside(setting.surface, setting.plane(part), setting.margin_m(), target, solid)) {
      fit.why = "nothing fits inside of the skin (radius " + millimetres(part.radius_m) + ")";
      return fit;
    }
    fit.solids.push_back({"", solid, kFlesh, 0});
  }
  addFillers(setting, part, frame, fit.solids);
  double square = 0, area_m2 = 0;
  const std::vector<double> gaps = gaps_m(part, fit.solids);
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    square += part.own[i].area_m2 * gaps[i] * gaps[i];
    area_m2 += part.own[i].area_m2;
  }
  fit.residual_rms_m = std::sqrt(square / area_m2);
  return fit;
}

// Radius ∝ 1/√length: a muscle that shortens swells, at constant volume.
std::vector<DriverDef> swelling(const NamedSolid& named, const std::string& joint) {
  std::vector<DriverDef> drivers;
  if (named.stretchPerRightAngle == 0) return drivers;
  const char* const names[] = {"half_x_m", "half_y_m", "half_z_m"};
  for (const int axis : {0, 1, 2}) {
    DriverDef driver;
    driver.parameter = names[axis];
    driver.joint = joint;
    driver.dof = Dof::rx;
    for (const double flexion : {-0.4, 0.0, 1.0, 1.6}) {  // right angles
      const double length = std::max(0.3, 1 + named.stretchPerRightAngle * flexion);
      driver.points.push_back(
          {flexion * kPi / 2,
           named.solid.half_m[axis] * (axis == 2 ? length : 1 / std::sqrt(length))});
    }
    drivers.push_back(std::move(driver));
  }
  return drivers;
}

void addSolids(const RiggedModel& model, const std::vector<BoneFrame>& frames, std::size_t joint,
               const PartFit& fit, const MirrorPlane* plane, FleshFit& out) {
  const std::string& name = model.joints[joint].name;
  for (const NamedSolid& named : fit.solids) {
    const FittedSolid solid = plane ? named.solid.mirrored(*plane) : named.solid;
    const std::string full = named.suffix.empty() ? name : name + " " + named.suffix;
    FleshSolidDef def = solid.onJoint(full, name, frames[joint].world, named.color);
    if (const int next = frames[joint].mainChild; next >= 0)
      def.drivers = swelling(named, model.joints[static_cast<std::size_t>(next)].name);
    out.flesh.solids.push_back(std::move(def));
    out.joints[joint].solids.push_back(full);
  }
  out.joints[joint].residual_rms_m = fit.residual_rms_m;
  out.joints[joint].why = fit.why;
}

std::vector<std::size_t> dominatedPoints(const RiggedModel& model) {
  std::vector<std::size_t> counts(model.joints.size(), 0);
  for (const PointWeights& w : model.weights) ++counts[w.joint[0]];
  return counts;
}

void addNotes(const RestSurface& surface, const Symmetry& symmetry, FleshFit& out) {
  const auto hidden = std::lround(100 * surface.hiddenShare());
  if (hidden > 0)
    out.notes.push_back(std::to_string(hidden) +
                        " % of the surface lies inside of its other pieces: flesh may cover it");
  if (!symmetry.present) out.notes.emplace_back("not symmetric: every side was fitted by itself");
}

}  // namespace

FleshFit fitFlesh(const RiggedModel& model, const FitOptions& options) {
  FleshFit out;
  const RestSurface surface(model, options);
  const Symmetry symmetry = findSymmetry(model);
  const std::vector<BoneFrame> frames = findBoneFrames(model, surface, symmetry);
  out.skeleton = makeSkeleton(model, frames);
  const FitSetting setting{surface, symmetry};
  const std::vector<JointMeaning> meanings = guessMeanings(model.joints);
  std::vector<PartFit> fits(model.joints.size());
  parallelFor(fits.size(), [&](std::size_t j) {
    if (symmetry.mirrored(j)) return;
    fits[j] = fitPart(setting, frames, meanings[j], j);
    // As much as the skin's muscles do: the picture of the anatomy agrees with it.
    for (NamedSolid& solid : fits[j].solids)
      solid.stretchPerRightAngle *= options.muscle / FitOptions{}.muscle;
  });
  out.joints.resize(model.joints.size());
  const std::vector<std::size_t> points = dominatedPoints(model);
  std::vector<FittedSolid> solids;
  std::vector<std::size_t> solidJoint;
  for (std::size_t j = 0; j < fits.size(); ++j) {
    const bool mirrored = symmetry.mirrored(j);
    const auto source = mirrored ? static_cast<std::size_t>(symmetry.partner[j]) : j;
    const MirrorPlane* plane = mirrored ? &symmetry.plane : nullptr;
    out.joints[j].joint = model.joints[j].name;
    out.joints[j].points = points[j];
    addSolids(model, frames, j, fits[source], plane, out);
    for (const NamedSolid& named : fits[source].solids) {
      solids.push_back(plane ? named.solid.mirrored(*plane) : named.solid);
      solidJoint.push_back(j);
    }
  }
  measureFit(surface, solids, solidJoint, out);
  addNotes(surface, symmetry, out);
  return out;
}

}  // namespace fascia
