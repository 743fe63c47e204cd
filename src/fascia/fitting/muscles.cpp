#include <fascia/fitting/muscles.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fascia/fitting/containment.h>

namespace fascia {
namespace {

constexpr double kLeastSlenderness = 1.7;  // length over radius of what counts as a limb
constexpr double kLeastRadius = 4.5;       // over the least fat; slimmer limbs are one solid
constexpr double kBoneRadius = 0.28;       // of the flesh's
constexpr double kSectorHalfAngle = 1.25;  // rad; three sectors overlap a little
constexpr double kFlexorStretch = -0.16, kExtensorStretch = 0.05;  // per right angle of flexion

struct Belly {
  std::string suffix;
  double angle_rad;  // around the bone, from the side of flexion
  double stretch;
  Color color;
};

std::array<Belly, 3> bellies(JointMeaning meaning) {
  std::string flexor = "flexor", extensor = "extensor";
  if (meaning.part == BodyPart::upperArm) flexor = "biceps", extensor = "triceps";
  if (meaning.part == BodyPart::upperLeg) flexor = "hamstring", extensor = "quadriceps";
  if (meaning.part == BodyPart::lowerLeg) flexor = "shin", extensor = "calf";
  return {Belly{flexor, 0, kFlexorStretch, {0.74f, 0.27f, 0.25f}},
          Belly{extensor + " 1", 2 * kPi / 3, kExtensorStretch, {0.68f, 0.23f, 0.22f}},
          Belly{extensor + " 2", -2 * kPi / 3, kExtensorStretch, {0.78f, 0.32f, 0.28f}}};
}

// A limb's section in its own directions: z along the bone, x towards flexion of the next joint.
struct Limb {
  Transform world;       // origin at the joint
  double low_m, high_m;  // along the bone: parts at shoulders and hips begin before the joint
  double length_m, radius_m;
};

bool isLimb(const FitSetting& setting, const FleshPart& part, const BoneFrame& frame,
            const BoneFrame* next, JointMeaning meaning) {
  for (const BodyPart broad :
       {BodyPart::clavicle, BodyPart::pelvis, BodyPart::hand, BodyPart::foot, BodyPart::toe}) {
    if (meaning.part == broad) return false;
  }
  return next && !part.central && frame.length_m > kLeastSlenderness * part.radius_m &&
         part.high_m - part.low_m > kLeastSlenderness * part.radius_m &&
         part.radius_m > kLeastRadius * setting.surface.leastFat_m();
}

Limb limbOf(const FleshPart& part, const BoneFrame& frame, const BoneFrame& next) {
  const Vec3 z = (frame.end_m - frame.world.translation_m).normalized();
  // Under a turn about +x the next bone moves to x × bone.
  Vec3 x = next.world.rotation.col(0).cross(next.world.rotation.col(1));
  x -= x.dot(z) * z;
  x = x.norm() > 0.2 ? Vec3(x.normalized()) : Vec3(frame.world.rotation.col(2));
  Limb limb{{Mat3::Identity(), frame.world.translation_m},
            std::clamp(part.low_m, -part.radius_m, 0.0),
            frame.length_m,
            frame.length_m,
            part.radius_m};
  limb.world.rotation << x, z.cross(x), z;
  return limb;
}

std::vector<SurfaceSample> sector(const FleshPart& part, const Limb& limb, double angle_rad) {
  std::vector<SurfaceSample> chosen;
  for (const std::vector<SurfaceSample>* all : {&part.own, &part.blend}) {
    for (const SurfaceSample& s : *all) {
      const Vec3 local = limb.world.inverse().point(s.position_m);
      const double off = std::remainder(std::atan2(local.y(), local.x()) - angle_rad, 2 * kPi);
      const bool along = local.z() > limb.low_m && local.z() < limb.high_m;
      if (along && std::abs(off) < kSectorHalfAngle) chosen.push_back(s);
    }
  }
  return chosen;
}

// A spindle that leans on the bone and reaches out to its sector's skin.
bool fitBelly(const FitSetting& setting, const FleshPart& part, const BoneFrame& frame,
              const Limb& limb, double angle_rad, FittedSolid& solid) {
  std::vector<SurfaceSample> skin = sector(part, limb, angle_rad);
  if (skin.size() < 8) return false;
  double out_m = 0, area_m2 = 0;
  for (const SurfaceSample& s : skin) {
    const Vec3 local = limb.world.inverse().point(s.position_m);
    out_m += s.area_m2 * (std::hypot(local.x(), local.y()) - s.fat_m);
    area_m2 += s.area_m2;
  }
  out_m /= area_m2;
  if (out_m < 0.35 * limb.radius_m) return false;
  const Eigen::AngleAxisd turn(angle_rad, Vec3::UnitZ());
  solid = {};
  solid.world.rotation = limb.world.rotation * turn;
  solid.world.translation_m =
      limb.world.point(turn * Vec3(0.48 * out_m, 0, 0.5 * (limb.low_m + limb.high_m)));
  solid.half_m = {0.54 * out_m, 0.8 * out_m, 0.52 * (limb.high_m - limb.low_m)};
  solid.exponent_e1 = 0.95;
  solid.exponent_e2 = 0.9;
  SolidTarget target = surfaceTarget(
      setting.surface, subPart(setting.symmetry, frame, part, std::move(skin), false));
  target.size_m = limb.radius_m;
  target.prior = 0.25;
  for (const double share : {0.25, 0.5, 0.7})
    target.pins.push_back({limb.world.point({0, 0, share * limb.length_m}), 0.08 * out_m, 0.3});
  return fitInside(setting.surface, setting.plane(part), setting.margin_m(), target, solid);
}

// A slim rod from joint to joint, and a ball around its beginning: the round end of the bone and
// what bends around it keep the joint's volume.
void addBone(const FitSetting& setting, const FleshPart& part, const Limb& limb,
             std::vector<NamedSolid>& solids) {
  double least_m = std::numeric_limits<double>::max();
  for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9}) {
    least_m = std::min(least_m,
                       depth_m(setting.surface, limb.world.point({0, 0, share * limb.length_m})));
  }
  FittedSolid bone;
  bone.world = limb.world;
  bone.world.translation_m = limb.world.point({0, 0, 0.5 * limb.length_m});
  const double radius_m = std::min(kBoneRadius * limb.radius_m, 0.45 * least_m);
  bone.half_m = {radius_m, radius_m, 0.52 * limb.length_m};
  bone.exponent_e1 = 0.5;
  if (radius_m > setting.margin_m() &&
      shrinkInside(setting.surface, setting.plane(part), setting.margin_m(), bone))
    solids.push_back({"bone", bone, kTendon, 0});
  FittedSolid condyle;
  condyle.world = limb.world;
  const double ball_m = std::min(depth_m(setting.surface, limb.world.translation_m), limb.radius_m);
  condyle.half_m = Vec3::Constant(0.95 * ball_m);
  if (ball_m > 0.4 * limb.radius_m &&
      shrinkInside(setting.surface, setting.plane(part), setting.margin_m(), condyle))
    solids.push_back({"joint", condyle, kTendon, 0});
}

double meanSquare(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v * v;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

}  // namespace

std::vector<NamedSolid> fitMuscles(const FitSetting& setting, const FleshPart& part,
                                   const BoneFrame& frame, const BoneFrame* next,
                                   JointMeaning meaning) {
  std::vector<NamedSolid> solids;
  if (!isLimb(setting, part, frame, next, meaning)) return solids;
  const Limb limb = limbOf(part, frame, *next);
  for (const Belly& belly : bellies(meaning)) {
    FittedSolid solid;
    if (!fitBelly(setting, part, frame, limb, belly.angle_rad, solid)) return {};
    solids.push_back({belly.suffix, solid, belly.color, belly.stretch});
  }
  // Muscles that leave a third of the radius empty are worse than none.
  if (meanSquare(gaps_m(part, solids)) > std::pow(0.4 * limb.radius_m, 2)) return {};
  addBone(setting, part, limb, solids);
  return solids;
}

}  // namespace fascia
