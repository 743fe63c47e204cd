#include <fascia/io/rig_import/gltf/gltf_motions.h>

#include <algorithm>
#include <set>

#include <fascia/base/index.h>
#include <fascia/io/rig_import/gltf/gltf_clip.h>
#include <fascia/io/rig_model/motion_sampling.h>

namespace fascia {
namespace {

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

  std::size_t stretchedCount() const {
    return static_cast<std::size_t>(std::count(stretched_.begin(), stretched_.end(), true));
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
};

SampledMotion play(ClipPlayer& player, const GltfClip& clip, const MotionPlan& plan,
                   const RiggedModel& model) {
  SampledMotion motion;
  motion.name = clip.name;
  motion.rate_hz = plan.rate_hz;
  for (const RigJoint& joint : model.joints) motion.joints.push_back(joint.name);
  const double start = clip.start_s();
  for (std::size_t f = 0; f < plan.frames; ++f) {
    appendFrame(model, player.pose(start + static_cast<double>(f) / plan.rate_hz), motion);
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
  const std::vector<MotionPlan> plans = planMotions(spans, above.size(), model.notes);
  MotionNames names;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (plans[i].frames == 0) continue;
    ClipPlayer player(scene, rig, model, above, clips[i]);
    SampledMotion motion = play(player, clips[i], plans[i], model);
    motion.name = names.next(motion.name);
    if (player.stretchedCount() > 0) {
      model.notes.push_back(std::to_string(player.stretchedCount()) +
                            " joints change their size in " + jsonText(motion.name) +
                            ": their size is kept");
    }
    model.motions.push_back(std::move(motion));
  }
}

}  // namespace fascia
