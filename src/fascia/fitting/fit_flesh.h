#pragma once

#include <string>
#include <vector>

#include <fascia/flesh/flesh.h>
#include <fascia/rig/rigged_model.h>
#include <fascia/skeleton/skeleton.h>

namespace fascia {

struct FitOptions {
  double fat_share = 0.18;   // (0, 0.9]; thickness of fat over the local radius of the body
  double muscle = 0.3;       // [0, 1]; how far muscles swell in a bend: 0.3 as muscles do
  double least_fat = 0.002;  // of the model's height: no solid comes nearer to the surface
};

// What the fit did for one joint.
struct JointFit {
  std::string joint;
  std::size_t points = 0;  // that it dominates
  std::vector<std::string> solids;
  std::string why;            // where there are none
  double coverage = 0;        // [0, 1]: share of its points with flesh beneath (along the normal)
  double residual_rms_m = 0;  // distance of solids' surface to the inset points
  double deepest_outside_m = 0;  // how far a solid comes out of the skin (0 wanted)
};

struct FleshFit {
  SkeletonDef skeleton;  // the rig's joints, rigid frames; x = axis of the main bend
  FleshDef flesh;        // names "upper_arm.L", "upper_arm.L biceps" …; drivers for what swells
  std::vector<JointFit> joints;
  std::vector<std::string> notes;  // on the whole model, for a person
  double coverage = 0, residual_rms_m = 0, deepest_outside_m = 0;
};

// Fills a rigged mesh with solids: tapered, bent capsules and superellipsoids per joint, fitted by
// least squares to the points that it dominates, inset by the fat. Deterministic.
FleshFit fitFlesh(const RiggedModel& model, const FitOptions& options = {});

}  // namespace fascia
