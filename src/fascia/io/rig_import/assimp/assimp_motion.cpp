#include <fascia/io/rig_import/assimp/assimp_motion.h>

#include <algorithm>
#include <cmath>

#include <Eigen/SVD>

#include <assimp/anim.h>
#include <assimp/scene.h>

#include <fascia/base/error.h>
#include <fascia/base/suggest.h>
#include <fascia/io/rig_model/motion_sampling.h>
#include <fascia/io/rig_model/rig_limits.h>

namespace fascia {
namespace {

constexpr double kRate_hz = 30;
constexpr double kUsualTicks_per_s = 25;  // where the file does not say, after the library's manual
// What a stranger's file may cost us; longer motions are cut.
constexpr double kMaxDuration_s = 3600;
constexpr std::size_t kMaxNodes = 65536;

// A value between the keys around a time; keys are in the order of time.
template <class Key, class Blend>
auto between(const Key* keys, unsigned count, double time, const Blend& blend) {
  const Key* after = std::upper_bound(keys, keys + count, time,
                                      [](double t, const Key& key) { return t < key.mTime; });
  if (after == keys) return blend(keys[0], keys[0], 0.0);
  if (after == keys + count) return blend(keys[count - 1], keys[count - 1], 0.0);
  const double length = after->mTime - after[-1].mTime;
  return blend(after[-1], *after, length > 0 ? (time - after[-1].mTime) / length : 0.0);
}

Vec3 vectorAt(const aiVectorKey* keys, unsigned count, double time, const Vec3& none) {
  if (count == 0) return none;
  return between(keys, count, time, [](const aiVectorKey& a, const aiVectorKey& b, double share) {
    const Vec3 from(a.mValue.x, a.mValue.y, a.mValue.z), to(b.mValue.x, b.mValue.y, b.mValue.z);
    return Vec3(from + share * (to - from));
  });
}

Quat turnAt(const aiQuatKey* keys, unsigned count, double time) {
  if (count == 0) return Quat::Identity();
  return between(keys, count, time, [](const aiQuatKey& a, const aiQuatKey& b, double share) {
    const Quat from(a.mValue.w, a.mValue.x, a.mValue.y, a.mValue.z);
    return from.slerp(share, Quat(b.mValue.w, b.mValue.x, b.mValue.y, b.mValue.z)).normalized();
  });
}

AssimpFrame channelAt(const aiNodeAnim& channel, double time) {
  AssimpFrame out = AssimpFrame::Identity();
  out.translate(vectorAt(channel.mPositionKeys, channel.mNumPositionKeys, time, Vec3::Zero()));
  out.rotate(turnAt(channel.mRotationKeys, channel.mNumRotationKeys, time));
  out.scale(vectorAt(channel.mScalingKeys, channel.mNumScalingKeys, time, Vec3::Ones()));
  return out;
}

double ticksPerSecond(const aiAnimation& animation) {
  return animation.mTicksPerSecond > 0 ? animation.mTicksPerSecond : kUsualTicks_per_s;
}

SampledMotion sample(const aiAnimation& animation, const MotionPlan& plan, const AssimpNodes& nodes,
                     const std::vector<std::size_t>& nodeOfJoint, const RiggedModel& model) {
  SampledMotion motion;
  motion.rate_hz = plan.rate_hz;
  for (const RigJoint& joint : model.joints) motion.joints.push_back(joint.name);
  std::vector<std::pair<std::size_t, const aiNodeAnim*>> channels;
  for (unsigned c = 0; c < animation.mNumChannels; ++c) {
    const int node = nodes.find(animation.mChannels[c]->mNodeName.C_Str());
    if (node >= 0) channels.emplace_back(static_cast<std::size_t>(node), animation.mChannels[c]);
  }
  std::vector<AssimpFrame> local, world;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    local.push_back(affineOf(nodes.node(n).mTransformation));
  }
  std::vector<Transform> joints(nodeOfJoint.size());
  for (std::size_t f = 0; f < plan.frames; ++f) {
    const double time = static_cast<double>(f) / plan.rate_hz * ticksPerSecond(animation);
    for (const auto& [node, channel] : channels) local[node] = channelAt(*channel, time);
    nodes.pose(local, world);
    for (std::size_t j = 0; j < joints.size(); ++j) joints[j] = rigidOf(world[nodeOfJoint[j]]);
    appendFrame(model, joints, motion);
  }
  closeLoop(model.size_m(), motion);
  return motion;
}

}  // namespace

AssimpNodes::AssimpNodes(const aiScene& scene, double unit_m) : unit_m_(unit_m) {
  std::vector<std::pair<const aiNode*, int>> open{{scene.mRootNode, -1}};
  while (!open.empty()) {
    const auto [node, parent] = open.back();
    open.pop_back();
    if (nodes_.size() >= kMaxNodes) throw Error("has more than 65536 nodes");
    const int self = static_cast<int>(nodes_.size());
    nodes_.push_back(node);
    parents_.push_back(parent);
    byName_.try_emplace(node->mName.C_Str(), self);
    for (unsigned c = node->mNumChildren; c-- > 0;) open.emplace_back(node->mChildren[c], self);
  }
  std::vector<AssimpFrame> local;
  for (const aiNode* node : nodes_) local.push_back(affineOf(node->mTransformation));
  pose(local, world_);
}

int AssimpNodes::find(const std::string& name) const {
  const auto found = byName_.find(name);
  return found == byName_.end() ? -1 : found->second;
}

void AssimpNodes::pose(const std::vector<AssimpFrame>& local,
                       std::vector<AssimpFrame>& world) const {
  world.resize(nodes_.size());
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    world[n] = parents_[n] < 0 ? AssimpFrame(Eigen::Scaling(unit_m_) * local[n])
                               : world[static_cast<std::size_t>(parents_[n])] * local[n];
  }
}

AssimpFrame affineOf(const aiMatrix4x4& m) {
  AssimpFrame out = AssimpFrame::Identity();
  out.matrix().topRows<3>() << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3,
      m.c4;
  return out;
}

Transform rigidOf(const AssimpFrame& frame) {
  Transform out;
  out.translation_m = frame.translation();
  const double size = frame.linear().norm();
  const bool isPlace = isSane(out.translation_m.x()) && isSane(out.translation_m.y()) &&
                       isSane(out.translation_m.z());
  if (!std::isfinite(size) || size == 0 || !isPlace) return {};
  // The nearest rotation (Higham 1986): both factors of the singular value decomposition.
  const Eigen::JacobiSVD<Mat3> svd(frame.linear() / size,
                                   Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) *= -1;
  out.rotation = u * svd.matrixV().transpose();
  return out;
}

void sampleMotions(const aiScene& scene, const AssimpNodes& nodes,
                   const std::vector<std::size_t>& nodeOfJoint, RiggedModel& model) {
  std::vector<MotionSpan> spans;
  for (unsigned a = 0; a < scene.mNumAnimations; ++a) {
    const aiAnimation& animation = *scene.mAnimations[a];
    const double duration_s =
        animation.mDuration > 0 ? animation.mDuration / ticksPerSecond(animation) : 0;
    // A whole number of frames, at just that rate.
    const double frames = std::round(std::min(duration_s, kMaxDuration_s) * kRate_hz);
    spans.push_back({animation.mName.C_Str(), frames / kRate_hz, kRate_hz});
    if (spans.back().name.empty()) spans.back().name = "animation " + std::to_string(a + 1);
    if (duration_s > kMaxDuration_s)
      model.notes.push_back("the motion " + quotedName(spans.back().name) +
                            " is longer than an hour: cut");
  }
  const std::vector<MotionPlan> plans = planMotions(spans, nodeOfJoint.size(), model.notes);
  MotionNames names;
  for (std::size_t a = 0; a < plans.size(); ++a) {
    if (plans[a].frames == 0) continue;
    SampledMotion motion = sample(*scene.mAnimations[a], plans[a], nodes, nodeOfJoint, model);
    motion.name = names.next(spans[a].name);
    model.motions.push_back(std::move(motion));
  }
}

}  // namespace fascia
