#include <algorithm>
#include <cmath>
#include <set>

#include <fascia/io/rig_writer_geometry.h>
#include <fascia/io/rig_writer_motion.h>
#include <fascia/io/rig_writer_player.h>

namespace fascia {
namespace {

// Of the model's size: a mesh without a skin that stays this near to its joint stays without.
constexpr double kRigid = 1e-5;

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

bool isSimilarity(const Mat3& m) {
  const Mat3 gram = m.transpose() * m;
  return (gram - gram.trace() / 3 * Mat3::Identity()).norm() < 1e-4 * gram.norm();
}

Json numbers(const Vec3& v) {
  Json::List list;
  for (const double c : {v.x(), v.y(), v.z()}) {
    list.emplace_back(Json::Number{shortestDigits(static_cast<float>(c))});
  }
  return list;
}

// What a bone is in the file.
struct Bone {
  int node = -1;
  Affine bind_world;  // its node's frame in the bind pose
};

class BoneWriter {
 public:
  BoneWriter(RigSource& source, const SkinningDecomposition& found)
      : source_(source), model_(source.clip.model), found_(found) {}

  BakedAnimation write() {
    source_.separateMeshes();
    skinLooseParts();
    straightenBentSkins();
    const BakedAnimation animation = prepareAnimation(source_);
    addRigBones();
    addHelpers(animation);
    for (std::size_t s = 0; s < source_.rig.skins.size(); ++s) writeSkin(static_cast<int>(s));
    return animation;
  }

 private:
  int skinOf(std::size_t part) {
    const Json* skin = findMember(source_.node(model_.parts[part].node), "skin");
    return skin ? static_cast<int>(skin->number()) : -1;
  }

  // Whether all of a part's vertices follow one joint of the rig, as a node below it does.
  bool staysRigid(const RigPart& part) const {
    const int carrier = std::max(source_.rig.carrierOfNode[at(part.node)], 0);
    const auto& frames = source_.clip.recording.frames;
    const double least = kRigid * model_.size_m();
    for (std::size_t f = 0; f < frames.size(); ++f) {
      const Transform motion = source_.clip.joints_world[f][at(carrier)] *
                               model_.joints[at(carrier)].rest_world.inverse();
      for (std::uint32_t v = part.firstVertex; v < part.firstVertex + part.vertexCount; ++v) {
        const Vec3 rest = model_.points_m[model_.vertices[v].point].cast<double>();
        if ((motion.point(rest) - frames[f].skin_m[v].cast<double>()).norm() > least) return false;
      }
    }
    return true;
  }

  // Meshes that hung on a joint, but are soft now, get the first skin.
  void skinLooseParts() {
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

  void addHelpers(const BakedAnimation& animation) {
    const std::vector<std::vector<Transform>> motion = boneFrames(source_.clip);
    for (const SkinningDecomposition::Helper& helper : found_.helpers) {
      const int anchor = anchorOf(helper.parent);
      const Affine parent = anchor < 0 ? source_.unit() : source_.bindOfJoint(anchor);
      // The helper's frame at rest is its anchor's, moved to where it sits.
      Bone bone{-1, parent};
      bone.bind_world.translation() = helper.center_m;
      Json json{Json::Object{}};
      json.set("name", freshName());
      json.set("translation", numbers(parent.inverse() * helper.center_m));
      if (anchor < 0) {
        bone.node = source_.addTopNode(std::move(json));
      } else {
        bone.node = source_.add("nodes", std::move(json));
        ensureList(source_.node(source_.rig.nodeOfJoint[at(anchor)]), "children")
            .list()
            .push_back(bone.node);
      }
      addRigidChannels(source_, animation, bone.node, localTrack(helper, anchor, parent, motion));
      bones_.push_back(bone);
    }
  }

  // Below an anchor that moves by P from its rest B, the helper's node moves by B⁻¹ P⁻¹ H X, with H
  // its own motion and X its rest, whose axes are B's.
  static std::vector<Transform> localTrack(const SkinningDecomposition::Helper& helper, int anchor,
                                           const Affine& parent,
                                           const std::vector<std::vector<Transform>>& motion) {
    const Affine back = parent.inverse();
    std::vector<Transform> track;
    for (std::size_t f = 0; f < motion.size(); ++f) {
      const Transform relative =
          anchor < 0 ? helper.world[f] : motion[f][at(anchor)].inverse() * helper.world[f];
      track.push_back({back.linear() * relative.rotation * parent.linear(),
                       back * relative.point(helper.center_m)});
    }
    return track;
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
      Json::List& list = ensureList(source_.item("skins", skin), "joints").list();
      slot[b] = static_cast<int>(list.size());
      list.push_back(bones_[b].node);
      const Eigen::Matrix4f fresh = columns(bones_[b].bind_world.inverse() * mesh);
      matrices.insert(matrices.end(), fresh.data(), fresh.data() + 16);
    }
    const int accessor = source_.document.addFloats(matrices, "MAT4");
    putMember(source_.item("skins", skin), "inverseBindMatrices", accessor);
    // The common root of the joints may be another now; it need not be said.
    eraseMember(source_.item("skins", skin), "skeleton");
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
  std::vector<Bone> bones_;  // the rig's joints, then helpers
  std::set<int> soft_;       // nodes that got a skin
  std::set<std::string> names_;
  int lastName_ = 0;
};

}  // namespace

RigBakeReport writeRigAsBones(const RigClip& clip, const DecompositionOptions& options,
                              const std::string& path) {
  RigSource source = RigSource::open(clip);
  const RiggedModel& model = clip.model;
  const SkinningDecomposition found = decomposeSkinning(
      model.points_m, model.triangles, model.weights, boneFrames(clip), pointFrames(clip), options);
  const BakedAnimation animation = BoneWriter(source, found).write();
  source.document.writeGlb(path);
  RigBakeReport report;
  report.error = playedError(clip, path, animation.index, animation.start_s, 0);
  report.added = found.helpers.size();
  report.files = {path};
  return report;
}

}  // namespace fascia
