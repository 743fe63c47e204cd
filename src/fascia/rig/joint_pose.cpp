#include <fascia/rig/joint_pose.h>

#include <algorithm>
#include <cmath>

#include <fascia/rig/joint_meaning.h>

namespace fascia {
namespace {

// How far people (and what has a neck) turn these joints.
constexpr double kSit_rad = radians(90), kRaise_rad = radians(75), kTwistArm_rad = radians(110),
                 kTwistHand_rad = radians(150), kTurnNeck_rad = radians(65);
// A limb of any body, a row of joints of any other.
constexpr double kSwing_rad = radians(45), kRow_rad = radians(60);
// Joints that are bent as far in the bind pose already show nothing.
constexpr double kLeastTurn_rad = radians(10);

std::string degreesText(double angle_rad) {
  return std::to_string(std::lround(degrees(angle_rad))) + "°";
}

// Of every point the share of its weight that is on a joint and what is below it.
std::vector<float> shareBelow(const RiggedModel& model, std::size_t joint) {
  std::vector<bool> below(model.joints.size(), false);
  for (std::size_t j = 0; j < below.size(); ++j)
    below[j] = j == joint || (model.joints[j].parent >= 0 &&
                              below[static_cast<std::size_t>(model.joints[j].parent)]);
  std::vector<float> share(model.weights.size(), 0);
  for (std::size_t p = 0; p < share.size(); ++p)
    for (std::size_t k = 0; k < PointWeights::kMost; ++k)
      if (below[model.weights[p].joint[k]]) share[p] += model.weights[p].weight[k];
  return share;
}

// The points that both a joint and what is above it hold on to.
std::vector<bool> heldByBoth(const RiggedModel& model, std::size_t joint) {
  constexpr float kHolds = 0.02f;
  const std::vector<float> share = shareBelow(model, joint);
  std::vector<bool> held(share.size());
  for (std::size_t p = 0; p < held.size(); ++p)
    held[p] = share[p] > kHolds && share[p] < 1 - kHolds;
  return held;
}

std::size_t countOf(const std::vector<bool>& flags) {
  return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), true));
}

class PoseFinder {
 public:
  explicit PoseFinder(const RiggedModel& model)
      : model_(model), hinges_(findHinges(model)), meanings_(guessMeanings(model.joints)) {}

  std::vector<JointPose> find(const std::vector<double>& bends_rad) {
    for (const Hinge& hinge : hinges_)
      for (const double angle_rad : bends_rad) bend(hinge, angle_rad);
    if (poses_.empty() && hinges_.empty()) row();
    if (isUprightAndNamed()) {
      hip();
      shoulder();
      wrist();
    } else {
      for (const Hinge& hinge : hinges_) swing(hinge);
    }
    neck();
    return std::move(poses_);
  }

 private:
  const Vec3& place(std::size_t j) const { return model_.joints[j].rest_world.translation_m; }

  std::optional<std::size_t> first(BodyPart part, BodySide side) const {
    const auto found = std::find(meanings_.begin(), meanings_.end(), JointMeaning{part, side});
    if (found == meanings_.end()) return std::nullopt;
    return static_cast<std::size_t>(found - meanings_.begin());
  }
  std::optional<std::size_t> left(BodyPart part) const { return first(part, BodySide::left); }

  // The unit vector from one joint to another, if both are there and apart.
  std::optional<Vec3> between(std::optional<std::size_t> from,
                              std::optional<std::size_t> to) const {
    if (!from || !to) return std::nullopt;
    const Vec3 along = place(*to) - place(*from);
    if (!(along.norm() > 1e-3 * model_.size_m())) return std::nullopt;
    return along.normalized();
  }

  // Foxes may have arms and legs by name, too.
  bool isUprightAndNamed() const {
    const auto up =
        between(first(BodyPart::hips, BodySide::middle), first(BodyPart::head, BodySide::middle));
    return up && up->y() > 0.7 && (left(BodyPart::upperArm) || left(BodyPart::upperLeg));
  }

  JointPose& add(PoseGroup group, std::size_t joint, const std::string& what, const Vec3& axis,
                 double angle_rad) {
    JointPose pose;
    pose.group = group;
    pose.joint = joint;
    pose.name = model_.joints[joint].name + " " + what + " " + degreesText(angle_rad);
    pose.axis = axis;
    pose.turn_rad = pose.angle_rad = angle_rad;
    return poses_.emplace_back(std::move(pose));
  }

  // About the axis that brings a segment towards a direction; `otherwise` if it points there.
  JointPose& addTowards(PoseGroup group, std::size_t joint, const std::string& what,
                        const Vec3& along, const Vec3& towards, double angle_rad) {
    const Vec3 axis = along.cross(towards);
    return add(group, joint, what, axis.norm() > 0.05 ? axis.normalized() : Vec3(Vec3::UnitZ()),
               angle_rad);
  }

  void bend(const Hinge& hinge, double angle_rad) {
    const double turn_rad = hinge.turnFor_rad(angle_rad);
    if (turn_rad < kLeastTurn_rad) return;
    JointPose& pose = add(PoseGroup::bends, hinge.joint, "bent to", hinge.axis, angle_rad);
    pose.turn_rad = turn_rad;
    pose.hinge = hinge;
  }

  void hip() {
    const auto thigh = left(BodyPart::upperLeg);
    if (const auto along = between(thigh, left(BodyPart::lowerLeg)))
      addTowards(PoseGroup::hips, *thigh, "raised to the front by", *along, Vec3::UnitZ(),
                 kSit_rad);
  }

  void shoulder() {
    const auto arm = left(BodyPart::upperArm);
    const auto along = between(arm, left(BodyPart::lowerArm));
    if (!along) return;
    addTowards(PoseGroup::shoulders, *arm, "raised by", *along, Vec3::UnitY(), kRaise_rad);
    add(PoseGroup::shoulders, *arm, "twisted by", *along, kTwistArm_rad).twist = true;
  }

  void wrist() {
    const auto hand = left(BodyPart::hand);
    if (const auto along = between(left(BodyPart::lowerArm), hand))
      add(PoseGroup::wrists, *hand, "twisted by", *along, kTwistHand_rad).twist = true;
  }

  void neck() {
    const auto head = first(BodyPart::head, BodySide::middle);
    if (!head || model_.joints[*head].parent < 0) return;
    const auto above = static_cast<std::size_t>(model_.joints[*head].parent);
    const bool named = meanings_[above].part == BodyPart::neck && model_.joints[above].parent >= 0;
    add(PoseGroup::neck, named ? above : *head, "turned by", Vec3::UnitY(), kTurnNeck_rad).twist =
        true;
  }

  void swing(const Hinge& hinge) {
    const Vec3 along = hinge.upper_m.normalized();
    if (along.y() < -0.5)
      addTowards(PoseGroup::hips, hinge.upper, "swung forwards by", along, Vec3::UnitZ(),
                 kSwing_rad);
    else
      addTowards(PoseGroup::shoulders, hinge.upper, "raised by", along, Vec3::UnitY(), kSwing_rad);
  }

  // The joint in the middle of the longest row from the root to a tip.
  void row() {
    std::vector<double> length_m(model_.joints.size(), 0);
    for (std::size_t j = 1; j < length_m.size(); ++j) {
      const auto parent = static_cast<std::size_t>(model_.joints[j].parent);
      length_m[j] = length_m[parent] + (place(j) - place(parent)).norm();
    }
    // The last among equals: joints on one place are no row, but bend all the same.
    std::size_t tip = 0;
    for (std::size_t j = 1; j < length_m.size(); ++j)
      if (length_m[j] >= length_m[tip]) tip = j;
    std::size_t at = tip;
    while (at > 0 && length_m[at] > 0.5 * length_m[tip] && model_.joints[at].parent > 0)
      at = static_cast<std::size_t>(model_.joints[at].parent);
    if (model_.joints[at].parent == 0) at = jointOfMostSkin();
    if (at == 0) return;
    const auto along = between(static_cast<std::size_t>(model_.joints[at].parent), at);
    const Vec3 direction = along ? *along : Vec3(Vec3::UnitY());
    addTowards(PoseGroup::bends, at, "bent by", direction,
               std::abs(direction.x()) < 0.7 ? Vec3::UnitX() : Vec3::UnitY(), kRow_rad);
  }

  // In a row of one (some files hang all joints on the root): the joint that shares most skin.
  std::size_t jointOfMostSkin() const {
    std::size_t best = 0, most = 0;
    for (std::size_t j = 1; j < model_.joints.size(); ++j) {
      const std::size_t count = countOf(heldByBoth(model_, j));
      if (best == 0 || count > most) best = j, most = count;
    }
    return best;
  }

  const RiggedModel& model_;
  std::vector<Hinge> hinges_;
  std::vector<JointMeaning> meanings_;
  std::vector<JointPose> poses_;
};

// Distance from a joint within which points are near it, where weights do not tell: half of the
// longest of the segments that meet there.
double reach_m(const RiggedModel& model, std::size_t joint) {
  double longest_m = 0;
  for (std::size_t j = 1; j < model.joints.size(); ++j) {
    const auto parent = static_cast<std::size_t>(model.joints[j].parent);
    if (j != joint && parent != joint) continue;
    longest_m = std::max(longest_m, (model.joints[j].rest_world.translation_m -
                                     model.joints[parent].rest_world.translation_m)
                                        .norm());
  }
  return 0.5 * longest_m;
}

}  // namespace

std::vector<JointPose> findPoses(const RiggedModel& model, const std::vector<double>& bends_rad) {
  return PoseFinder(model).find(bends_rad);
}

SampledMotion poseMotion(const RiggedModel& model, const JointPose& pose) {
  SampledMotion motion = turnMotion(model, pose.joint, pose.axis, pose.turn_rad);
  motion.name = pose.name;
  return motion;
}

HingeRegion regionOf(const RiggedModel& model, const JointPose& pose) {
  if (pose.hinge) return regionOf(model, *pose.hinge);
  constexpr std::size_t kFewest = 12;  // points that say something about a joint
  std::vector<bool> near = heldByBoth(model, pose.joint);
  if (countOf(near) < kFewest) {
    const Vec3& center = model.joints[pose.joint].rest_world.translation_m;
    const double reach = reach_m(model, pose.joint);
    for (std::size_t p = 0; p < near.size(); ++p)
      near[p] = (model.points_m[p].cast<double>() - center).norm() <= reach;
  }
  HingeRegion region;
  region.limb = model.triangles;
  for (std::uint32_t p = 0; p < near.size(); ++p)
    if (near[p]) region.pointsNearJoint.push_back(p);
  for (const auto& t : model.triangles)
    if (near[t[0]] && near[t[1]] && near[t[2]]) region.nearJoint.push_back(t);
  return region;
}

}  // namespace fascia
