#include <fascia/io/rig_import/gltf/gltf_morphs.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/index.h>
#include <fascia/flesh/morphs.h>
#include <fascia/io/rig_model/rig_limits.h>

namespace fascia {
namespace {

// Of the figure's size: vertices that are moved more differently are not one point.
constexpr float kSameMove = 1e-4f;

}  // namespace

void GltfMorphs::read(const RigPart& part, const GltfPlace& primitive,
                      std::span<const Eigen::Matrix3f> toWorld) {
  const GltfPlace targets = primitive["targets"];
  const std::size_t first = morphsOf(part.node);
  for (std::size_t t = 0; t < targets.size() && first + t < morphs_.size(); ++t) {
    RigMorph& morph = morphs_[first + t];
    if (morph.node != part.node) break;  // more than the mesh's first primitive has
    const std::vector<Eigen::Vector3f> moves =
        displacements(targets.at(t)["POSITION"], part.vertexCount);
    for (std::size_t v = 0; v < moves.size(); ++v) {
      if (moves[v].isZero(0)) continue;
      morph.points.push_back(part.firstVertex + static_cast<std::uint32_t>(v));
      morph.displacement_m.push_back(toWorld[v] * moves[v]);
    }
  }
}

// The first of a node's morphs.
std::size_t GltfMorphs::morphsOf(int node) {
  const auto found = std::ranges::find(morphs_, node, &RigMorph::node);
  const auto first = static_cast<std::size_t>(found - morphs_.begin());
  if (found != morphs_.end()) return first;
  const GltfPlace mesh = document_.root()["meshes"].at(at(scene_.nodes[at(node)].mesh));
  const GltfPlace primitives = mesh["primitives"];
  std::size_t count = 0;
  for (std::size_t p = 0; p < primitives.size(); ++p)
    count = std::max(count, primitives.at(p)["targets"].size());
  if (count > kMostRigMorphs - morphs_.size())
    mesh.fail("more than " + std::to_string(kMostRigMorphs) + " morph targets in one character");
  const GltfPlace own = document_.root()["nodes"].at(at(node))["weights"];
  const GltfPlace weights = own ? own : mesh["weights"];
  for (std::size_t t = 0; t < count; ++t) {
    const double rest = t < weights.size() ? weights.at(t).numberOr(0) : 0;
    RigMorph morph;
    morph.name = freshName(mesh, scene_.nodes[at(node)], t);
    morph.node = node, morph.target = static_cast<int>(t);
    if (std::abs(rest) <= kMostMorphWeight) morph.rest = static_cast<float>(rest);
    morphs_.push_back(std::move(morph));
  }
  return first;
}

// As the file names it; with the node's name and a number where another mesh has the same.
std::string GltfMorphs::freshName(const GltfPlace& mesh, const GltfNode& node,
                                  std::size_t target) const {
  const auto taken = [&](const std::string& name) {
    return std::ranges::find(morphs_, name, &RigMorph::name) != morphs_.end();
  };
  const GltfPlace names = mesh["extras"]["targetNames"];
  std::string name = target < names.size() ? names.at(target).textOr("") : std::string();
  if (name.empty()) name = "morph " + std::to_string(target + 1);
  if (taken(name) && !node.name.empty()) name = node.name + "." + name;
  const std::string stem = name;
  for (int n = 2; taken(name); ++n) name = stem + " (" + std::to_string(n) + ")";
  return name;
}

std::vector<Eigen::Vector3f> GltfMorphs::displacements(const GltfPlace& accessor,
                                                       std::size_t count) {
  if (!accessor) return {};
  const int index = accessor.index(static_cast<int>(document_.root()["accessors"].size()));
  numbers_ += 3 * count;
  if (numbers_ > kMostMorphNumbers)
    accessor.fail("more than " + std::to_string(kMostMorphNumbers) + " numbers of morph targets");
  if (document_.elementCount(index) != count) {
    ++misfits_;
    return {};
  }
  const std::vector<float> values = document_.floats(index, 3);
  std::vector<Eigen::Vector3f> out(count, Eigen::Vector3f::Zero());
  for (std::size_t v = 0; v < count; ++v) {
    const Eigen::Vector3f d(values[3 * v], values[3 * v + 1], values[3 * v + 2]);
    const bool sound = isSane(d.x()) && isSane(d.y()) && isSane(d.z());
    if (sound) out[v] = d;
    unsound_ += sound ? 0 : 1;
  }
  return out;
}

void GltfMorphs::shapeRest(std::vector<Eigen::Vector3f>& positions_m) {
  Box box;
  for (const Eigen::Vector3f& p : positions_m) box.add(p.cast<double>());
  alike_m_ = box.empty() ? 0 : kSameMove * static_cast<float>(box.size().norm());
  firstMove_.assign(positions_m.size() + 1, 0);
  for (const RigMorph& morph : morphs_)
    for (const std::uint32_t v : morph.points) ++firstMove_[v + 1];
  for (std::size_t v = 0; v < positions_m.size(); ++v) firstMove_[v + 1] += firstMove_[v];
  moves_.resize(firstMove_.back());
  std::vector<std::size_t> next = firstMove_;
  for (std::size_t m = 0; m < morphs_.size(); ++m)
    for (std::size_t k = 0; k < morphs_[m].points.size(); ++k) {
      const std::uint32_t v = morphs_[m].points[k];
      const Eigen::Vector3f& d = morphs_[m].displacement_m[k];
      moves_[next[v]++] = {static_cast<std::uint32_t>(m), d};
      if (morphs_[m].rest != 0) positions_m[v] += morphs_[m].rest * d;
    }
}

bool GltfMorphs::movedAlike(std::uint32_t a, std::uint32_t b) const {
  const std::span<const Move> x = movesOf(a), y = movesOf(b);
  std::size_t i = 0, j = 0;
  while (i < x.size() || j < y.size()) {
    const bool onlyX = j == y.size() || (i < x.size() && x[i].morph < y[j].morph);
    const bool onlyY = !onlyX && (i == x.size() || y[j].morph < x[i].morph);
    Eigen::Vector3f difference = Eigen::Vector3f::Zero();
    if (!onlyY) difference += x[i++].displacement_m;
    if (!onlyX) difference -= y[j++].displacement_m;
    if (difference.norm() > alike_m_) return false;
  }
  return true;
}

void GltfMorphs::finish() {
  for (RigMorph& morph : morphs_) {
    // A point is its first vertex.
    std::vector<std::pair<std::uint32_t, std::size_t>> moves;
    for (std::size_t k = 0; k < morph.points.size(); ++k)
      moves.emplace_back(model_.vertices[morph.points[k]].point, k);
    std::ranges::sort(moves);
    RigMorph ofPoints = morph;
    ofPoints.points.clear(), ofPoints.displacement_m.clear();
    for (const auto& [point, k] : moves) {
      if (!ofPoints.points.empty() && ofPoints.points.back() == point) continue;
      ofPoints.points.push_back(point);
      ofPoints.displacement_m.push_back(morph.displacement_m[k]);
    }
    model_.morphs.push_back(std::move(ofPoints));
  }
  const auto note = [&](std::size_t count, const char* text) {
    if (count > 0) model_.notes.push_back(std::to_string(count) + text);
  };
  note(misfits_, " morph targets have another number of vertices than their mesh: left out");
  note(unsound_, " displacements of morph targets are no numbers: these count as 0");
}

}  // namespace fascia
