#include <fascia/io/rig_import/gltf/gltf_scene.h>

#include <algorithm>
#include <cmath>

namespace fascia {
namespace {

// Numbers or what they are if they are missing or not sane; `mended` tells of the latter.
template <std::size_t Count>
bool readNumbers(const GltfPlace& place, double (&values)[Count], bool& mended) {
  if (!place) return false;
  double read[Count];
  place.numbers(read, Count);
  if (!std::all_of(read, read + Count, [](double v) { return isSane(v); })) {
    mended = true;
    return false;
  }
  std::copy(read, read + Count, values);
  return true;
}

void readTransform(const GltfPlace& place, GltfNode& node, bool& mended) {
  double m[16], t[3], r[4], s[3];
  if (readNumbers(place["matrix"], m, mended)) {
    node.hasMatrix = true;
    node.matrix.matrix() = Eigen::Map<const Eigen::Matrix4d>(m).topRows<3>();
    return;
  }
  if (readNumbers(place["translation"], t, mended)) node.translation = Vec3(t[0], t[1], t[2]);
  if (readNumbers(place["scale"], s, mended)) node.scale = Vec3(s[0], s[1], s[2]);
  if (readNumbers(place["rotation"], r, mended)) {
    const Quat q(r[3], r[0], r[1], r[2]);
    if (q.norm() > 1e-6) {
      node.rotation = q.normalized();
    } else {
      mended = true;
    }
  }
}

void readNode(const GltfDocument& document, const GltfPlace& place, GltfNode& node, bool& mended) {
  const GltfPlace root = document.root();
  node.name = place["name"].textOr("");
  node.mesh = place["mesh"].indexOr(-1, static_cast<int>(root["meshes"].size()));
  node.skin = place["skin"].indexOr(-1, static_cast<int>(root["skins"].size()));
  readTransform(place, node, mended);
}

// Parents before children; nodes that are reached twice keep their first parent.
class TreeWalk {
 public:
  TreeWalk(const GltfPlace& nodes, GltfScene& scene, std::vector<std::string>& notes)
      : nodes_(nodes), scene_(scene), notes_(notes), count_(static_cast<int>(nodes.size())) {}

  void run() {
    linkParents();
    for (int n = count_; n-- > 0;) {
      if (scene_.nodes[static_cast<std::size_t>(n)].parent < 0) stack_.push_back(n);
    }
    while (!stack_.empty()) {
      const int n = stack_.back();
      stack_.pop_back();
      scene_.order.push_back(n);
      const std::vector<int>& children = children_[static_cast<std::size_t>(n)];
      stack_.insert(stack_.end(), children.rbegin(), children.rend());
    }
    if (static_cast<int>(scene_.order.size()) < count_) {
      nodes_.fail("some nodes are below themselves", "the tree of nodes must not have cycles");
    }
  }

 private:
  void linkParents() {
    children_.resize(static_cast<std::size_t>(count_));
    std::size_t twice = 0;
    for (int n = 0; n < count_; ++n) {
      const GltfPlace children = nodes_.at(static_cast<std::size_t>(n))["children"];
      for (std::size_t i = 0; i < children.size(); ++i) {
        const int child = children.at(i).index(count_);
        int& parent = scene_.nodes[static_cast<std::size_t>(child)].parent;
        if (parent >= 0) {
          ++twice;
          continue;
        }
        parent = n;
        children_[static_cast<std::size_t>(n)].push_back(child);
      }
    }
    if (twice > 0) {
      notes_.push_back(std::to_string(twice) + " nodes have two parents: the first one counts");
    }
  }

  GltfPlace nodes_;
  GltfScene& scene_;
  std::vector<std::string>& notes_;
  int count_;
  std::vector<std::vector<int>> children_;
  std::vector<int> stack_;
};

// Per node: whether a mesh with a skin that names joints is there or below.
std::vector<bool> holdsCharacter(const GltfPlace& root, const GltfScene& scene) {
  std::vector<bool> holds(scene.nodes.size(), false);
  for (auto n = scene.order.rbegin(); n != scene.order.rend(); ++n) {  // children before parents
    const auto i = static_cast<std::size_t>(*n);
    const GltfNode& node = scene.nodes[i];
    const bool own = node.mesh >= 0 && node.skin >= 0 &&
                     root["skins"].at(static_cast<std::size_t>(node.skin))["joints"].size() > 0;
    holds[i] = holds[i] || own;
    if (holds[i] && node.parent >= 0) holds[static_cast<std::size_t>(node.parent)] = true;
  }
  return holds;
}

bool anyOf(const GltfPlace& scene, const std::vector<bool>& nodes) {
  const GltfPlace roots = scene["nodes"];
  for (std::size_t i = 0; i < roots.size(); ++i) {
    const int n = roots.at(i).index(static_cast<int>(nodes.size()));
    if (nodes[static_cast<std::size_t>(n)]) return true;
  }
  return false;
}

// The default scene, or, if there is no character in it, the first that has one.
std::size_t sceneToShow(const GltfPlace& root, const GltfScene& scene) {
  const GltfPlace scenes = root["scenes"];
  const auto usual =
      static_cast<std::size_t>(root["scene"].indexOr(0, static_cast<int>(scenes.size())));
  const std::vector<bool> holds = holdsCharacter(root, scene);
  if (anyOf(scenes.at(usual), holds)) return usual;
  for (std::size_t s = 0; s < scenes.size(); ++s)
    if (anyOf(scenes.at(s), holds)) return s;
  return usual;
}

std::string sceneText(const GltfPlace& scenes, std::size_t index) {
  const std::string name = scenes.at(index)["name"].textOr("");
  return "scene " + std::to_string(index) + (name.empty() ? "" : " (" + jsonText(name) + ")");
}

// Files without scenes show everything.
void markShown(const GltfDocument& document, GltfScene& scene, std::vector<std::string>& notes) {
  const GltfPlace root = document.root(), scenes = root["scenes"];
  const bool all = scenes.size() == 0;
  if (!all) {
    const std::size_t shown = sceneToShow(root, scene), usual = root["scene"].countOr(0);
    if (shown != usual)
      notes.push_back("the default " + sceneText(scenes, usual) +
                      " has no skinned mesh: " + sceneText(scenes, shown) + " is taken");
    scene.shown = static_cast<int>(shown);
    const GltfPlace roots = scenes.at(shown)["nodes"];
    for (std::size_t i = 0; i < roots.size(); ++i) {
      const int n = roots.at(i).index(static_cast<int>(scene.nodes.size()));
      scene.nodes[static_cast<std::size_t>(n)].inScene = true;
    }
  }
  for (const int n : scene.order) {
    GltfNode& node = scene.nodes[static_cast<std::size_t>(n)];
    const bool below =
        node.parent >= 0 && scene.nodes[static_cast<std::size_t>(node.parent)].inScene;
    node.inScene = node.inScene || all || below;
  }
}

}  // namespace

Affine GltfNode::local() const {
  if (hasMatrix) return matrix;
  Affine out;
  out.linear() = rotation.toRotationMatrix() * scale.asDiagonal();
  out.translation() = translation;
  return out;
}

GltfScene GltfScene::of(const GltfDocument& document, double scale,
                        std::vector<std::string>& notes) {
  const GltfPlace nodes = document.root()["nodes"];
  GltfScene scene;
  scene.scale = scale;
  scene.nodes.resize(nodes.size());
  std::size_t mended = 0;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    bool mendedHere = false;
    readNode(document, nodes.at(n), scene.nodes[n], mendedHere);
    mended += mendedHere ? 1 : 0;
  }
  if (mended > 0) {
    notes.push_back(std::to_string(mended) + " nodes have transforms that are no numbers: ignored");
  }
  TreeWalk(nodes, scene, notes).run();
  markShown(document, scene, notes);
  std::vector<Affine> local;
  for (const GltfNode& node : scene.nodes) local.push_back(node.local());
  scene.rest_world.resize(local.size());
  scene.toWorld(local, scene.order, scene.rest_world);
  return scene;
}

void GltfScene::toWorld(const std::vector<Affine>& local, const std::vector<int>& some,
                        std::vector<Affine>& world) const {
  Affine unit = Affine::Identity();
  unit.linear() *= scale;
  for (const int n : some) {
    const auto i = static_cast<std::size_t>(n);
    const int parent = nodes[i].parent;
    world[i] = (parent < 0 ? unit : world[static_cast<std::size_t>(parent)]) * local[i];
  }
}

Mat3 rotationOf(const Mat3& m, const Mat3& fallback) {
  const double size = m.cwiseAbs().maxCoeff();
  if (!(size > 1e-30) || !isSane(size)) return fallback;
  Mat3 r = m / size;
  const double determinant = r.determinant();
  if (!(std::abs(determinant) > 1e-9)) return fallback;
  if (determinant < 0) r = -r;
  for (int i = 0; i < 50; ++i) {
    const Mat3 inverse = r.inverse().transpose();
    const double balance = std::sqrt(inverse.norm() / r.norm());
    const Mat3 next = 0.5 * (balance * r + inverse / balance);
    const double change = (next - r).cwiseAbs().maxCoeff();
    r = next;
    if (change < 1e-14) break;
  }
  return r;
}

}  // namespace fascia
