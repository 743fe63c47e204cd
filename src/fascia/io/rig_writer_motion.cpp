#include <fascia/io/rig_writer_motion.h>

#include <algorithm>
#include <cmath>
#include <set>

#include <fascia/io/rig_gltf_clip.h>

namespace fascia {
namespace {

// Of the model's size: joints that are off by less than this play the same motion.
constexpr double kSameMotion = 2e-3;

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

std::vector<float> frameTimes(const RigClip& clip, float start_s) {
  std::vector<float> times;
  const double first = clip.recording.frames.front().time_s;
  for (const Recording::Frame& frame : clip.recording.frames) {
    times.push_back(start_s + static_cast<float>(frame.time_s - first));
  }
  return times;
}

// Whether the model's own motion of this name moved the joints in the recording.
bool movedAsTheFile(const RigClip& clip) {
  const auto& motions = clip.model.motions;
  const auto found = std::find_if(motions.begin(), motions.end(),
                                  [&](const SampledMotion& m) { return m.name == clip.motion; });
  if (found == motions.end()) return false;
  const double least = kSameMotion * clip.model.size_m();
  std::vector<Transform> world;
  for (std::size_t f = 0; f < clip.joints_world.size(); ++f) {
    poseRig(clip.model, static_cast<int>(found - motions.begin()), clip.recording.frames[f].time_s,
            world);
    for (std::size_t j = 0; j < world.size(); ++j) {
      const Transform& ours = clip.joints_world[f][j];
      if ((world[j].translation_m - ours.translation_m).norm() > least) return false;
      if ((world[j].rotation - ours.rotation).norm() > 10 * kSameMotion) return false;
    }
  }
  return true;
}

bool isWhole(const RigClip& clip, const GltfClip& source) {
  const double frame = 1 / clip.recording.frame_rate_hz;
  const double first = clip.recording.frames.front().time_s;
  const double length = clip.recording.frames.back().time_s - first;
  return std::abs(first) < 0.5 * frame &&
         std::abs(length - (source.end_s() - source.start_s())) < 1.5 * frame;
}

// Local frames of the joints' nodes, that play the recording's motion.
class JointKeys {
 public:
  explicit JointKeys(const RigSource& source) : source_(source), world_(source.scene.nodes.size()) {
    local_.resize(source.scene.nodes.size());
  }

  void pose(const std::vector<Transform>& motion) {
    for (const int n : source_.scene.order) {
      const GltfNode& node = source_.scene.nodes[at(n)];
      const Affine parent = node.parent < 0 ? source_.unit() : world_[at(node.parent)];
      const int joint = source_.rig.jointOfNode[at(n)];
      if (joint < 0) {
        world_[at(n)] = parent * node.local();
        continue;
      }
      const Transform& m = motion[at(joint)];
      world_[at(n)].linear() = m.rotation * source_.bindOfJoint(joint).linear();
      world_[at(n)].translation() = m.point(source_.bindOfJoint(joint).translation());
      local_[at(n)] = parent.inverse() * world_[at(n)];
    }
  }

  // What is left when the node's own scale is taken out.
  Transform rigid(int n, const Vec3& scale, const Mat3& fallback) const {
    const Mat3 turn = local_[at(n)].linear() * scale.cwiseInverse().asDiagonal();
    return {rotationOf(turn, fallback), local_[at(n)].translation()};
  }

 private:
  const RigSource& source_;
  std::vector<Affine> world_, local_;
};

Vec3 scaleOf(const GltfNode& node) {
  Vec3 scale = node.hasMatrix ? Vec3(node.matrix.linear().colwise().norm()) : node.scale;
  if (node.hasMatrix && node.matrix.linear().determinant() < 0) scale = -scale;
  // A flat joint has no inverse and moves nothing that could be seen.
  return (scale.array().abs() < 1e-9).select(Vec3::Ones(), scale);
}

Json numbers(std::initializer_list<double> values) {
  Json::List list;
  for (const double v : values) list.emplace_back(v);
  return list;
}

// An animated node must not have a matrix (glTF 2.0, 3.5.3).
void splitMatrix(RigSource& source, int n, const Vec3& scale) {
  const GltfNode& node = source.scene.nodes[at(n)];
  if (!node.hasMatrix) return;
  const Vec3 t = node.matrix.translation();
  const Quat q(
      rotationOf(node.matrix.linear() * scale.cwiseInverse().asDiagonal(), Mat3::Identity()));
  Json& json = source.node(n);
  eraseMember(json, "matrix");
  putMember(json, "translation", numbers({t.x(), t.y(), t.z()}));
  putMember(json, "rotation", numbers({q.x(), q.y(), q.z(), q.w()}));
  putMember(json, "scale", numbers({scale.x(), scale.y(), scale.z()}));
}

void addJointChannels(RigSource& source, const RigClip& clip, const BakedAnimation& animation) {
  const BoneFrames motion = boneFrames(clip);
  std::vector<std::vector<Transform>> keys(clip.model.joints.size());
  JointKeys frames(source);
  for (const std::vector<Transform>& pose : motion) {
    frames.pose(pose);
    for (std::size_t j = 0; j < keys.size(); ++j) {
      const int n = source.rig.nodeOfJoint[j];
      if (n < 0) continue;
      const Mat3 fallback = keys[j].empty() ? Mat3::Identity() : keys[j].back().rotation;
      keys[j].push_back(frames.rigid(n, scaleOf(source.scene.nodes[at(n)]), fallback));
    }
  }
  for (std::size_t j = 0; j < keys.size(); ++j) {
    const int n = source.rig.nodeOfJoint[j];
    if (n < 0) continue;
    splitMatrix(source, n, scaleOf(source.scene.nodes[at(n)]));
    addRigidChannels(source, animation, n, keys[j]);
  }
}

}  // namespace

int animationNamed(const RigSource& source, const std::string& name) {
  // The importer numbers doubled names, and names what has none.
  std::set<std::string> names;
  const GltfPlace animations = source.document.root()["animations"];
  for (std::size_t i = 0; i < animations.size(); ++i) {
    std::string given = animations.at(i)["name"].textOr("");
    if (given.empty()) given = "animation " + std::to_string(i + 1);
    std::string unique = given;
    for (int n = 2; !names.insert(unique).second; ++n) {
      unique = given + " (" + std::to_string(n) + ")";
    }
    if (unique == name) return static_cast<int>(i);
  }
  return -1;
}

BakedAnimation prepareAnimation(RigSource& source, const RigClip& clip) {
  BakedAnimation out;
  out.index = animationNamed(source, clip.motion);
  if (out.index >= 0) {
    std::vector<std::string> notes;
    const GltfClip old = readGltfClips(source.document, source.scene, notes)[at(out.index)];
    out.keepsJoints = isWhole(clip, old) && movedAsTheFile(clip);
    if (out.keepsJoints) out.start_s = static_cast<float>(old.start_s());
  }
  out.times = source.document.addFloats(frameTimes(clip, out.start_s), "SCALAR", true);
  if (out.keepsJoints) return out;
  if (out.index < 0) {
    Json fresh{Json::Object{}};
    fresh.set("name", clip.motion.empty() ? "fascia" : clip.motion);
    out.index = source.add("animations", std::move(fresh));
  }
  putMember(source.item("animations", out.index), "samplers", Json::List{});
  putMember(source.item("animations", out.index), "channels", Json::List{});
  addJointChannels(source, clip, out);
  return out;
}

void addChannel(RigSource& source, const BakedAnimation& animation, int node, const char* path,
                std::span<const float> values, std::string_view type) {
  Json sampler{Json::Object{}}, channel{Json::Object{}}, target{Json::Object{}};
  sampler.set("input", animation.times);
  sampler.set("interpolation", "LINEAR");
  sampler.set("output", source.document.addFloats(values, type));
  Json& json = source.item("animations", animation.index);
  Json::List& samplers = ensureList(json, "samplers").list();
  samplers.push_back(std::move(sampler));
  const auto index = static_cast<int>(samplers.size()) - 1;
  target.set("node", node);
  target.set("path", path);
  channel.set("sampler", index);
  channel.set("target", std::move(target));
  ensureList(json, "channels").list().push_back(std::move(channel));
}

void addRigidChannels(RigSource& source, const BakedAnimation& animation, int node,
                      std::span<const Transform> local) {
  std::vector<float> rotations, translations;
  Quat last = Quat::Identity();
  for (const Transform& t : local) {
    Quat q = Quat(t.rotation).normalized();
    if (q.dot(last) < 0) q.coeffs() = -q.coeffs();
    last = q;
    for (const double c : {q.x(), q.y(), q.z(), q.w()}) rotations.push_back(static_cast<float>(c));
    for (Eigen::Index c = 0; c < 3; ++c) {
      translations.push_back(static_cast<float>(t.translation_m[c]));
    }
  }
  addChannel(source, animation, node, "rotation", rotations, "VEC4");
  addChannel(source, animation, node, "translation", translations, "VEC3");
}

}  // namespace fascia
