#include <fascia/fitting/joint_frames.h>

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include <fascia/base/assert.h>
#include <fascia/skeleton/euler.h>

namespace fascia {
namespace {

constexpr std::size_t kMostFrames = 240;  // of a motion that are looked at
constexpr double kLeastSwing_rad = 0.05;  // RMS; below, the motions say nothing
constexpr double kLeastSkew = 0.12;       // of swings to one side, to call that flexion

// Where a joint's own points are.
struct Dominion {
  Vec3 weightedSum_m3 = Vec3::Zero();
  double area_m2 = 0;
  Vec3 centre_m() const { return weightedSum_m3 / area_m2; }
};

std::vector<Dominion> findDominions(const RiggedModel& model, const RestSurface& surface) {
  std::vector<Dominion> dominions(model.joints.size());
  for (const SurfaceSample& s : surface.samples()) {
    Dominion& d = dominions[s.joint[0]];
    d.weightedSum_m3 += s.area_m2 * s.position_m;
    d.area_m2 += s.area_m2;
  }
  return dominions;
}

// Picks the child that the joint's flesh leads to: the best aligned with the centre of its points.
// A joint in the plane of symmetry leads to none of a pair.
int mainChild(const RiggedModel& model, const Symmetry& symmetry,
              const std::vector<std::vector<std::size_t>>& children, const Dominion& dominion,
              double least_m, std::size_t joint) {
  const Vec3 origin = model.joints[joint].rest_world.translation_m;
  int best = -1;
  double highest = -2;
  for (const std::size_t child : children[joint]) {
    const Vec3 bone = model.joints[child].rest_world.translation_m - origin;
    if (bone.norm() < least_m || (symmetry.central(joint) && !symmetry.central(child))) continue;
    double score = bone.norm() * 1e-6;  // without points: the longest
    if (dominion.area_m2 > 0)
      score = bone.normalized().dot((dominion.centre_m() - origin).normalized());
    if (children[child].empty()) score -= 0.1;  // a tip or helper rather than the chain
    if (score <= highest) continue;
    highest = score;
    best = static_cast<int>(child);
  }
  return best;
}

// A bone without a main child leads through the middle of its points to their end.
void endAtPoints(const RestSurface& surface, std::size_t joint, const Vec3& direction,
                 BoneFrame& frame) {
  std::vector<double> along;
  for (const SurfaceSample& s : surface.samples()) {
    if (s.joint[0] == joint)
      along.push_back(direction.dot(s.position_m - frame.world.translation_m));
  }
  frame.length_m = 0;
  if (!along.empty()) {
    const auto rank = static_cast<std::ptrdiff_t>(0.97 * static_cast<double>(along.size() - 1));
    std::nth_element(along.begin(), along.begin() + rank, along.end());
    frame.length_m = std::max(0.0, along[static_cast<std::size_t>(rank)]);
  }
  frame.end_m = frame.world.translation_m + frame.length_m * direction;
}

// Second moments of a joint's swings over the motions, in world directions of the rest pose.
struct Swings {
  Mat3 moment = Mat3::Zero();
  Vec3 skewed = Vec3::Zero();  // long swings count more: which side is flexion
  double count = 0;

  void add(const Vec3& swing, double weight) {
    moment += weight * swing * swing.transpose();
    skewed += weight * swing.norm() * swing;
    count += weight;
  }
};

void addSwings(const RiggedModel& model, std::size_t joint, const Vec3& bone, Swings& swings) {
  const int parent = model.joints[joint].parent;
  if (parent < 0) return;
  const Mat3 parentRotation = model.joints[static_cast<std::size_t>(parent)].rest_world.rotation;
  const Quat rest(parentRotation.transpose() * model.joints[joint].rest_world.rotation);
  for (const SampledMotion& motion : model.motions) {
    const auto found =
        std::find(motion.joints.begin(), motion.joints.end(), model.joints[joint].name);
    if (found == motion.joints.end()) continue;
    const auto column = static_cast<std::size_t>(found - motion.joints.begin());
    const std::size_t step = motion.frameCount() / kMostFrames + 1;
    for (std::size_t f = 0; f < motion.frameCount(); f += step) {
      const Quat now = motion.rotation[f * motion.joints.size() + column].cast<double>();
      const Eigen::AngleAxisd turn(now * rest.conjugate());
      const double angle = turn.angle() > kPi ? turn.angle() - 2 * kPi : turn.angle();
      const Vec3 axis = parentRotation * (angle * turn.axis());
      swings.add(axis - axis.dot(bone) * bone, static_cast<double>(step));
    }
  }
}

// Across the bone, from the rest pose alone: about the normal of the chain's own bend, or else so
// that the bone swings up and down (limbs that stand or hang: to and fro).
Vec3 restBendAxis(const RiggedModel& model, std::size_t joint, const BoneFrame& frame,
                  const Vec3& bone) {
  const int parent = model.joints[joint].parent;
  if (parent >= 0) {
    const Vec3 before = model.joints[joint].rest_world.translation_m -
                        model.joints[static_cast<std::size_t>(parent)].rest_world.translation_m;
    const Vec3 normal = before.cross(frame.end_m - frame.world.translation_m);
    if (normal.norm() > std::sin(radians(8)) * before.norm() * frame.length_m)
      return normal.normalized();
  }
  const Vec3 across = std::abs(bone.x()) < 0.8 ? Vec3::UnitX() : Vec3::UnitY();
  return (across - across.dot(bone) * bone).normalized();
}

// Principal axis of the swings; the sign that makes the larger swings positive.
Vec3 bendAxis(const RiggedModel& model, const Symmetry& symmetry, std::size_t joint,
              const BoneFrame& frame, const Vec3& bone) {
  const Vec3 fallback = restBendAxis(model, joint, frame, bone);
  Swings swings;
  addSwings(model, joint, bone, swings);
  if (symmetry.present && symmetry.partner[joint] >= 0) {
    Swings image;
    addSwings(model, static_cast<std::size_t>(symmetry.partner[joint]),
              symmetry.plane.direction(bone), image);
    Mat3 mirror = -Mat3::Identity();
    mirror(symmetry.plane.axis, symmetry.plane.axis) = 1;
    swings.moment += mirror * image.moment * mirror;
    swings.skewed += mirror * image.skewed;
    swings.count += image.count;
  }
  if (swings.moment.trace() <= kLeastSwing_rad * kLeastSwing_rad * swings.count) return fallback;
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(swings.moment);
  Vec3 axis = solver.eigenvectors().col(2);
  axis = (axis - axis.dot(bone) * bone).normalized();
  const double skew = swings.skewed.dot(axis) / swings.moment.trace();
  const double side = std::abs(skew) > kLeastSkew ? skew : fallback.dot(axis);
  return side < 0 ? Vec3(-axis) : axis;
}

Transform frameOf(const Vec3& origin, const Vec3& x, const Vec3& y) {
  Transform frame{Mat3::Identity(), origin};
  frame.rotation << x, y, x.cross(y);
  return frame;
}

// Where the bone points: to the main child, or else to the middle of the joint's points, or on as
// its parent does.
Vec3 boneDirection(const RiggedModel& model, const Symmetry& symmetry,
                   const std::vector<BoneFrame>& frames, const Dominion& own, double least_m,
                   std::size_t joint) {
  const BoneFrame& frame = frames[joint];
  const Vec3& origin = frame.world.translation_m;
  const int parent = model.joints[joint].parent;
  Vec3 bone = Vec3::UnitY();
  if (frame.mainChild >= 0)
    bone = frame.end_m - origin;
  else if (own.area_m2 > 0 && (own.centre_m() - origin).norm() > least_m)
    bone = own.centre_m() - origin;
  else if (parent >= 0)
    bone = frames[static_cast<std::size_t>(parent)].world.rotation.col(1);
  bone.normalize();
  if (!symmetry.central(joint)) return bone;
  // A bone in the plane of symmetry stays there.
  const Vec3 flat = bone - bone.dot(symmetry.plane.normal()) * symmetry.plane.normal();
  return flat.norm() > 0.1 ? Vec3(flat.normalized()) : Vec3::UnitY();
}

BoneFrame mirroredFrame(const Symmetry& symmetry, const BoneFrame& other, const Vec3& origin) {
  BoneFrame frame;
  const int child = other.mainChild;
  frame.mainChild = child < 0 ? -1 : symmetry.partner[static_cast<std::size_t>(child)];
  frame.end_m = symmetry.plane.point(other.end_m);
  frame.length_m = other.length_m;
  frame.world = frameOf(origin, symmetry.plane.axial(other.world.rotation.col(0)),
                        symmetry.plane.direction(other.world.rotation.col(1)));
  return frame;
}

}  // namespace

std::vector<BoneFrame> findBoneFrames(const RiggedModel& model, const RestSurface& surface,
                                      const Symmetry& symmetry) {
  const std::size_t count = model.joints.size();
  const double least_m = 1e-3 * model.size_m();
  std::vector<std::vector<std::size_t>> children(count);
  for (std::size_t j = 0; j < count; ++j) {
    if (model.joints[j].parent >= 0)
      children[static_cast<std::size_t>(model.joints[j].parent)].push_back(j);
  }
  const std::vector<Dominion> dominions = findDominions(model, surface);
  std::vector<BoneFrame> frames(count);
  for (std::size_t j = 0; j < count; ++j) {
    BoneFrame& frame = frames[j];
    const Vec3 origin = model.joints[j].rest_world.translation_m;
    if (symmetry.mirrored(j)) {
      frame =
          mirroredFrame(symmetry, frames[static_cast<std::size_t>(symmetry.partner[j])], origin);
      continue;
    }
    frame.world.translation_m = origin;
    frame.mainChild = mainChild(model, symmetry, children, dominions[j], least_m, j);
    if (frame.mainChild >= 0) {
      frame.end_m =
          model.joints[static_cast<std::size_t>(frame.mainChild)].rest_world.translation_m;
      frame.length_m = (frame.end_m - origin).norm();
    }
    const Vec3 bone = boneDirection(model, symmetry, frames, dominions[j], least_m, j);
    if (frame.mainChild < 0) endAtPoints(surface, j, bone, frame);
    frame.world = frameOf(origin, bendAxis(model, symmetry, j, frame, bone), bone);
  }
  return frames;
}

SkeletonDef makeSkeleton(const RiggedModel& model, const std::vector<BoneFrame>& frames) {
  FASCIA_ASSERT(frames.size() == model.joints.size(), "a frame for each joint");
  SkeletonDef skeleton;
  for (std::size_t j = 0; j < frames.size(); ++j) {
    JointDef joint;
    joint.name = model.joints[j].name;
    Transform local = frames[j].world;
    if (const int parent = model.joints[j].parent; parent >= 0) {
      joint.parent = model.joints[static_cast<std::size_t>(parent)].name;
      local = frames[static_cast<std::size_t>(parent)].world.inverse() * local;
    }
    joint.offset_m = local.translation_m;
    joint.orientation_rad = anglesZyx(local.rotation);
    for (const Dof dof : {Dof::tx, Dof::ty, Dof::tz, Dof::rx, Dof::ry, Dof::rz}) {
      DofDef free;
      free.dof = dof;
      joint.dofs.push_back(free);
    }
    skeleton.joints.push_back(std::move(joint));
  }
  return skeleton;
}

}  // namespace fascia
