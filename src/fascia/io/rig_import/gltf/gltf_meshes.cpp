#include <fascia/io/rig_import/gltf/gltf_meshes.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <fascia/base/index.h>
#include <fascia/geometry/box_tree.h>
#include <fascia/io/gltf/gltf_triangles.h>
#include <fascia/io/rig_import/gltf/gltf_materials.h>
#include <fascia/io/rig_import/gltf/gltf_morphs.h>
#include <fascia/io/rig_model/rig_limits.h>
#include <fascia/io/rig_model/simulated_surface.h>

namespace fascia {
namespace {

// What was mended, over all primitives; told once.
struct Mended {
  std::size_t notTriangles = 0, withoutPositions = 0, badCorners = 0, badPositions = 0;
  std::size_t badJoints = 0, badSums = 0, badWeights = 0, tooMany = 0, unskinned = 0;
  std::size_t hung = 0, loose = 0, moving = 0, instanced = 0;

  void tell(std::vector<std::string>& notes) const {
    const auto note = [&](std::size_t count, const char* text) {
      if (count > 0) notes.push_back(std::to_string(count) + text);
    };
    note(notTriangles, " primitives are points or lines: left out");
    note(withoutPositions, " primitives have no positions: left out");
    note(badCorners, " triangles name vertices that are not there: left out");
    note(badPositions, " vertices have positions that are no numbers: put beside others");
    note(badJoints, " vertices are moved by joints that are not there: by their others only");
    note(badWeights, " vertices have weights that are negative or no numbers: these count as 0");
    note(badSums, " vertices have weights that do not sum to one: scaled");
    note(tooMany, " vertices have more than 8 weights: the heaviest 8 joints count");
    note(unskinned, " vertices have no weights: moved as the nearest ones that have");
    note(hung, " meshes without a skin hang on a joint: they move rigidly with it");
    note(moving, " meshes without a skin move by themselves: each has a joint of its own");
    note(instanced,
         " meshes are drawn many times (EXT_mesh_gpu_instancing): kept in the file, one is "
         "simulated");
    note(loose, " meshes have neither a skin nor a joint above: they move with the root");
  }
};

// The joints and weights of a primitive's vertices as the file has them: all sets, side by side.
struct RawWeights {
  std::size_t perVertex = 0;
  std::vector<std::uint32_t> slots;  // joints of the skin
  std::vector<float> weights;
};

class MeshReader {
 public:
  MeshReader(const GltfDocument& document, const GltfScene& scene, const GltfRig& rig,
             RiggedModel& model)
      : document_(document),
        scene_(scene),
        rig_(rig),
        model_(model),
        morphs_(document, scene, model) {}

  void read() {
    for (const int n : scene_.order) {
      const GltfNode& node = scene_.nodes[at(n)];
      if (node.inScene && node.mesh >= 0) readMesh(n);
    }
    if (model_.drawnTriangles.empty()) {
      document_.root()["meshes"].fail("there are no triangles in the scene");
    }
    giveWeightsToUnskinned();
    makeNormals();
    mended_.tell(model_.notes);
    morphs_.shapeRest(positions_);
    buildSimulatedSurface(positions_, weights_, model_, [&](std::uint32_t a, std::uint32_t b) {
      return morphs_.movedAlike(a, b);
    });
    morphs_.finish();
  }

 private:
  void readMesh(int n) {
    const GltfNode& node = scene_.nodes[at(n)];
    const GltfPlace primitives = document_.root()["meshes"].at(at(node.mesh))["primitives"];
    const GltfPlace extensions = document_.root()["nodes"].at(at(n))["extensions"];
    if (extensions["EXT_mesh_gpu_instancing"]) ++mended_.instanced;
    const bool skinned = node.skin >= 0 && !rig_.skins[at(node.skin)].joint.empty();
    if (!skinned) ++countOf(rig_.carrierOfNode[at(n)]);
    for (std::size_t p = 0; p < primitives.size(); ++p)
      readPrimitive(n, skinned, p, primitives.at(p));
  }

  // Of meshes without a skin that such a joint carries.
  std::size_t& countOf(int carrier) {
    if (carrier < 0) return mended_.loose;
    return at(carrier) < rig_.skeletonCount ? mended_.hung : mended_.moving;
  }

  void readPrimitive(int n, bool skinned, std::size_t index, const GltfPlace& place) {
    const GltfPlace attributes = place["attributes"];
    const int mode = place["mode"].indexOr(kGltfTriangles, 7);
    if (mode < kGltfTriangles) {
      ++mended_.notTriangles;
      return;
    }
    if (!attributes["POSITION"]) {
      ++mended_.withoutPositions;
      return;
    }
    toWorld_.clear();
    RigPart part = newPart(n, index, place);
    checkBudget(attributes["POSITION"]);
    const std::vector<float> local = floats(attributes["POSITION"], 3);
    part.vertexCount = static_cast<std::uint32_t>(local.size() / 3);
    if (part.vertexCount == 0) return;
    model_.vertices.resize(model_.vertices.size() + part.vertexCount);
    positions_.resize(model_.vertices.size());
    weights_.resize(model_.vertices.size());
    hasNormal_.resize(model_.vertices.size(), false);
    const bool mirrored =
        skinned ? placeSkinned(n, part, attributes, local) : placeRigid(n, part, attributes, local);
    if (place["targets"].size() > 0) morphs_.read(part, place, toWorld_);
    mendPositions(part);
    readUvs(part, attributes);
    readTriangles(place, mode, mirrored, part);
    model_.parts.push_back(std::move(part));
  }

  RigPart newPart(int n, std::size_t index, const GltfPlace& place) {
    const GltfNode& node = scene_.nodes[at(n)];
    RigPart part;
    part.name = node.name;
    if (part.name.empty()) {
      part.name = document_.root()["meshes"].at(at(node.mesh))["name"].textOr("");
    }
    if (part.name.empty()) part.name = "mesh " + std::to_string(node.mesh);
    part.node = n, part.mesh = node.mesh, part.primitive = static_cast<int>(index);
    part.material = place["material"].indexOr(-1, static_cast<int>(model_.materials.size()));
    part.firstVertex = static_cast<std::uint32_t>(model_.vertices.size());
    part.firstTriangle = static_cast<std::uint32_t>(model_.drawnTriangles.size());
    return part;
  }

  std::vector<float> floats(const GltfPlace& accessor, int components) const {
    return document_.floats(accessor.index(accessorCount()), components);
  }
  int accessorCount() const { return static_cast<int>(document_.root()["accessors"].size()); }

  void checkBudget(const GltfPlace& positions) const {
    const std::size_t count = document_.elementCount(positions.index(accessorCount()));
    if (count > kMostRigVertices - model_.vertices.size()) {
      positions.fail("more than " + std::to_string(kMostRigVertices) +
                     " vertices in one character");
    }
  }

  // Attributes of another length than the positions are no use.
  std::vector<float> attribute(const GltfPlace& accessor, int components, std::size_t count) const {
    if (!accessor) return {};
    if (document_.elementCount(accessor.index(accessorCount())) != count) {
      accessor.fail("has another number of elements than the positions");
    }
    return floats(accessor, components);
  }

  RawWeights readWeights(const GltfPlace& attributes, std::size_t count) const {
    constexpr std::size_t kMostSets = 4;
    RawWeights out;
    std::vector<std::vector<std::uint32_t>> joints;
    std::vector<std::vector<float>> weights;
    for (std::size_t set = 0; set < kMostSets; ++set) {
      const GltfPlace j = attributes["JOINTS_" + std::to_string(set)];
      const GltfPlace w = attributes["WEIGHTS_" + std::to_string(set)];
      if (!j || !w) break;
      weights.push_back(attribute(w, 4, count));
      if (document_.elementCount(j.index(accessorCount())) != count) {
        j.fail("has another number of elements than the positions");
      }
      joints.push_back(document_.integers(j.index(accessorCount()), 4));
    }
    out.perVertex = 4 * joints.size();
    for (std::size_t v = 0; v < count; ++v) {
      for (std::size_t set = 0; set < joints.size(); ++set) {
        const auto first = static_cast<std::ptrdiff_t>(4 * v);
        out.slots.insert(out.slots.end(), joints[set].begin() + first,
                         joints[set].begin() + first + 4);
        out.weights.insert(out.weights.end(), weights[set].begin() + first,
                           weights[set].begin() + first + 4);
      }
    }
    return out;
  }

  // Places a primitive's vertices by its skin; returns whether that mirrors them.
  bool placeSkinned(int n, const RigPart& part, const GltfPlace& attributes,
                    const std::vector<float>& local) {
    const GltfSkin& skin = rig_.skins[at(scene_.nodes[at(n)].skin)];
    const RawWeights raw = readWeights(attributes, part.vertexCount);
    const std::vector<float> normals = attribute(attributes["NORMAL"], 3, part.vertexCount);
    std::vector<std::pair<std::uint16_t, float>> influences;
    double mirroring = skin.whole.linear().determinant();
    for (std::size_t v = 0; v < part.vertexCount; ++v) {
      const Affine blend = blendOf(skin, raw, v, part.firstVertex + v, influences);
      if (v == 0 && !skin.rigid) mirroring = blend.linear().determinant();
      placeVertex(blend, local, normals, v, part.firstVertex + v);
    }
    return mirroring < 0;
  }

  // Fills the vertex' weights; returns the matrix that brings it to the bind pose.
  Affine blendOf(const GltfSkin& skin, const RawWeights& raw, std::size_t v, std::size_t vertex,
                 std::vector<std::pair<std::uint16_t, float>>& influences) {
    influences.clear();
    Affine blend = skin.whole;
    if (!skin.rigid) blend.matrix().setZero();
    bool badJoint = false, badWeight = false;
    double sum = 0;
    for (std::size_t k = 0; k < raw.perVertex; ++k) {
      const std::uint32_t slot = raw.slots[v * raw.perVertex + k];
      const float weight = raw.weights[v * raw.perVertex + k];
      badWeight = badWeight || !std::isfinite(weight) || weight < 0;
      if (!(weight > 0) || !std::isfinite(weight)) continue;
      if (slot >= skin.joint.size()) {
        badJoint = true;
        continue;
      }
      sum += weight;
      influences.emplace_back(static_cast<std::uint16_t>(skin.joint[slot]), weight);
      if (!skin.rigid) blend.matrix() += weight * skin.toWorld[slot].matrix();
    }
    mended_.badJoints += badJoint ? 1 : 0;
    mended_.badWeights += badWeight ? 1 : 0;
    mended_.tooMany += influences.size() > PointWeights::kMost ? 1 : 0;
    if (!packWeights(influences, weights_[vertex])) {
      unskinned_.push_back({vertex, at(skin.joint[0])});
      return skin.whole;
    }
    constexpr double kLargestSlip = 0.02;  // of weights stored as bytes
    if (!badJoint && !badWeight && std::abs(sum - 1) > kLargestSlip) ++mended_.badSums;
    if (!skin.rigid) blend.matrix() /= sum;
    return blend;
  }

  // A mesh without a skin moves with the joint above it, or with the root.
  bool placeRigid(int n, const RigPart& part, const GltfPlace& attributes,
                  const std::vector<float>& local) {
    const int joint = std::max(rig_.carrierOfNode[at(n)], 0);
    const int carrier = rig_.carrierOfNode[at(n)] < 0 ? -1 : rig_.nodeOfJoint[at(joint)];
    Affine matrix = scene_.rest_world[at(n)];
    if (carrier >= 0) {  // from the nodes' rest pose to the bind pose
      const Affine moved =
          rig_.bind_world[at(joint)] * scene_.rest_world[at(carrier)].inverse() * matrix;
      if (isSane(moved)) matrix = moved;
    }
    const std::vector<float> normals = attribute(attributes["NORMAL"], 3, part.vertexCount);
    for (std::size_t v = 0; v < part.vertexCount; ++v) {
      placeVertex(matrix, local, normals, v, part.firstVertex + v);
      PointWeights& weights = weights_[part.firstVertex + v];
      weights.joint[0] = static_cast<std::uint16_t>(joint);
      weights.weight[0] = 1;
    }
    return matrix.linear().determinant() < 0;
  }

  void placeVertex(const Affine& matrix, const std::vector<float>& local,
                   const std::vector<float>& normals, std::size_t v, std::size_t vertex) {
    const Vec3 p = matrix * Eigen::Map<const Eigen::Vector3f>(&local[3 * v]).cast<double>();
    positions_[vertex] = p.cast<float>();
    toWorld_.push_back(matrix.linear().cast<float>());
    if (normals.empty()) return;
    // Normals go by the inverse transpose: cofactors do without the inverse.
    const Mat3 m = matrix.linear();
    const Vec3 normal = Eigen::Map<const Eigen::Vector3f>(&normals[3 * v]).cast<double>();
    Vec3 turned = m.col(1).cross(m.col(2)) * normal.x() + m.col(2).cross(m.col(0)) * normal.y() +
                  m.col(0).cross(m.col(1)) * normal.z();
    if (m.determinant() < 0) turned = -turned;
    const double length = turned.norm();
    if (!(length > 0) || !std::isfinite(length)) return;
    model_.vertices[vertex].normal = (turned / length).cast<float>();
    hasNormal_[vertex] = true;
  }

  // A vertex that is nowhere goes to the one before it: its triangles lose their area.
  void mendPositions(const RigPart& part) {
    const auto sound = [](const Eigen::Vector3f& p) {
      return isSane(p.x()) && isSane(p.y()) && isSane(p.z());
    };
    const auto first = positions_.begin() + part.firstVertex;
    const auto found = std::find_if(first, positions_.end(), sound);
    if (found == positions_.end()) {
      document_.root()["meshes"].at(at(part.mesh)).fail("has no position that is a number");
    }
    Eigen::Vector3f last = *found;
    for (auto p = first; p != positions_.end(); ++p) {
      if (!sound(*p)) {
        *p = last;
        ++mended_.badPositions;
      }
      last = *p;
    }
  }

  void readUvs(const RigPart& part, const GltfPlace& attributes) {
    GltfTextureUse use;
    if (part.material >= 0) use = baseTextureOf(document_, part.material);
    const std::vector<float> uvs =
        attribute(attributes["TEXCOORD_" + std::to_string(use.uvSet)], 2, part.vertexCount);
    if (uvs.empty()) return;
    for (std::size_t v = 0; v < part.vertexCount; ++v) {
      const Eigen::Vector2f uv = use.uvTransform * Eigen::Vector3f(uvs[2 * v], uvs[2 * v + 1], 1);
      if (isSane(uv.x()) && isSane(uv.y())) model_.vertices[part.firstVertex + v].uv = uv;
    }
  }

  void readTriangles(const GltfPlace& place, int mode, bool mirrored, RigPart& part) {
    std::vector<std::uint32_t> run;
    if (place["indices"]) {
      const int accessor = place["indices"].index(accessorCount());
      corners_ += document_.elementCount(accessor);
      if (corners_ > kMostRigCorners) {
        place["indices"].fail("more than " + std::to_string(kMostRigCorners) +
                              " corners of triangles");
      }
      run = document_.integers(accessor, 1);
    } else {
      for (std::uint32_t i = 0; i < part.vertexCount; ++i) run.push_back(i);
    }
    for (std::array<std::uint32_t, 3> t : gltfTriangles(mode, run)) {
      if (*std::max_element(t.begin(), t.end()) >= part.vertexCount) {
        ++mended_.badCorners;
        continue;
      }
      if (mirrored) std::swap(t[1], t[2]);
      for (std::uint32_t& corner : t) corner += part.firstVertex;
      model_.drawnTriangles.push_back(t);
    }
    part.triangleCount =
        static_cast<std::uint32_t>(model_.drawnTriangles.size()) - part.firstTriangle;
  }

  void giveWeightsToUnskinned() {
    if (unskinned_.empty()) return;
    mended_.unskinned = unskinned_.size();
    std::vector<bool> bare(positions_.size(), false);
    for (const Unskinned& u : unskinned_) bare[u.vertex] = true;
    std::vector<Box> boxes;
    std::vector<std::size_t> skinned;
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      if (bare[v]) continue;
      boxes.emplace_back().add(positions_[v].cast<double>());
      skinned.push_back(v);
    }
    BoxTree tree;
    tree.build(boxes);
    for (const Unskinned& u : unskinned_) {
      const Vec3 p = positions_[u.vertex].cast<double>();
      double nearest = std::numeric_limits<double>::infinity();
      std::size_t from = u.vertex;
      const auto distance = [&](const Box& box) { return squaredDistance(box, p); };
      tree.visitNearFirst(
          distance, [&](const Box& box) { return distance(box) < nearest; },
          [&](std::uint32_t item) {
            nearest = distance(boxes[item]);
            from = skinned[item];
          });
      PointWeights& weights = weights_[u.vertex];
      if (from != u.vertex) {
        weights = weights_[from];
      } else {
        weights.joint[0] = static_cast<std::uint16_t>(u.joint);
        weights.weight[0] = 1;
      }
    }
  }

  // Area-weighted, for vertices whose file gives none.
  void makeNormals() {
    if (std::find(hasNormal_.begin(), hasNormal_.end(), false) == hasNormal_.end()) return;
    std::vector<Eigen::Vector3f> normals;
    computeNormals(positions_, model_.drawnTriangles, normals);
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      if (!hasNormal_[v]) model_.vertices[v].normal = normals[v];
    }
  }

  struct Unskinned {
    std::size_t vertex, joint;  // what moves it if nothing is skinned
  };

  const GltfDocument& document_;
  const GltfScene& scene_;
  const GltfRig& rig_;
  RiggedModel& model_;
  std::vector<Eigen::Vector3f> positions_;  // per vertex
  std::vector<PointWeights> weights_;
  std::vector<bool> hasNormal_;
  std::vector<Eigen::Matrix3f> toWorld_;  // of the primitive at hand: its vertices' directions
  GltfMorphs morphs_;
  std::vector<Unskinned> unskinned_;
  std::size_t corners_ = 0;  // read so far, also those that were left out
  Mended mended_;
};

}  // namespace

void readGltfMeshes(const GltfDocument& document, const GltfScene& scene, const GltfRig& rig,
                    RiggedModel& model) {
  MeshReader(document, scene, rig, model).read();
}

}  // namespace fascia
