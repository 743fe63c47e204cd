#include <fascia/fitting/fit_flesh.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/parallel.h>
#include <fascia/fitting/body_part.h>
#include <fascia/fitting/containment.h>
#include <fascia/fitting/coverage.h>

namespace fascia {
namespace {

constexpr double kLeastUsable = 0.2;  // share of a part's skin that must have room beneath
constexpr double kLeastArea = 2e-4;   // of the body's skin: smaller parts belong to their neighbour
constexpr Color kFlesh{0.72f, 0.28f, 0.26f};

struct NamedSolid {
  std::string suffix;  // after the joint's name
  FittedSolid solid;
  Color color;
};

struct PartFit {
  std::vector<NamedSolid> solids;
  std::string why;
  double residual_rms_m = 0;
};

std::string millimetres(double length_m) {
  return std::to_string(static_cast<long>(std::lround(1000 * length_m))) + " mm";
}

std::string whyNone(const BodySurface& surface, const BodyPart& part) {
  if (part.area_m2 <= 0) return "dominates no skin";
  if (part.area_m2 < kLeastArea * surface.area_m2())
    return "dominates next to no skin: left to its neighbour";
  if (part.usable < kLeastUsable) return "too thin for flesh under fat";
  return {};
}

PartFit fitPart(const BodySurface& surface, const Symmetry& symmetry, const BoneFrame& frame,
                std::size_t joint) {
  PartFit fit;
  const BodyPart part = findBodyPart(surface, symmetry, frame, joint);
  fit.why = whyNone(surface, part);
  if (!fit.why.empty()) return fit;
  const SolidTarget target = wholeTarget(surface, part, frame);
  const MirrorPlane* plane = part.paired ? &symmetry.plane : nullptr;
  FittedSolid solid = wholeGuess(surface, part, frame);
  if (!fitInside(surface, plane, 0.25 * surface.leastFat_m(), target, solid)) {
    fit.why = "nothing fits inside of the skin (radius " + millimetres(part.radius_m) + ")";
    return fit;
  }
  fit.solids.push_back({"", solid, kFlesh});
  fit.residual_rms_m = residualRms_m(target, solid);
  return fit;
}

void addSolids(const RiggedModel& model, const std::vector<BoneFrame>& frames, std::size_t joint,
               const PartFit& fit, const MirrorPlane* plane, FleshFit& out) {
  const std::string& name = model.joints[joint].name;
  for (const NamedSolid& named : fit.solids) {
    const FittedSolid solid = plane ? named.solid.mirrored(*plane) : named.solid;
    const std::string full = named.suffix.empty() ? name : name + " " + named.suffix;
    out.flesh.solids.push_back(solid.onJoint(full, name, frames[joint].world, named.color));
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

}  // namespace

FleshFit fitFlesh(const RiggedModel& model, const FitOptions& options) {
  FleshFit out;
  const BodySurface surface(model, options);
  const Symmetry symmetry = findSymmetry(model);
  const std::vector<BoneFrame> frames = findBoneFrames(model, surface, symmetry);
  out.skeleton = makeSkeleton(model, frames);
  std::vector<PartFit> fits(model.joints.size());
  parallelFor(fits.size(), [&](std::size_t j) {
    if (!symmetry.mirrored(j)) fits[j] = fitPart(surface, symmetry, frames[j], j);
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
  return out;
}

}  // namespace fascia
