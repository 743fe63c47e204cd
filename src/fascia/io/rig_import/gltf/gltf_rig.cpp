#include <fascia/io/rig_import/gltf/gltf_rig.h>

#include <algorithm>
#include <limits>

#include <fascia/base/index.h>
#include <fascia/io/rig_model/simulated_surface.h>

namespace fascia {
namespace {

constexpr double kSamePlace = 1e-3;  // of the skeleton's size, and of a unit axis

// What a skin says, checked.
struct RawSkin {
  std::vector<int> nodes;           // of its joints
  std::vector<Affine> inverseBind;  // identity where it is none
  std::vector<Affine> bind;         // its inverse: joint -> mesh
  std::vector<bool> sound;          // has an inverse
  bool anySound = false;
};

// An accessor may be shared by any number of skins: what all of them read together is limited.
std::vector<float> readMatrices(const GltfDocument& document, const GltfPlace& place,
                                std::size_t& numbersRead) {
  constexpr std::size_t kMostNumbers = 16'000'000;
  if (!place) return {};
  const int accessor = place.index(static_cast<int>(document.root()["accessors"].size()));
  numbersRead += 16 * document.elementCount(accessor);
  if (numbersRead > kMostNumbers) place.fail("too many inverse bind matrices in one file");
  return document.floats(accessor, 16);
}

RawSkin readSkin(const GltfDocument& document, int index, std::size_t nodeCount,
                 std::size_t& numbersRead) {
  const GltfPlace place = document.root()["skins"].at(at(index));
  const GltfPlace joints = place["joints"];
  RawSkin skin;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    skin.nodes.push_back(joints.at(i).index(static_cast<int>(nodeCount)));
  }
  const std::vector<float> matrices =
      readMatrices(document, place["inverseBindMatrices"], numbersRead);
  for (std::size_t i = 0; i < skin.nodes.size(); ++i) {
    Affine inverse = Affine::Identity();
    bool sound = 16 * (i + 1) <= matrices.size();
    if (sound) {
      const Eigen::Matrix4d m =
          Eigen::Map<const Eigen::Matrix4f>(matrices.data() + 16 * i).cast<double>();
      inverse.matrix() = m.topRows<3>();
      const double size = inverse.linear().cwiseAbs().maxCoeff();
      sound = isSane(inverse) && size > 1e-9 &&
              std::abs((inverse.linear() / size).determinant()) > 1e-9;
    }
    if (!sound) inverse.setIdentity();
    skin.inverseBind.push_back(inverse);
    skin.bind.push_back(inverse.inverse());
    skin.sound.push_back(sound);
    skin.anySound = skin.anySound || sound;
  }
  return skin;
}

// All joints at one place in the mesh, though their nodes are not: these matrices are fillers.
bool sayNothing(const RawSkin& skin, const GltfScene& scene) {
  std::size_t first = skin.nodes.size();
  bool nodesDiffer = false;
  for (std::size_t i = 0; i < skin.nodes.size(); ++i) {
    if (!skin.sound[i]) continue;
    first = std::min(first, i);
    if (!skin.bind[i].matrix().isApprox(skin.bind[first].matrix(), 1e-9)) return false;
    const Affine &a = scene.rest_world[at(skin.nodes[i])],
                 &b = scene.rest_world[at(skin.nodes[first])];
    nodesDiffer = nodesDiffer || !a.matrix().isApprox(b.matrix(), 1e-6);
  }
  return nodesDiffer;
}

// Per node: whether an animation moves, turns or sizes it.
std::vector<bool> animatedNodes(const GltfDocument& document, std::size_t count) {
  std::vector<bool> animated(count, false);
  const GltfPlace animations = document.root()["animations"];
  for (std::size_t a = 0; a < animations.size(); ++a) {
    const GltfPlace channels = animations.at(a)["channels"];
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const GltfPlace target = channels.at(c)["target"];
      const double node = target["node"].numberOr(-1);
      const std::string path = target["path"].textOr("");
      if (path == "weights" || path == "pointer") continue;
      if (node >= 0 && node < static_cast<double>(count))
        animated[static_cast<std::size_t>(node)] = true;
    }
  }
  return animated;
}

Mat3 axesOf(const Affine& m) {
  return m.linear().colwise().normalized();
}

class RigBuilder {
 public:
  RigBuilder(const GltfDocument& document, const GltfScene& scene, RiggedModel& model, GltfRig& rig)
      : document_(document), scene_(scene), model_(model), rig_(rig) {}

  void build() {
    readSkins();
    orderJoints();
    known_.assign(rig_.nodeOfJoint.size(), false);
    rig_.bind_world.resize(rig_.nodeOfJoint.size());
    for (std::size_t j = 0; j < rig_.nodeOfJoint.size(); ++j) {
      const int node = rig_.nodeOfJoint[j];
      rig_.bind_world[j] = node < 0 ? Affine::Identity() : scene_.rest_world[at(node)];
    }
    for (const int skin : order_) placeSkin(at(skin));
    for (const int skin : order_) prepareVertices(at(skin));
    addJoints();
    writeNotes();
  }

 private:
  void readSkins() {
    rig_.skins.resize(document_.root()["skins"].size());
    raw_.resize(rig_.skins.size());
    std::size_t numbersRead = 0;
    for (const int n : scene_.order) {
      const GltfNode& node = scene_.nodes[at(n)];
      if (!node.inScene || node.mesh < 0 || node.skin < 0 || rig_.skins[at(node.skin)].used)
        continue;
      rig_.skins[at(node.skin)].used = true;
      raw_[at(node.skin)] = readSkin(document_, node.skin, scene_.nodes.size(), numbersRead);
      order_.push_back(node.skin);
    }
  }

  void orderJoints() {
    std::vector<bool> isJoint(scene_.nodes.size(), false);
    for (const int skin : order_) {
      for (const int node : raw_[at(skin)].nodes) isJoint[at(node)] = true;
    }
    rig_.jointOfNode.assign(scene_.nodes.size(), -1);
    rig_.carrierOfNode.assign(scene_.nodes.size(), -1);
    for (const int n : scene_.order) {
      const int parent = scene_.nodes[at(n)].parent;
      int& carrier = rig_.carrierOfNode[at(n)];
      if (parent >= 0) carrier = rig_.carrierOfNode[at(parent)];
      if (!isJoint[at(n)]) continue;
      parent_.push_back(carrier);
      carrier = rig_.jointOfNode[at(n)] = static_cast<int>(rig_.nodeOfJoint.size());
      rig_.nodeOfJoint.push_back(n);
    }
    checkCount();
    if (std::count(parent_.begin(), parent_.end(), -1) > 1) addRoot();
    rig_.skeletonCount = rig_.nodeOfJoint.size();
    addMovers();
    for (const int skin : order_) {
      for (const int node : raw_[at(skin)].nodes) {
        rig_.skins[at(skin)].joint.push_back(rig_.jointOfNode[at(node)]);
      }
    }
  }

  void checkCount() const {
    if (rig_.nodeOfJoint.empty() && document_.root()["meshes"].size() == 0) {
      document_.root().fail("needs a surface: found no mesh",
                            "a motion alone goes onto another character: give it with --motion");
    }
    if (rig_.nodeOfJoint.empty()) {
      document_.root()["skins"].fail(
          "no mesh of the scene has a skin with joints: Fascia needs a rigged character",
          "bind the mesh to a skeleton and export it with its skin");
    }
    if (rig_.nodeOfJoint.size() > kMostRigJoints) {
      document_.root()["skins"].fail("more than " + std::to_string(kMostRigJoints) + " joints");
    }
  }

  void addRoot() {
    for (int& parent : parent_) ++parent;
    for (int& joint : rig_.jointOfNode) joint += joint >= 0 ? 1 : 0;
    for (int& joint : rig_.carrierOfNode) joint += joint >= 0 ? 1 : 0;
    parent_.insert(parent_.begin(), -1);
    rig_.nodeOfJoint.insert(rig_.nodeOfJoint.begin(), -1);
    const auto roots = std::count(parent_.begin(), parent_.end(), 0);
    model_.notes.push_back("the skeleton has " + std::to_string(roots) +
                           " roots: a joint \"fascia_root\" holds them");
  }

  bool isRigidMesh(int n) const {
    const GltfNode& node = scene_.nodes[at(n)];
    return node.inScene && node.mesh >= 0 && (node.skin < 0 || raw_[at(node.skin)].nodes.empty());
  }

  // Whether animations move a node against the one that is `above` it (-1: against the world).
  bool movesBelow(int n, int above, const std::vector<bool>& animated) const {
    for (; n >= 0 && n != above; n = scene_.nodes[at(n)].parent)
      if (animated[at(n)]) return true;
    return false;
  }

  // Meshes without a skin that move by themselves, or stay where they are while the root moves.
  void addMovers() {
    const std::vector<bool> animated = animatedNodes(document_, scene_.nodes.size());
    const bool rootMoves = movesBelow(rig_.nodeOfJoint[0], -1, animated);
    for (const int n : scene_.order) {
      int& carrier = rig_.carrierOfNode[at(n)];
      const int parent = scene_.nodes[at(n)].parent;
      if (rig_.jointOfNode[at(n)] >= 0) continue;
      if (parent >= 0) carrier = rig_.carrierOfNode[at(parent)];
      if (!isRigidMesh(n)) continue;
      const int above = carrier < 0 ? -1 : rig_.nodeOfJoint[at(carrier)];
      if (!movesBelow(n, above, animated) && !(carrier < 0 && rootMoves)) continue;
      parent_.push_back(std::max(carrier, 0));
      carrier = rig_.jointOfNode[at(n)] = static_cast<int>(rig_.nodeOfJoint.size());
      rig_.nodeOfJoint.push_back(n);
    }
    checkCount();
  }

  // How far the joints are from where they should be if the mesh stands at `mesh`: the sum over
  // joints, each counting at most 1, so that a few that are elsewhere do not matter.
  double misfit(std::size_t s, const Affine& mesh) const {
    const RawSkin& raw = raw_[s];
    double sum = 0;
    for (std::size_t i = 0; i < raw.nodes.size(); ++i) {
      if (raw.sound[i]) sum += std::min(1.0, distance(mesh * raw.bind[i], target(s, i)));
    }
    return sum;
  }
  const Affine& target(std::size_t s, std::size_t i) const {
    return rig_.bind_world[at(rig_.skins[s].joint[i])];  // the node's rest pose until it is known
  }
  double distance(const Affine& a, const Affine& b) const {
    return (a.translation() - b.translation()).norm() / size_ + (axesOf(a) - axesOf(b)).norm();
  }

  void measureSize(std::size_t s) {
    Box box;
    for (std::size_t i = 0; i < raw_[s].nodes.size(); ++i)
      box.add(Vec3(target(s, i).translation()));
    size_ = box.empty() ? 0 : box.size().norm();
    if (!(size_ > 1e-9)) size_ = 1;
  }

  // Finds where the mesh stands in the bind pose; fixes the joints that no earlier skin fixed.
  void placeSkin(std::size_t s) {
    GltfSkin& skin = rig_.skins[s];
    RawSkin& raw = raw_[s];
    measureSize(s);
    if (!raw.anySound || sayNothing(raw, scene_)) {
      if (!raw.nodes.empty()) ++skinsWithoutBind_;
      raw.sound.assign(raw.nodes.size(), false);
      raw.anySound = false;
      return;
    }
    skin.whole = bestPlace(s);
    skin.rigid = true;
    for (std::size_t i = 0; i < raw.nodes.size(); ++i) {
      const std::size_t j = at(skin.joint[i]);
      if (!raw.sound[i]) {
        ++unsoundBinds_;
        continue;
      }
      const Affine bind = skin.whole * raw.bind[i];
      const bool agrees = distance(bind, rig_.bind_world[j]) <= kSamePlace;
      if (known_[j]) {
        skin.rigid = skin.rigid && agrees;
      } else {
        if (!agrees) ++posedJoints_;
        rig_.bind_world[j] = bind;
        known_[j] = true;
      }
    }
    if (!skin.rigid) ++bentSkins_;
  }

  Affine bestPlace(std::size_t s) const {
    constexpr std::size_t kMostCandidates = 128;
    const RawSkin& raw = raw_[s];
    std::vector<Affine> candidates;
    const std::size_t step = raw.nodes.size() / kMostCandidates + 1;
    for (std::size_t i = 0; i < raw.nodes.size(); i += step) {
      if (raw.sound[i]) candidates.push_back(target(s, i) * raw.inverseBind[i]);
    }
    const int parent = scene_.nodes[at(raw.nodes[0])].parent;
    if (parent >= 0) candidates.push_back(scene_.rest_world[at(parent)]);
    Affine best = Affine::Identity();
    best.linear() *= scene_.scale;
    double least = misfit(s, best);
    for (const Affine& candidate : candidates) {
      if (!isSane(candidate) || !(std::abs(candidate.linear().determinant()) > 0)) continue;
      const double found = misfit(s, candidate);
      if (found < least) least = found, best = candidate;
    }
    return best;
  }

  void prepareVertices(std::size_t s) {
    GltfSkin& skin = rig_.skins[s];
    const RawSkin& raw = raw_[s];
    for (std::size_t i = 0; i < raw.nodes.size(); ++i) {
      const Affine bind = rig_.bind_world[at(skin.joint[i])] * raw.inverseBind[i];
      const bool whole = skin.rigid || (raw.anySound && !raw.sound[i]);
      skin.toWorld.push_back(whole ? skin.whole : bind);
    }
    if (!raw.anySound && !skin.toWorld.empty()) skin.whole = skin.toWorld[0];
  }

  void addJoints() {
    for (std::size_t j = 0; j < rig_.nodeOfJoint.size(); ++j) {
      const int node = rig_.nodeOfJoint[j];
      RigJoint joint;
      joint.node = node;
      joint.parent = parent_[j];
      joint.name = node < 0 ? "fascia_root" : scene_.nodes[at(node)].name;
      const Mat3 fallback =
          joint.parent < 0 ? Mat3::Identity() : model_.joints[at(joint.parent)].rest_world.rotation;
      joint.rest_world = rigidPart(rig_.bind_world[j], fallback);
      model_.joints.push_back(std::move(joint));
    }
    makeNamesUnique(model_);
  }

  void writeNotes() {
    const auto note = [&](std::size_t count, const std::string& text) {
      if (count > 0) model_.notes.push_back(std::to_string(count) + text);
    };
    note(skinsWithoutBind_, " skins have no inverse bind matrices: the nodes' pose binds them");
    note(unsoundBinds_, " inverse bind matrices are no transforms: the nodes' pose stands in");
    note(posedJoints_, " joints' nodes are not in the bind pose: the skin's bind pose counts");
    note(bentSkins_, " skins disagree with an earlier one on the bind pose: bent to that one's");
  }

  const GltfDocument& document_;
  const GltfScene& scene_;
  RiggedModel& model_;
  GltfRig& rig_;
  std::vector<RawSkin> raw_;
  std::vector<int> order_;   // skins that are shown
  std::vector<int> parent_;  // joint of a joint
  std::vector<bool> known_;  // bind_world is a skin's
  double size_ = 1;
  std::size_t skinsWithoutBind_ = 0, unsoundBinds_ = 0, posedJoints_ = 0, bentSkins_ = 0;
};

}  // namespace

GltfRig GltfRig::of(const GltfDocument& document, const GltfScene& scene, RiggedModel& model) {
  GltfRig rig;
  RigBuilder(document, scene, model, rig).build();
  return rig;
}

}  // namespace fascia
