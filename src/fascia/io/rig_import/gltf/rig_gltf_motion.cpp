#include <fascia/io/rig_import/gltf/rig_gltf_motion.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fascia/base/index.h>
#include <fascia/io/rig_import/gltf/rig_gltf_clip.h>

namespace fascia {
namespace {

constexpr double kMostJointFrames = 5e6;  // 28 bytes each
constexpr double kSlowest_hz = 1;         // a motion that would be coarser is left out
constexpr double kMostClipNodes = 2e7;    // clips times nodes: every clip begins with all nodes

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

void appendFrame(const RiggedModel& model, const std::vector<Transform>& world,
                 SampledMotion& motion) {
  const std::size_t count = world.size(), before = motion.rotation.size();
  for (std::size_t j = 0; j < count; ++j) {
    const int parent = model.joints[j].parent;
    const Transform local = parent < 0 ? world[j] : world[at(parent)].inverse() * world[j];
    Eigen::Quaternionf q = Quat(local.rotation).normalized().cast<float>();
    const bool turned = before > 0 ? q.dot(motion.rotation[before - count + j]) < 0 : q.w() < 0;
    if (turned) q.coeffs() = -q.coeffs();
    motion.rotation.push_back(q);
    motion.translation_m.push_back(local.translation_m.cast<float>());
  }
}

// The last pose is the first again: a cycle. The doubled frame goes.
void closeLoop(double size_m, SampledMotion& motion) {
  constexpr float kSameAngle_rad = 0.01f, kSameShift = 0.002f;  // of the size
  const std::size_t count = motion.joints.size(), last = motion.rotation.size() - count;
  if (last < 2 * count) return;
  const float shift = kSameShift * static_cast<float>(size_m);
  for (std::size_t j = 0; j < count; ++j) {
    if (motion.rotation[j].angularDistance(motion.rotation[last + j]) > kSameAngle_rad) return;
    if ((motion.translation_m[j] - motion.translation_m[last + j]).norm() > shift) return;
  }
  motion.loop = true;
  motion.rotation.resize(last);
  motion.translation_m.resize(last);
}

struct Plan {
  double rate_hz = 0;
  std::size_t frames = 0;  // 0: the motion is left out
};

// Frames of a clip: the first and the last are its first and its last key.
Plan planOf(const GltfClip& clip, double rate_hz) {
  const double duration = clip.end_s() - clip.start_s();
  if (!(duration > 0)) return {rate_hz, 1};
  const double steps = std::max(1.0, std::round(duration * rate_hz));
  return {steps / duration, static_cast<std::size_t>(std::min(steps, 1e15)) + 1};
}

// `nodes`: how many are evaluated per frame.
std::vector<Plan> planMotions(const std::vector<GltfClip>& clips, std::size_t nodes,
                              RiggedModel& model) {
  std::vector<Plan> plans;
  const double most = kMostJointFrames / static_cast<double>(nodes);
  double frames = 0;
  for (const GltfClip& clip : clips) {
    const bool endless = (clip.end_s() - clip.start_s()) * kSlowest_hz > most;
    plans.push_back(endless ? Plan{0, 0} : planOf(clip, clip.naturalRate_hz()));
    frames += static_cast<double>(plans.back().frames);
    if (endless)
      model.notes.push_back("the motion " + jsonText(clip.name) + " is too long: left out");
  }
  if (frames <= most) return plans;
  const double share = most / frames;
  model.notes.push_back("the motions are long: about " +
                        std::to_string(static_cast<int>(std::ceil(100 * share))) +
                        " % of their frames are kept");
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (plans[i].frames > 0) plans[i] = planOf(clips[i], plans[i].rate_hz * share);
  }
  return plans;
}

SampledMotion play(ClipPlayer& player, const GltfClip& clip, const Plan& plan,
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
  const std::vector<Plan> plans = planMotions(clips, above.size(), model);
  std::map<std::string, int> names;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (plans[i].frames == 0) continue;
    ClipPlayer player(scene, rig, model, above, clips[i]);
    SampledMotion motion = play(player, clips[i], plans[i], model);
    const int number = ++names[motion.name];
    if (number > 1) motion.name += " (" + std::to_string(number) + ")";
    if (player.stretchedCount() > 0) {
      model.notes.push_back(std::to_string(player.stretchedCount()) +
                            " joints change their size in " + jsonText(motion.name) +
                            ": their size is kept");
    }
    model.motions.push_back(std::move(motion));
  }
}

}  // namespace fascia
