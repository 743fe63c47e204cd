#include <algorithm>
#include <cmath>
#include <set>

#include <fascia/base/index.h>
#include <fascia/io/rig_export/baked_animation.h>
#include <fascia/io/rig_export/other_channels.h>
#include <fascia/io/rig_export/other_motions.h>
#include <fascia/io/rig_export/rig_geometry.h>
#include <fascia/io/rig_export/rig_player.h>
#include <fascia/io/rig_export/springs.h>

namespace fascia {
namespace {

// Of the model's size: a mesh without a skin that stays this near to its joint stays without.
constexpr double kRigid = 1e-5;
// Of the model's size: a helper that moves its points by less gets no keys, and rests on its joint.
constexpr double kResting = 1e-5;
// The same in motions that are not baked, and the error in these from which helpers move at all.
constexpr double kRestingElsewhere = 5e-4, kFollowed = 1e-3;
// Poses of other motions in which the weights shall play them too.
constexpr std::size_t kKeptPoses = 45;
// Of the whole work: after the search for helpers, and after what they do in other motions. The
// rest is measuring.
constexpr double kSearched = 0.75, kAllFollowed = 0.9;
// Helpers' keys in other motions are at most so dense; else they are where the joints' own are.
constexpr double kOthersRate_hz = 30;

bool isSimilarity(const Mat3& m) {
  const Mat3 gram = m.transpose() * m;
  return (gram - gram.trace() / 3 * Mat3::Identity()).norm() < 1e-4 * gram.norm();
}

// What a bone is in the file.
struct Bone {
  int node = -1;
  Affine bind_world;  // its node's frame in the bind pose
};

// A helper's node hangs below an anchor, a joint that is not stretched in one direction.
struct HelperNode {
  int node = -1;
  int anchor = -1;  // -1: none, the top of the scene
  Affine parent;    // the anchor's frame in the bind pose
};

class BoneWriter {
 public:
  BoneWriter(RigSource& source, const SkinningDecomposition& found)
      : source_(source), model_(source.clip.model), found_(found) {}

  std::vector<PlayedClip> write() {
    if (!found_.plain) {
      source_.separateMeshes();
      skinLooseParts();
      straightenBentSkins();
    }
    std::vector<BakedAnimation> animations;
    std::vector<PlayedClip> played;
    for (const RigClip& clip : source_.clips) {
      animations.push_back(prepareAnimation(source_, clip));
      addWeightChannels(source_, clip, animations.back());
      leftOut_ += animations.back().leftOut;
      played.push_back({clip, animations.back().index, animations.back().start_s});
    }
    if (found_.plain) return played;
    addRigBones();
    for (const SkinningDecomposition::Helper& helper : found_.helpers) addHelper(helper);
    addTracks(animations);
    for (std::size_t s = 0; s < source_.rig.skins.size(); ++s) writeSkin(static_cast<int>(s));
    return played;
  }

  // Channels that had to be left out.
  std::size_t leftOut() const { return leftOut_; }

  // Lets helpers move in a motion that is not baked, so that the surface is as it was.
  void follow(const OtherMotion& other) {
    const double least_m = kFollowed * model_.size_m();
    const double rate_hz = std::min(model_.motions[at(other.motion)].rate_hz, kOthersRate_hz);
    const auto count = static_cast<std::size_t>(std::lround(other.duration_s * rate_hz)) + 1;
    const std::vector<double> times_s = other.times(count);
    const BoneFrames bones = other.bones(model_, times_s);
    const PointFrames targets = plainSkinning(model_.points_m, model_.weights, bones);
    if (onParents_ && restingError_m(model_.points_m, found_, bones, targets) <= least_m) return;
    const auto tracks = fitHelpersToSkinning(model_.points_m, found_, bones, model_.weights);
    std::vector<float> clock;
    clock.reserve(times_s.size());
    for (const double t : times_s) clock.push_back(static_cast<float>(other.start_s + t));
    BakedAnimation animation{other.animation, static_cast<float>(other.start_s), -1, true};
    for (std::size_t h = 0; h < tracks.size(); ++h) {
      if (rests(h, tracks[h], bones, kRestingElsewhere)) continue;
      if (animation.times < 0) animation.times = source_.document.addFloats(clock, "SCALAR", true);
      addRigidChannels(source_, animation, nodes_[h].node, localTrack(h, tracks[h], bones));
    }
  }

 private:
  int skinOf(std::size_t part) {
    const Json* skin = findMember(source_.node(model_.parts[part].node), "skin");
    return skin ? static_cast<int>(skin->number()) : -1;
  }

  // Whether all of a part's vertices follow one joint of the rig, as a node below it does.
  bool staysRigid(const RigPart& part) const {
    for (std::size_t c = 0; c < source_.clips.size(); ++c)
      if (!staysRigid(part, source_.clips[c], pointFrames_[c])) return false;
    return true;
  }
  bool staysRigid(const RigPart& part, const RigClip& clip, const PointFrames& frames) const {
    const int carrier = std::max(source_.rig.carrierOfNode[at(part.node)], 0);
    const double least = kRigid * model_.size_m();
    for (std::size_t f = 0; f < frames.size(); ++f) {
      const Transform motion =
          clip.joints_world[f][at(carrier)] * model_.joints[at(carrier)].rest_world.inverse();
      for (std::uint32_t v = part.firstVertex; v < part.firstVertex + part.vertexCount; ++v) {
        const std::uint32_t point = model_.vertices[v].point;
        const Vec3 rest = model_.points_m[point].cast<double>();
        if ((motion.point(rest) - frames[f][point].cast<double>()).norm() > least) return false;
      }
    }
    return true;
  }

  // Meshes that hung on a joint, but are soft now, get the first skin.
  void skinLooseParts() {
    for (const RigClip& clip : source_.clips) pointFrames_.push_back(pointFrames(clip));
    const auto first = std::find_if(source_.rig.skins.begin(), source_.rig.skins.end(),
                                    [](const GltfSkin& skin) { return skin.used; });
    const auto skin = static_cast<int>(first - source_.rig.skins.begin());
    for (std::size_t p = 0; p < model_.parts.size(); ++p) {
      if (skinOf(p) >= 0 || staysRigid(model_.parts[p])) continue;
      soft_.insert(model_.parts[p].node);
    }
    for (std::size_t p = 0; p < model_.parts.size(); ++p) {
      if (soft_.count(model_.parts[p].node) == 0) continue;
      putMember(source_.node(model_.parts[p].node), "skin", skin);
      if (first->rigid) moveGeometry(source_, p, first->whole);
    }
  }

  // Where a skin's bind pose is not the rig's, other weights would bend the rest shape.
  void straightenBentSkins() {
    for (std::size_t p = 0; p < model_.parts.size(); ++p) {
      const int skin = skinOf(p);
      if (skin >= 0 && !source_.rig.skins[at(skin)].rigid) {
        moveGeometry(source_, p, source_.unit());
      }
    }
  }

  void addRigBones() {
    for (std::size_t j = 0; j < model_.joints.size(); ++j) {
      bones_.push_back({source_.rig.nodeOfJoint[j], source_.rig.bind_world[j]});
    }
  }

  // The nearest joint above that is not stretched in one direction: below others, turning would
  // shear, which a node cannot say. -1: none, the top of the scene.
  int anchorOf(int joint) const {
    while (joint >= 0 && (source_.rig.nodeOfJoint[at(joint)] < 0 ||
                          !isSimilarity(source_.bindOfJoint(joint).linear()))) {
      joint = model_.joints[at(joint)].parent;
    }
    return joint;
  }

  std::string freshName() {
    if (names_.empty()) {
      const GltfPlace nodes = source_.document.root()["nodes"];
      for (std::size_t n = 0; n < nodes.size(); ++n) names_.insert(nodes.at(n)["name"].textOr(""));
    }
    std::string name;
    do {
      ++lastName_;
      name = std::string(lastName_ < 10 ? "fascia_helper_0" : "fascia_helper_");
      name += std::to_string(lastName_);
    } while (!names_.insert(name).second);
    return name;
  }

  void addHelper(const SkinningDecomposition::Helper& helper) {
    HelperNode out;
    out.anchor = anchorOf(helper.parent);
    onParents_ = onParents_ && out.anchor == helper.parent;
    out.parent = out.anchor < 0 ? source_.unit() : source_.bindOfJoint(out.anchor);
    // The helper's frame at rest is its anchor's, moved to where it sits.
    Affine bind_world = out.parent;
    bind_world.translation() = helper.center_m;
    Json json{Json::Object{}};
    json.set("name", freshName());
    const Vec3 place = out.parent.inverse() * helper.center_m;
    json.set("translation", numberList(Eigen::Vector3f(place.cast<float>())));
    if (out.anchor < 0) {
      out.node = source_.addTopNode(std::move(json));
    } else {
      out.node = source_.document.add("nodes", std::move(json));
      ensureList(source_.node(source_.rig.nodeOfJoint[at(out.anchor)]), "children")
          .list()
          .push_back(out.node);
    }
    nodes_.push_back(out);
    bones_.push_back({out.node, bind_world});
  }

  // The baked motions' frames stand one after the other in the helpers' tracks.
  void addTracks(const std::vector<BakedAnimation>& animations) {
    std::size_t first = 0;
    for (std::size_t c = 0; c < animations.size(); ++c) {
      const BoneFrames bones = boneFrames(source_.clips[c]);
      for (std::size_t h = 0; h < nodes_.size(); ++h) {
        const std::span<const Transform> track(&found_.helpers[h].world[first], bones.size());
        if (rests(h, track, bones, kResting)) continue;
        addRigidChannels(source_, animations[c], nodes_[h].node, localTrack(h, track, bones));
      }
      first += bones.size();
    }
  }

  // Whether a helper stays on its anchor, as far as the points that it carries can tell.
  bool rests(std::size_t h, std::span<const Transform> track, const BoneFrames& bones,
             double ofSize) const {
    const SkinningDecomposition::Helper& helper = found_.helpers[h];
    const double most_m = ofSize * model_.size_m();
    for (std::size_t f = 0; f < track.size(); ++f) {
      const Transform on = nodes_[h].anchor < 0 ? Transform{} : bones[f][at(nodes_[h].anchor)];
      const double shift = (track[f].point(helper.center_m) - on.point(helper.center_m)).norm();
      if (shift + helper.radius_m * (track[f].rotation - on.rotation).norm() > most_m) return false;
    }
    return true;
  }

  // Below an anchor that moves by P from its rest B, the helper's node moves by B⁻¹ P⁻¹ H X, with H
  // its own motion and X its rest, whose axes are B's.
  std::vector<Transform> localTrack(std::size_t h, std::span<const Transform> track,
                                    const BoneFrames& bones) const {
    const Affine& parent = nodes_[h].parent;
    const Affine back = parent.inverse();
    std::vector<Transform> out;
    for (std::size_t f = 0; f < track.size(); ++f) {
      const Transform relative =
          nodes_[h].anchor < 0 ? track[f] : bones[f][at(nodes_[h].anchor)].inverse() * track[f];
      out.push_back({back.linear() * relative.rotation * parent.linear(),
                     back * relative.point(found_.helpers[h].center_m)});
    }
    return out;
  }

  // Joints of the rig that the file has no node for.
  void giveNode(Bone& bone, const std::string& name) {
    if (bone.node >= 0) return;
    Json json{Json::Object{}};
    json.set("name", name);
    bone.node = source_.addTopNode(std::move(json));
    bone.bind_world = source_.unit();
  }

  void writeSkin(int skin) {
    std::vector<std::size_t> parts;
    std::set<std::size_t> used;
    for (std::size_t p = 0; p < model_.parts.size(); ++p) {
      if (skinOf(p) != skin) continue;
      parts.push_back(p);
      const RigPart& part = model_.parts[p];
      for (std::uint32_t v = part.firstVertex; v < part.firstVertex + part.vertexCount; ++v) {
        const PointWeights& w = found_.weights[model_.vertices[v].point];
        for (std::size_t k = 0; k < PointWeights::kMost && w.weight[k] > 0; ++k) {
          used.insert(w.joint[k]);
        }
      }
    }
    if (parts.empty()) return;
    const std::vector<int> slot = extendSkin(skin, used, source_.places[parts[0]].toWorld[0]);
    for (const std::size_t p : parts) setWeights(source_, p, found_.weights, slot);
  }

  // Appends the bones that the skin lacks; returns the slot of every bone in it. Matrices that say
  // what the importer understood stay as they are, to the bit.
  std::vector<int> extendSkin(int skin, const std::set<std::size_t>& used, const Affine& mesh) {
    std::vector<float> matrices = oldMatrices(skin);
    std::vector<int> slot(bones_.size(), -1);
    const std::vector<int>& joints = source_.rig.skins[at(skin)].joint;
    for (std::size_t i = 0; i < joints.size(); ++i) {
      slot[at(joints[i])] = static_cast<int>(i);
      const Affine wanted = bones_[at(joints[i])].bind_world.inverse() * mesh;
      const Eigen::Map<Eigen::Matrix4f> old(&matrices[16 * i]);
      const Eigen::Matrix4f fresh = wanted.matrix().cast<float>().isApprox(old.topRows<3>(), 1e-4f)
                                        ? Eigen::Matrix4f(old)
                                        : columns(wanted);
      std::copy(fresh.data(), fresh.data() + 16, &matrices[16 * i]);
    }
    for (const std::size_t b : used) {
      if (slot[b] >= 0) continue;
      giveNode(bones_[b], b < model_.joints.size() ? model_.joints[b].name : std::string());
      Json::List& list = ensureList(source_.document.item("skins", skin), "joints").list();
      slot[b] = static_cast<int>(list.size());
      list.push_back(bones_[b].node);
      const Eigen::Matrix4f fresh = columns(bones_[b].bind_world.inverse() * mesh);
      matrices.insert(matrices.end(), fresh.data(), fresh.data() + 16);
    }
    const int accessor = source_.document.addFloats(matrices, "MAT4");
    putMember(source_.document.item("skins", skin), "inverseBindMatrices", accessor);
    // The common root of the joints may be another now; it need not be said.
    eraseMember(source_.document.item("skins", skin), "skeleton");
    return slot;
  }

  std::vector<float> oldMatrices(int skin) {
    const GltfPlace place = source_.document.root()["skins"].at(at(skin))["inverseBindMatrices"];
    std::vector<float> matrices;
    if (place) {
      const auto accessors = static_cast<int>(source_.document.root()["accessors"].size());
      matrices = source_.document.floats(place.index(accessors), 16);
    }
    matrices.resize(16 * source_.rig.skins[at(skin)].joint.size(), 0.0f);
    return matrices;
  }

  static Eigen::Matrix4f columns(const Affine& m) {
    Eigen::Matrix4f out = Eigen::Matrix4f::Identity();
    out.topRows<3>() = m.matrix().cast<float>();
    return out;
  }

  RigSource& source_;
  const RiggedModel& model_;
  const SkinningDecomposition& found_;
  std::vector<Bone> bones_;               // the rig's joints, then helpers
  std::vector<HelperNode> nodes_;         // of the helpers
  std::vector<PointFrames> pointFrames_;  // per clip
  bool onParents_ = true;                 // every helper hangs below its own joint
  std::set<int> soft_;                    // nodes that got a skin
  std::set<std::string> names_;
  int lastName_ = 0;
  std::size_t leftOut_ = 0;  // channels
};

// All clips' frames as one motion.
SkinningDecomposition decompose(std::span<const RigClip> clips,
                                const std::vector<OtherMotion>& others,
                                DecompositionOptions options) {
  const RiggedModel& model = clips.front().model;
  BoneFrames bones;
  PointFrames frames;
  for (const RigClip& clip : clips) {
    for (std::vector<Transform>& pose : boneFrames(clip)) bones.push_back(std::move(pose));
    for (std::vector<Eigen::Vector3f>& frame : pointFrames(clip)) {
      frames.push_back(std::move(frame));
    }
    options.motionFrames.push_back(clip.recording.frames.size());
  }
  options.kept = posesOfOthers(model, others, kKeptPoses);
  return decomposeSkinning(model.points_m, model.triangles, model.weights, bones, frames, options);
}

}  // namespace

RigBakeReport writeRigAsBones(std::span<const RigClip> clips, const DecompositionOptions& options,
                              const std::string& path, const RigFileOptions& file) {
  RigSource source = RigSource::open(clips);
  const std::vector<OtherMotion> others = otherMotions(source);
  const auto tell = [&](double share) {
    if (options.progress) options.progress(share);
  };
  DecompositionOptions search = options;
  search.progress = [&](double share) { tell(kSearched * share); };
  const SkinningDecomposition found = decompose(clips, others, std::move(search));
  BoneWriter writer(source, found);
  const std::vector<PlayedClip> played = writer.write();
  if (!found.plain) {
    for (std::size_t k = 0; k < others.size(); ++k) {
      writer.follow(others[k]);
      tell(kSearched + (kAllFollowed - kSearched) * static_cast<double>(k + 1) /
                           static_cast<double>(others.size()));
    }
  }
  tell(kAllFollowed);
  const std::vector<std::string> springs = settleSprings(source, file);
  source.document.writeGlb(path);
  RigBakeReport report;
  report.plain = found.plain;
  report.added = found.helpers.size();
  report.notes = notesOfMotions(clips, writer.leftOut());
  report.notes.insert(report.notes.end(), springs.begin(), springs.end());
  report.files = {path};
  measurePlayed(path, source.scale, played, report);
  report.others = measureOthers(source, path, others);
  return report;
}

}  // namespace fascia
