#include <fascia/skin/joint_carrier.h>

#include <algorithm>

#include <fascia/base/parallel.h>

namespace fascia {
namespace {

constexpr std::size_t kPointsPerTask = 2048;
// Weights below this share move a point by less than anyone sees.
constexpr float kLeastWeight = 1e-4f;

// Where a point turns about, see the header. `shares` is scratch with an entry per joint.
Vec3 centerOfRotation(const std::vector<JointCarrier::Joint>& joints,
                      const JointCarrier::Point& point, std::vector<double>& shares) {
  subtreeShares(joints, point.weights, shares);
  Vec3 sum = Vec3::Zero();
  double total = 0;
  for (std::size_t j = joints.size(); j-- > 0;) {
    if (joints[j].parent < 0) continue;
    const double coupling = std::max(0.0, shares[j] * (1 - shares[j]));
    sum += coupling * joints[j].rest_world.translation_m;
    total += coupling;
  }
  return total > 1e-9 ? Vec3(sum / total) : point.rest_world;
}

Eigen::Vector4f extended(const Vec3& v, float w) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), w};
}

// v turned by the unit quaternion q: v + 2 u × (u × v + w v), u = (x, y, z).
Eigen::Vector3f turned(const Eigen::Vector4f& q, const Eigen::Vector3f& v) {
  const Eigen::Vector3f u = q.head<3>();
  const Eigen::Vector3f inner = u.cross(v) + q.w() * v;
  return v + 2 * u.cross(inner);
}

}  // namespace

void subtreeShares(std::span<const JointCarrier::Joint> joints, const PointWeights& weights,
                   std::span<double> shares) {
  std::fill(shares.begin(), shares.end(), 0.0);
  for (std::size_t i = 0; i < PointWeights::kMost; ++i)
    shares[weights.joint[i]] += weights.weight[i];
  // Children come after parents: when a joint is reached its share is that of its whole subtree.
  for (std::size_t j = joints.size(); j-- > 0;)
    if (joints[j].parent >= 0) shares[static_cast<std::size_t>(joints[j].parent)] += shares[j];
}

JointCarrier::JointCarrier(std::vector<Joint> joints, std::span<const Point> points)
    : joints_(std::move(joints)) {
  for (const Joint& j : joints_) inverseRest_.push_back(j.rest_world.inverse());
  std::vector<double> shares(joints_.size());
  firstInfluence_.push_back(0);
  for (const Point& p : points) {
    storage_.push_back(static_cast<std::uint32_t>(p.point));
    const Vec3 center = centerOfRotation(joints_, p, shares);
    center_.push_back(extended(center, 1));
    arm_.push_back(extended(p.rest_world - center, 0));
    const std::size_t first = influences_.size();
    float total = 0;
    for (std::size_t i = 0; i < PointWeights::kMost; ++i) {
      if (p.weights.weight[i] < kLeastWeight) continue;
      influences_.push_back({p.weights.joint[i], p.weights.weight[i]});
      total += p.weights.weight[i];
    }
    for (std::size_t i = first; i < influences_.size(); ++i) influences_[i].weight /= total;
    firstInfluence_.push_back(static_cast<std::uint32_t>(influences_.size()));
  }
}

void JointCarrier::place(std::span<const Transform> joints, std::vector<Motion>& motion,
                         VectorArray& out) const {
  motion.resize(joints_.size());
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Transform m = joints[joints_[j].skeletonJoint] * inverseRest_[j];
    motion[j].turn = Quat(m.rotation).normalized().coeffs().cast<float>();
    for (int c = 0; c < 3; ++c) motion[j].column[c] = extended(m.rotation.col(c), 0);
    motion[j].column[3] = extended(m.translation_m, 0);
  }
  const std::size_t tasks = (pointCount() + kPointsPerTask - 1) / kPointsPerTask;
  parallelFor(tasks, [&](std::size_t t) {
    placeRange(motion, t * kPointsPerTask, std::min(pointCount(), (t + 1) * kPointsPerTask), out);
  });
}

void JointCarrier::placeRange(const std::vector<Motion>& motion, std::size_t begin, std::size_t end,
                              VectorArray& out) const {
  for (std::size_t p = begin; p < end; ++p) {
    const std::size_t k = storage_[p];
    if (firstInfluence_[p + 1] == firstInfluence_[p] + 1) {  // rides on one joint
      const Motion& m = motion[influences_[firstInfluence_[p]].joint];
      const Eigen::Vector4f rest = center_[p] + arm_[p];
      const Eigen::Vector4f r =
          m.column[0] * rest.x() + m.column[1] * rest.y() + m.column[2] * rest.z() + m.column[3];
      out.x[k] = r.x(), out.y[k] = r.y(), out.z[k] = r.z();
      continue;
    }
    const Eigen::Vector4f center = center_[p];
    const Eigen::Vector4f& first = motion[influences_[firstInfluence_[p]].joint].turn;
    Eigen::Vector4f turn = Eigen::Vector4f::Zero(), place = Eigen::Vector4f::Zero();
    for (std::uint32_t i = firstInfluence_[p]; i < firstInfluence_[p + 1]; ++i) {
      const Motion& m = motion[influences_[i].joint];
      const float w = influences_[i].weight;
      // q and −q are the same turn: the one nearer to the heaviest joint's is meant.
      turn += (m.turn.dot(first) < 0 ? -w : w) * m.turn;
      place += w * (m.column[0] * center.x() + m.column[1] * center.y() + m.column[2] * center.z() +
                    m.column[3]);
    }
    const Eigen::Vector3f r = place.head<3>() + turned(turn.normalized(), arm_[p].head<3>());
    out.x[k] = r.x(), out.y[k] = r.y(), out.z[k] = r.z();
  }
}

}  // namespace fascia
