#include <fascia/skin/self_contact_creases.h>

#include <algorithm>
#include <cmath>

namespace fascia {
namespace {

using Crease = CreaseModel::Crease;
using Member = CreaseModel::Member;

// A point belongs to a joint's surroundings if the joint's limb and its parent alone move it, …
constexpr float kOfBoth = 0.9f;
// … and is between both where the product of their shares is at least this.
constexpr float kBlended = 0.05f;
// The fold reaches this many radii from the joint, fading from here …
constexpr double kFull = 1.4, kReach = 2;
// Skin that is clearly of one limb, by this share, …
constexpr float kOneLimb = 0.8f;
// … must lie on its side of the plane, all but this share of it: else no plane parts the limbs.
constexpr double kParted = 0.92;
// A point farther on the wrong side at rest than this many radii has a mind of its own.
constexpr double kAstray = 0.15;
// Joints whose two limbs drift apart by more than this many radii (stretching rigs) have no plane,
// and neither have limbs that are folded flat: the length of the two normals' sum is below this.
constexpr double kDrift = 0.2, kFolded = 0.3;
// A point is not moved farther than this many radii: what comes deeper is often cloth over skin
// that no plane parts, and would be torn.
constexpr double kDeepest = 0.25;

Eigen::Vector3f get(const VectorArray& a, std::size_t k) {
  return {a.x[k], a.y[k], a.z[k]};
}
void put(VectorArray& a, std::size_t k, const Eigen::Vector3f& v) {
  a.x[k] = v.x(), a.y[k] = v.y(), a.z[k] = v.z();
}

// A point as a joint's limb and its parent see it.
struct Shared {
  const JointCarrier::Point* point;
  float limb, parent;  // shares of its weight
  double distance_m;   // from the joint
};

class Preparation {
 public:
  Preparation(std::span<const JointCarrier::Joint> joints,
              std::span<const JointCarrier::Point> points, std::size_t elastic)
      : joints_(joints), points_(points), elastic_(elastic) {}

  CreaseModel run() {
    for (std::size_t j = 0; j < joints_.size(); ++j)
      if (joints_[j].parent >= 0) addCrease(j);
    return std::move(model_);
  }

 private:
  // What moves a point: a joint and all that hangs on it, or its parent alone.
  std::vector<Shared> sharedPoints(std::size_t joint) const {
    const auto parent = static_cast<std::size_t>(joints_[joint].parent);
    std::vector<char> inLimb(joints_.size(), 0);
    inLimb[joint] = 1;
    for (std::size_t j = joint + 1; j < joints_.size(); ++j)
      if (joints_[j].parent >= 0) inLimb[j] = inLimb[static_cast<std::size_t>(joints_[j].parent)];
    inLimb[joint] = 1;
    std::vector<Shared> out;
    for (const JointCarrier::Point& p : points_) {
      Shared s{&p, 0, 0, (p.rest_world - center(joint)).norm()};
      for (std::size_t i = 0; i < PointWeights::kMost; ++i) {
        if (inLimb[p.weights.joint[i]]) s.limb += p.weights.weight[i];
        if (p.weights.joint[i] == parent) s.parent += p.weights.weight[i];
      }
      if (s.limb + s.parent > kOfBoth) out.push_back(s);
    }
    return out;
  }

  const Vec3& center(std::size_t joint) const { return joints_[joint].rest_world.translation_m; }

  // The mean distance of the points between both.
  static double radiusOf(const std::vector<Shared>& shared) {
    double sum = 0, weight = 0;
    for (const Shared& s : shared) {
      if (s.limb * s.parent < kBlended) continue;
      sum += double{s.limb * s.parent} * s.distance_m;
      weight += double{s.limb * s.parent};
    }
    return weight > 0 ? sum / weight : 0;
  }

  // From the middle of the parent's skin near the joint to that of the limb's.
  static Vec3 normalOf(const std::vector<Shared>& shared) {
    Vec3 limb = Vec3::Zero(), parent = Vec3::Zero();
    double ofLimb = 1e-12, ofParent = 1e-12;
    for (const Shared& s : shared) {
      limb += double{s.limb} * s.point->rest_world, ofLimb += double{s.limb};
      parent += double{s.parent} * s.point->rest_world, ofParent += double{s.parent};
    }
    return limb / ofLimb - parent / ofParent;
  }

  void addCrease(std::size_t joint) {
    std::vector<Shared> near = sharedPoints(joint);
    const double radius_m = radiusOf(near);
    if (!(radius_m > 0)) return;
    std::erase_if(near, [&](const Shared& s) { return s.distance_m >= kReach * radius_m; });
    Vec3 normal = normalOf(near);
    if (!(normal.norm() > 0.1 * radius_m)) return;
    normal.normalize();
    const auto height = [&](const Shared& s) {
      return (s.limb > s.parent ? 1 : -1) * normal.dot(s.point->rest_world - center(joint));
    };
    std::size_t ofOne = 0, parted = 0;
    for (const Shared& s : near) {
      if (std::max(s.limb, s.parent) < kOneLimb) continue;
      ++ofOne;
      parted += height(s) > 0 ? 1u : 0u;
    }
    if (static_cast<double>(parted) < kParted * static_cast<double>(ofOne)) return;
    open(joint, normal, radius_m);
    for (const Shared& s : near)
      if (height(s) > -kAstray * radius_m) addMember(s, height(s), radius_m);
    Crease& crease = model_.creases.back();
    crease.count = static_cast<std::uint32_t>(model_.members.size()) - crease.first;
    if (crease.count == 0) model_.creases.pop_back();
  }

  void open(std::size_t joint, const Vec3& normal, double radius_m) {
    const JointCarrier::Joint& own = joints_[joint];
    const JointCarrier::Joint& parent = joints_[static_cast<std::size_t>(own.parent)];
    const Transform toOwn = own.rest_world.inverse(), toParent = parent.rest_world.inverse();
    model_.creases.push_back({own.skeletonJoint, parent.skeletonJoint, toOwn.point(center(joint)),
                              toOwn.vector(normal), toParent.point(center(joint)),
                              toParent.vector(normal), radius_m,
                              static_cast<std::uint32_t>(model_.members.size()), 0});
  }

  void addMember(const Shared& s, double height_m, double radius_m) {
    if (s.point->point >= elastic_) return;
    const double fade = (kReach - s.distance_m / radius_m) / (kReach - kFull);
    model_.members.push_back(
        {static_cast<std::uint32_t>(s.point->point), s.limb > s.parent ? 1.f : -1.f,
         static_cast<float>(std::min(height_m, 0.0)), static_cast<float>(std::min(1.0, fade))});
  }

  std::span<const JointCarrier::Joint> joints_;
  std::span<const JointCarrier::Point> points_;
  std::size_t elastic_;
  CreaseModel model_;
};

// Where a crease's plane is in a pose; false: there is none.
bool placePlane(const Crease& crease, std::span<const Transform> joints, Vec3& center,
                Vec3& normal) {
  const Transform &own = joints[crease.joint], &parent = joints[crease.parent];
  const Vec3 a = own.point(crease.center_joint), b = parent.point(crease.center_parent);
  const Vec3 sum = own.vector(crease.normal_joint) + parent.vector(crease.normal_parent);
  if (!(sum.norm() > kFolded) || !((a - b).norm() < kDrift * crease.radius_m)) return false;
  center = 0.5 * (a + b);
  normal = sum.normalized();
  return true;
}

}  // namespace

CreaseModel prepareCreases(std::span<const JointCarrier::Joint> joints,
                           std::span<const JointCarrier::Point> points, std::size_t elastic) {
  return Preparation(joints, points, elastic).run();
}

void meetInCreases(const CreaseModel& model, std::span<const Transform> joints,
                   VectorArray& place) {
  for (const Crease& crease : model.creases) {
    Vec3 center, exactNormal;
    if (!placePlane(crease, joints, center, exactNormal)) continue;
    const Eigen::Vector3f normal = exactNormal.cast<float>();
    const auto offset = static_cast<float>(exactNormal.dot(center));
    const auto deepest = static_cast<float>(kDeepest * crease.radius_m);
    for (std::uint32_t i = crease.first; i < crease.first + crease.count; ++i) {
      const Member& m = model.members[i];
      const Eigen::Vector3f at = get(place, m.point);
      const float missing = m.least_m - m.side * (normal.dot(at) - offset);
      if (missing > 0)
        put(place, m.point, at + m.strength * m.side * std::min(missing, deepest) * normal);
    }
  }
}

}  // namespace fascia
