#include <fascia/io/rig_export/baked_animation.h>

#include <algorithm>
#include <cmath>
#include <set>

#include <fascia/base/index.h>
#include <fascia/io/gltf/gltf_animation.h>
#include <fascia/io/rig_export/other_channels.h>
#include <fascia/io/rig_export/rig_player.h>
#include <fascia/io/rig_import/gltf/gltf_clip.h>

namespace fascia {
namespace {

// Of the model's size: joints that are off by less than this play the same motion.
constexpr double kSameMotion = 2e-3;
// The same for the file's keys as they play, and how far a joint may be turned (sine, about): more
// would be the larger part of a bake's error.
constexpr double kPlayedShift = 3e-4, kPlayedTurn = 2e-3;
constexpr double kSameWeight = 1e-3;  // of a morph

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

  const Affine& world(int n) const { return world_[at(n)]; }

  // What is left when the node's own scale is taken out.
  Transform rigid(int n, const Vec3& scale, const Mat3& fallback) const {
    const Mat3 turn = local_[at(n)].linear() * scale.cwiseInverse().asDiagonal();
    return {rotationOf(turn, fallback), local_[at(n)].translation()};
  }

 private:
  const RigSource& source_;
  std::vector<Affine> world_, local_;
};

// Whether the file's own keys, played as players do, show the recorded joints: between keys that
// lie far apart in a fast motion, straight lines leave the smooth way that was simulated.
bool playsAsRecorded(const RigSource& source, const RigClip& clip, int animation, double start_s) {
  const RigPlayer player(source.document, {}, animation, source.scale);
  const double least_m = kPlayedShift * clip.model.size_m();
  const BoneFrames motion = boneFrames(clip);
  JointKeys recorded(source);
  for (std::size_t f = 0; f < motion.size(); ++f) {
    const auto& frames = clip.recording.frames;
    const std::vector<Affine> played =
        player.nodesAt(start_s + frames[f].time_s - frames.front().time_s);
    recorded.pose(motion[f]);
    for (const int n : source.rig.nodeOfJoint) {
      if (n < 0) continue;
      const Affine &is = played[at(n)], &wanted = recorded.world(n);
      if ((is.translation() - wanted.translation()).norm() > least_m) return false;
      if ((is.linear() - wanted.linear()).norm() > kPlayedTurn * wanted.linear().norm())
        return false;
    }
  }
  return true;
}

Vec3 scaleOf(const GltfNode& node) {
  Vec3 scale = node.hasMatrix ? Vec3(node.matrix.linear().colwise().norm()) : node.scale;
  if (node.hasMatrix && node.matrix.linear().determinant() < 0) scale = -scale;
  // A flat joint has no inverse and moves nothing that could be seen.
  return (scale.array().abs() < 1e-9).select(Vec3::Ones(), scale);
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
  putMember(json, "translation", numberList(t));
  putMember(json, "rotation", numberList(q.coeffs()));
  putMember(json, "scale", numberList(scale));
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

// What else the animation moves stays.
void eraseJointChannels(const RigSource& source, Json& animation) {
  std::erase_if(ensureList(animation, "channels").list(),
                [&](const Json& channel) { return movesJoint(source, channel); });
}

// Whether the file's own keys, or its weights at rest, show the recorded ones of a part.
bool playsWeights(const RigPlayer& player, std::size_t part, const RigClip& clip,
                  const BakedAnimation& animation) {
  const std::vector<RigMorph>& morphs = clip.model.morphs;
  const auto& frames = clip.recording.frames;
  for (const Recording::Frame& frame : frames) {
    const std::vector<double> played =
        player.morphWeights(part, animation.start_s + frame.time_s - frames.front().time_s);
    for (std::size_t m = 0; m < morphs.size(); ++m) {
      if (morphs[m].node != clip.model.parts[part].node) continue;
      const std::size_t target = at(morphs[m].target);
      if (target >= played.size() || std::abs(played[target] - frame.morphs[m]) > kSameWeight)
        return false;
    }
  }
  return true;
}

// What a recording shows of a motion of the file that begins at `start_s` on its clock.
GltfSpan spanOf(const RigClip& clip, double start_s) {
  const auto& frames = clip.recording.frames;
  const auto motion = std::ranges::find(clip.model.motions, clip.motion, &SampledMotion::name);
  const bool loops = motion != clip.model.motions.end() && motion->loop;
  return {start_s + frames.front().time_s, frames.back().time_s - frames.front().time_s,
          loops ? motion->duration_s() : 0};
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
  bool whole = false;
  double start_s = 0;
  if (out.index >= 0) {
    std::vector<std::string> notes;
    const GltfClip old = readGltfClip(source.document, source.scene, at(out.index), notes);
    start_s = old.start_s();
    whole = isWhole(clip, old) && movedAsTheFile(clip);
    out.start_s = static_cast<float>(start_s);
    out.keepsJoints = whole && playsAsRecorded(source, clip, out.index, out.start_s);
  }
  out.times = source.document.addFloats(frameTimes(clip, out.start_s), "SCALAR", true);
  if (out.keepsJoints) return out;
  if (out.index < 0) {
    out.index = source.document.add(
        "animations", Json::Object{{"name", clip.motion.empty() ? "fascia" : clip.motion}});
  }
  if (whole)
    eraseJointChannels(source, source.document.item("animations", out.index));
  else
    out.leftOut = cutOtherChannels(source, out.index, spanOf(clip, start_s));
  addJointChannels(source, clip, out);
  return out;
}

void addChannel(RigSource& source, const BakedAnimation& animation, int node, const char* path,
                std::span<const float> values, std::string_view type) {
  const int output = source.document.addFloats(values, type);
  addGltfTrack(source.document.item("animations", animation.index), animation.times, output, node,
               path);
}

void addWeightChannel(RigSource& source, const RigClip& clip, const BakedAnimation& animation,
                      int node,
                      const std::function<void(std::size_t frame, std::vector<float>&)>& append) {
  std::erase_if(ensureList(source.document.item("animations", animation.index), "channels").list(),
                [&](const Json& channel) { return weighsMorphs(channel, node); });
  const std::vector<RigMorph>& morphs = clip.model.morphs;
  std::vector<float> values;
  for (std::size_t f = 0; f < clip.recording.frames.size(); ++f) {
    for (std::size_t m = 0; m < morphs.size(); ++m)
      if (morphs[m].node == node)
        values.push_back(static_cast<float>(clip.recording.frames[f].morphs[m]));
    if (append) append(f, values);
  }
  addChannel(source, animation, node, "weights", values, "SCALAR");
}

void addWeightChannels(RigSource& source, const RigClip& clip, const BakedAnimation& animation) {
  if (clip.model.morphs.empty()) return;
  const RigPlayer player(source.document, clip.model.parts, animation.index, source.scale);
  std::set<int> done;
  for (std::size_t p = 0; p < clip.model.parts.size(); ++p) {
    const int node = clip.model.parts[p].node;
    if (!done.insert(node).second || playsWeights(player, p, clip, animation)) continue;
    addWeightChannel(source, clip, animation, node);
  }
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
