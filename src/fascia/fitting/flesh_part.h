#pragma once

#include <string>
#include <vector>

#include <fascia/fitting/joint_frames.h>
#include <fascia/fitting/solid_fitting.h>

namespace fascia {

// The piece of the body that one joint moves, as its solids' fit wants it. For joints that have a
// mirror image the image's skin is included, mirrored: both get the same solids.
struct FleshPart {
  std::size_t joint = 0;
  bool central = false, paired = false;
  Vec3 axis = Vec3::UnitY();         // along the bone
  Vec3 across = Vec3::UnitX();       // the solids' y: lateral for parts in the plane of symmetry
  Vec3 middle_m = Vec3::Zero();      // of the body there
  double area_m2 = 0;                // of the skin that it dominates
  double usable = 0;                 // share of that which has room for flesh beneath
  double radius_m = 0;               // median of the local radius where there is room
  double low_m = 0, high_m = 0;      // where it begins and ends along the axis, from the joint
  std::vector<SurfaceSample> own;    // dominated, with room beneath
  std::vector<SurfaceSample> blend;  // shared with neighbours, with room beneath
  std::vector<Vec3> near;            // the rest of the skin around
};

FleshPart findFleshPart(const RestSurface& surface, const Symmetry& symmetry,
                        const BoneFrame& frame, std::size_t joint);

// The same part with only some of its skin.
FleshPart subPart(const Symmetry& symmetry, const BoneFrame& frame, const FleshPart& whole,
                  std::vector<SurfaceSample> own, bool central);

// Radius of the ball of flesh around a point that fits under skin and fat; 0 outside.
double depth_m(const RestSurface& surface, const Vec3& p);

// Reaches the part's skin and keeps under all the skin around.
SolidTarget surfaceTarget(const RestSurface& surface, const FleshPart& part);
// A target for one solid that fills the whole part, and where to begin.
SolidTarget wholeTarget(const RestSurface& surface, const FleshPart& part, const BoneFrame& frame);
FittedSolid wholeGuess(const RestSurface& surface, const FleshPart& part, const BoneFrame& frame);

}  // namespace fascia
