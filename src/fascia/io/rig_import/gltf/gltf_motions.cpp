#include <fascia/io/rig_import/gltf/gltf_motions.h>

#include <algorithm>
#include <cstdio>
#include <set>

#include <fascia/base/index.h>
#include <fascia/flesh/morphs.h>
#include <fascia/io/rig_import/gltf/gltf_clip.h>
#include <fascia/io/rig_model/motion_sampling.h>

namespace fascia {
namespace {

// Whose frames are as many numbers as a node's.
constexpr std::size_t kMorphsPerNode = 7;
constexpr double kMostClipNodes = 2e7;  // clips times nodes: every clip begins with all nodes

// The joints' nodes and those above them, parents first: no other moves a joint.
std::vector<int> nodesAboveJoints(const GltfScene& scene, const GltfRig& rig) {
  std::vector<bool> isAbove(scene.nodes.size(), false);
  for (auto n = scene.order.rbegin(); n != scene.order.rend(); ++n) {
    if (rig.jointOfNode[at(*n)] >= 0) isAbove[at(*n)] = true;
    const int parent = scene.nodes[at(*n)].parent;
    if (isAbove[at(*n)] && parent >= 0) isAbove[at(parent)] = true;
  }
  std::vector<int> above;
  for (const int n : scene.order) {
    if (isAbove[at(n)]) above.push_back(n);
  }
  return above;
}

// Many exporters write keys of scales that never change.
bool changesSize(const GltfChannel& channel) {
  constexpr double kMostChange = 0.01;
  if (channel.path != GltfChannel::Path::scale) return false;
  std::size_t key = 0;
  const Eigen::Vector4d first = channel.valueAt(channel.times_s.front(), key);
  return std::ranges::any_of(channel.times_s, [&](float time_s) {
    return (channel.valueAt(time_s, key) - first).norm() > kMostChange * first.norm();
  });
}

// Evaluates one clip, time after time.
class ClipPlayer {
 public:
  ClipPlayer(const GltfScene& scene, const GltfRig& rig, const RiggedModel& model,
             const std::vector<int>& above, const GltfClip& clip)
      : scene_(scene), rig_(rig), clip_(clip), nodes_(scene.nodes), above_(above) {
    local_.reserve(nodes_.size());
    for (const GltfNode& node : nodes_) local_.push_back(node.local());
    keys_.assign(clip.channels.size(), 0);
    joints_.resize(model.joints.size());
    for (std::size_t j = 0; j < joints_.size(); ++j) joints_[j] = model.joints[j].rest_world;
    stretched_.assign(joints_.size(), false);
    world_.resize(nodes_.size());
    std::set<int> moved;
    for (const GltfChannel& channel : clip.channels) moved.insert(channel.node);
    moved_.assign(moved.begin(), moved.end());
    sized_.assign(nodes_.size(), false);
    for (const GltfChannel& channel : clip.channels)
      if (changesSize(channel)) sized_[at(channel.node)] = true;
  }

  // World frames of all joints.
  const std::vector<Transform>& pose(double time_s) {
    for (std::size_t c = 0; c < clip_.channels.size(); ++c)
      apply(clip_.channels[c], time_s, keys_[c]);
    for (const int n : moved_) local_[at(n)] = nodes_[at(n)].local();
    scene_.toWorld(local_, above_, world_);
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      const int node = rig_.nodeOfJoint[j];
      if (node < 0) continue;
      joints_[j] = rigidPart(world_[at(node)], joints_[j].rotation);
      noteStretch(j, world_[at(node)]);
    }
    return joints_;
  }

  // For a person: joints whose size the points cannot follow, and why; empty if there are none.
  std::string stretchNote(const std::string& motion) const {
    const auto count = std::count(stretched_.begin(), stretched_.end(), true);
    if (count == 0) return {};
    const std::string joints = std::to_string(count) + " joints ";
    const int uneven = unevenNode();
    if (uneven < 0) return joints + "change their size in " + motion + ": their size is kept";
    const Vec3 scale = scene_.nodes[at(uneven)].local().linear().colwise().norm();
    char numbers[96];
    std::snprintf(numbers, sizeof numbers, "(%.3g, %.3g, %.3g)", scale.x(), scale.y(), scale.z());
    return joints + "are sheared in " + motion + " by the uneven scale " + numbers +
           " of the node " + jsonText(scene_.nodes[at(uneven)].name) +
           ", which is left out of the motion: apply the scale in the program that made the file";
  }

 private:
  void apply(const GltfChannel& channel, double time_s, std::size_t& key) {
    GltfNode& node = nodes_[at(channel.node)];
    const Eigen::Vector4d value = channel.valueAt(time_s, key);
    switch (channel.path) {
      case GltfChannel::Path::translation:
        node.translation = value.head<3>();
        break;
      case GltfChannel::Path::scale:
        node.scale = value.head<3>();
        break;
      case GltfChannel::Path::rotation:
        if (value.norm() > 1e-6) node.rotation = Quat(value).normalized();
        break;
    }
  }

  // The points carry the scale of the bind pose; one that changes is lost.
  void noteStretch(std::size_t j, const Affine& world) {
    constexpr double kMostStretch = 0.01;
    const auto stretch = [](const Affine& m) { return Mat3(m.linear().transpose() * m.linear()); };
    const Mat3 bind = stretch(rig_.bind_world[j]);
    if ((stretch(world) - bind).norm() > 2 * kMostStretch * bind.norm()) stretched_[j] = true;
  }

  // The topmost node whose scale is uneven, of those at or above stretched joints, if the clip
  // leaves the sizes of all of them alone; -1: none.
  int unevenNode() const {
    constexpr double kMostUneven = 1.01;
    int found = -1;
    for (std::size_t j = 0; j < stretched_.size(); ++j) {
      for (int n = stretched_[j] ? rig_.nodeOfJoint[j] : -1; n >= 0;
           n = scene_.nodes[at(n)].parent) {
        if (sized_[at(n)]) return -1;
        const Vec3 size = scene_.nodes[at(n)].local().linear().colwise().norm();
        if (size.maxCoeff() > kMostUneven * size.minCoeff()) found = n;
      }
    }
    return found;
  }

  const GltfScene& scene_;
  const GltfRig& rig_;
  const GltfClip& clip_;
  std::vector<GltfNode> nodes_;
  std::vector<Affine> local_, world_;
  const std::vector<int>& above_;
  std::vector<int> moved_;  // nodes
  std::vector<std::size_t> keys_;
  std::vector<Transform> joints_;
  std::vector<bool> stretched_;
  std::vector<bool> sized_;  // per node: the clip changes its scale
};

// The weights of a model's morphs that a clip animates, time after time.
class WeightPlayer {
 public:
  WeightPlayer(const GltfClip& clip, const RiggedModel& model, SampledMotion& motion)
      : motion_(motion) {
    for (const GltfWeightChannel& channel : clip.weights) {
      const auto first = std::ranges::find(model.morphs, channel.node, &RigMorph::node);
      const auto count = std::ranges::count(model.morphs, channel.node, &RigMorph::node);
      if (channel.keys.width != static_cast<std::size_t>(count)) continue;
      const bool second =
          std::ranges::find(channels_, channel.node, &GltfWeightChannel::node) != channels_.end();
      if (second) continue;
      channels_.push_back(channel);
      for (auto morph = first; morph != first + count; ++morph)
        motion.morphs.push_back(morph->name);
    }
  }

  void append(double time_s) {
    constexpr auto kMost = static_cast<float>(kMostMorphWeight);
    for (const GltfWeightChannel& channel : channels_)
      for (const float weight : channel.keys.valueAt(time_s))
        motion_.weights.push_back(std::clamp(weight, -kMost, kMost));
  }

 private:
  std::vector<GltfWeightChannel> channels_;
  SampledMotion& motion_;
};

SampledMotion play(ClipPlayer& player, const GltfClip& clip, const MotionPlan& plan,
                   const RiggedModel& model) {
  SampledMotion motion;
  motion.name = clip.name;
  motion.rate_hz = plan.rate_hz;
  for (const RigJoint& joint : model.joints) motion.joints.push_back(joint.name);
  WeightPlayer weights(clip, model, motion);
  const double start = clip.start_s();
  for (std::size_t f = 0; f < plan.frames; ++f) {
    const double time_s = start + static_cast<double>(f) / plan.rate_hz;
    appendFrame(model, player.pose(time_s), motion);
    weights.append(time_s);
  }
  closeLoop(model.size_m(), motion);
  return motion;
}

}  // namespace

void readGltfMotions(const GltfDocument& document, const GltfScene& scene, const GltfRig& rig,
                     RiggedModel& model) {
  std::vector<GltfClip> clips = readGltfClips(document, scene, model.notes);
  const auto most =
      static_cast<std::size_t>(kMostClipNodes / static_cast<double>(scene.nodes.size()));
  if (clips.size() > most) {
    model.notes.push_back("more than " + std::to_string(most) +
                          " motions: the others are left out");
    clips.resize(most);
  }
  const std::vector<int> above = nodesAboveJoints(scene, rig);
  std::vector<MotionSpan> spans;
  spans.reserve(clips.size());
  for (const GltfClip& clip : clips)
    spans.push_back({clip.name, clip.end_s() - clip.start_s(), clip.naturalRate_hz()});
  const std::vector<MotionPlan> plans =
      planMotions(spans, above.size() + model.morphs.size() / kMorphsPerNode, model.notes);
  MotionNames names;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (plans[i].frames == 0) continue;
    ClipPlayer player(scene, rig, model, above, clips[i]);
    SampledMotion motion = play(player, clips[i], plans[i], model);
    motion.name = names.next(motion.name);
    const std::string stretched = player.stretchNote(jsonText(motion.name));
    if (!stretched.empty()) model.notes.push_back(stretched);
    model.motions.push_back(std::move(motion));
  }
}

}  // namespace fascia
