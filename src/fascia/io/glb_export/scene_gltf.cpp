#include <fascia/io/glb_export/scene_gltf.h>

#include <algorithm>
#include <cmath>

#include <fascia/io/file/file.h>
#include <fascia/io/glb_export/character_gltf.h>
#include <fascia/io/glb_export/gltf_skin.h>
#include <fascia/io/glb_export/gltf_tracks.h>
#include <fascia/io/gltf/gltf_animation.h>
#include <fascia/math/nearest_rotation.h>
#include <fascia/skeleton/euler.h>

namespace fascia {
namespace {

constexpr float kUnseen_m = 1e-6f;  // morph targets that move nothing farther are left out

// A body's motion taken apart: its rigid part, and for every frame the coordinates of what is left,
//     x = Q (A p(X)) + t,   A = Qᵀ (R − t eᵀ),   eᵀ p = 1.
struct BodyMotion {
  PlaceTrack place;
  std::vector<Eigen::MatrixXd> shapes;  // A, dimension × k
};

BodyMotion motionOf(const BodyShape& shape, BodyId id, const BodyModel& model,
                    const StageRecording& recording) {
  const int d = shape.dimension();
  // Coefficients of the constant function 1: s is orthonormal over the mass.
  const auto k = static_cast<std::size_t>(shape.shapeCount());
  std::vector<double> ones(static_cast<std::size_t>(d) * k);
  for (std::size_t j = 0; j < k; ++j)
    ones[j * static_cast<std::size_t>(d)] = shape.momentumWeights()[static_cast<Eigen::Index>(j)];
  const Eigen::RowVectorXd one = shape.shapeMatrix(ones).row(0);
  BodyMotion out;
  for (const StageRecording::Frame& frame : recording.frames) {
    const std::span<const double> q = model.part(id, std::span<const double>(frame.bodies));
    const Mat3 turn = nearestRotation(shape.deformationGradient(q, shape.center_m()));
    const Vec3 shift = shape.point(q, shape.center_m()) - turn * shape.center_m();
    out.place.add({turn, shift});
    out.shapes.emplace_back(turn.topLeftCorner(d, d).transpose() *
                            (shape.shapeMatrix(q) - shift.head(d) * one));
  }
  return out;
}

class SceneWriter {
 public:
  SceneWriter(const Stage& stage, const StageRecording& recording, const std::string& path)
      : stage_(stage), recording_(recording), glb_(path) {
    for (const StageRecording::Frame& frame : recording.frames)
      times_.push_back(static_cast<float>(frame.time_s - recording.frames.front().time_s));
  }

  std::string bytes() {
    for (std::size_t b = 0; b < stage_.bodies().bodyCount(); ++b) addBody(BodyId(b));
    for (std::size_t i = 0; i < stage_.def().props.size(); ++i) addProp(i);
    for (std::size_t i = 0; i < recording_.characters.size(); ++i) addActor(i);
    return finishGlb(stage_.def().name, roots_, {std::move(animation_)}, glb_);
  }

 private:
  void addBody(BodyId id) {
    const BodyShape& shape = stage_.bodies().shape(id);
    const SceneBodyDef& def = stage_.body(id);
    const BodyMotion motion = motionOf(shape, id, stage_.bodies(), recording_);
    const int node = glb_.add("nodes", placeNode(def.name, motion.place));
    roots_.push_back(node);
    // Morph targets are added to just this place: a looser track would show in every vertex.
    addTracks(times_, motion.place, node, glb_, animation_,
              {kUnseen_m, kUnseen_m / std::max(1.0f, static_cast<float>(shape.size_m()))});
    addMorphs(shape, motion, stage_.look(id), def.color, def.name, node);
    // A node has one mesh: ornaments are its children.
    for (std::size_t i = 0; i < def.ornaments.size(); ++i) {
      const std::string name = def.ornaments[i].name.empty()
                                   ? def.name + " ornament " + std::to_string(i)
                                   : def.ornaments[i].name;
      const int child = glb_.add("nodes", Json::Object{{"name", name}});
      ensureList(glb_.document.item("nodes", node), "children").list().push_back(child);
      addMorphs(shape, motion, stage_.ornaments(id)[i], def.ornaments[i].color, name, child);
    }
  }

  // The mesh with a morph target for each coordinate that changes. Weights run from 0 to 1: some
  // programs clamp others. The base is the shape with all coordinates at their least.
  void addMorphs(const BodyShape& shape, const BodyMotion& motion, const TriangleMesh& undeformed,
                 const Color& color, const std::string& name, int node) {
    TriangleMesh mesh = undeformed;
    if (mesh.normals.size() != mesh.positions.size())
      computeNormals(mesh.positions, mesh.triangles, mesh.normals);
    std::vector<Coordinate> coordinates = changing(shape, motion, mesh);
    deform(shape, motion, mesh);
    for (Coordinate& c : coordinates) toBase(c, mesh);
    normalize(mesh.normals, coordinates);
    Json primitive = addPrimitive(mesh, material(color), glb_);
    MorphTargets targets;
    for (const Coordinate& c : coordinates) {
      const auto vertices = GltfBuilder::Target::vertices;
      const int positions = glb_.addVectors(c.moved, true, vertices);
      std::string coordinate(1, "xyz"[c.row]);
      targets.add(morphTarget(positions, glb_.addVectors(c.turned, false, vertices)),
                  coordinate += std::to_string(c.function), c.weights.front());
    }
    if (!coordinates.empty() && times_.size() > 1) animateWeights(coordinates, node);
    const int index = addMesh(name, std::move(primitive), std::move(targets), glb_);
    glb_.document.item("nodes", node).set("mesh", index);
  }

  // One entry of A over time, and what it moves by its whole range.
  struct Coordinate {
    int row, function;
    double least, range;
    float atRest;                                // the weight that the undeformed body has
    std::vector<float> weights;                  // per frame, in [0, 1]
    std::vector<Eigen::Vector3f> moved, turned;  // positions, normals
  };

  void animateWeights(const std::vector<Coordinate>& coordinates, int node) {
    std::vector<float> weights;
    for (std::size_t f = 0; f < times_.size(); ++f)
      for (const Coordinate& c : coordinates) weights.push_back(c.weights[f]);
    const int input = glb_.addTimes(times_);
    addGltfTrack(animation_, input, glb_.addScalars(weights, false), node, "weights");
  }

  static std::vector<Coordinate> changing(const BodyShape& shape, const BodyMotion& motion,
                                          const TriangleMesh& mesh) {
    std::vector<Coordinate> out;
    const std::size_t count = mesh.positions.size();
    Eigen::MatrixXd values(shape.shapeCount(), count);
    std::vector<Eigen::MatrixXd> gradients(count, Eigen::MatrixXd(shape.shapeCount(), 3));
    for (std::size_t v = 0; v < count; ++v) {
      const Vec3 X = mesh.positions[v].cast<double>();
      shape.basis().values(X, values.col(static_cast<Eigen::Index>(v)));
      shape.basis().gradients(X, gradients[v]);
    }
    std::vector<double> q(static_cast<std::size_t>(shape.coordinateCount()));
    shape.setRest({}, q);
    const Eigen::MatrixXd rest = shape.shapeMatrix(q);
    for (int j = 0; j < shape.shapeCount(); ++j) {
      for (int row = 0; row < shape.dimension(); ++row) {
        double least = motion.shapes.front()(row, j), most = least;
        for (const Eigen::MatrixXd& A : motion.shapes)
          least = std::min(least, A(row, j)), most = std::max(most, A(row, j));
        const double range = most - least;
        if (!(range * values.row(j).cwiseAbs().maxCoeff() > static_cast<double>(kUnseen_m)))
          continue;
        const auto atRest = static_cast<float>((rest(row, j) - least) / range);
        Coordinate c{row, j, least, range, atRest, {}, {}, {}};
        for (const Eigen::MatrixXd& A : motion.shapes)
          c.weights.push_back(static_cast<float>((A(row, j) - least) / range));
        for (std::size_t v = 0; v < count; ++v) {
          Vec3 moved = Vec3::Zero();
          moved[row] = range * values(j, static_cast<Eigen::Index>(v));
          c.moved.push_back(moved.cast<float>());
          // A displacement u = range p e_row turns a normal by −(I − n nᵀ) ∇uᵀ n at first order.
          const Vec3 n = mesh.normals[v].cast<double>();
          const Vec3 slope = -range * n[row] * gradients[v].row(j).transpose();
          c.turned.push_back((slope - n * n.dot(slope)).eval().cast<float>());
        }
        out.push_back(std::move(c));
      }
    }
    return out;
  }

  // To the first frame's shape.
  static void deform(const BodyShape& shape, const BodyMotion& motion, TriangleMesh& mesh) {
    Eigen::VectorXd values(shape.shapeCount());
    for (Eigen::Vector3f& p : mesh.positions) {
      Vec3 X = p.cast<double>();
      shape.basis().values(X, values);
      X.head(shape.dimension()) = motion.shapes.front() * values;
      p = X.cast<float>();
    }
  }

  // From the first frame's to the least of a coordinate; normals, made at rest, from there.
  static void toBase(const Coordinate& c, TriangleMesh& mesh) {
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      mesh.positions[v] -= c.weights.front() * c.moved[v];
      mesh.normals[v] -= c.atRest * c.turned[v];
    }
  }

  static void normalize(std::vector<Eigen::Vector3f>& normals,
                        std::vector<Coordinate>& coordinates) {
    for (std::size_t v = 0; v < normals.size(); ++v) {
      const float length = std::max(normals[v].norm(), 1e-6f);
      normals[v] /= length;
      for (Coordinate& c : coordinates) c.turned[v] /= length;
    }
  }

  int material(const Color& color) { return addMaterial(color, 0.45, glb_); }

  void addProp(std::size_t index) {
    const PlacedSolidDef& def = stage_.def().props[index];
    TriangleMesh mesh = stage_.prop(index).solid(SolidId(0)).tessellate(48);
    if (mesh.normals.size() != mesh.positions.size())
      computeNormals(mesh.positions, mesh.triangles, mesh.normals);
    Json primitive = addPrimitive(mesh, material(def.color), glb_);
    PlaceTrack place;
    place.add(stage_.prop(index).frame(SolidId(0)));
    Json node = placeNode(def.name, place);
    node.set("mesh", addMesh(def.name, std::move(primitive), {}, glb_));
    roots_.push_back(glb_.add("nodes", std::move(node)));
  }

  void addActor(std::size_t index) {
    const SceneCharacterDef& def = stage_.def().characters[index];
    const GltfCharacter added =
        addCharacter(*def.character, recording_.characters[index], GlbOptions{}, glb_, animation_);
    PlaceTrack place;
    place.add(placeOf(def));
    Json node = placeNode(def.name, place);
    if (!added.roots.empty()) node.set("children", numberList(added.roots));
    roots_.push_back(glb_.add("nodes", std::move(node)));
  }

  const Stage& stage_;
  const StageRecording& recording_;
  std::vector<float> times_;
  GltfBuilder glb_;
  Json animation_ = emptyAnimation("performance");
  std::vector<int> roots_;
};

}  // namespace

GlbReport writeSceneGlb(const Stage& stage, const StageRecording& recording,
                        const std::string& path) {
  if (recording.frames.empty()) throw Error("a recording without frames cannot be exported");
  const std::string bytes = SceneWriter(stage, recording, path).bytes();
  writeFileWhole(path, bytes);
  return {recording.frames.size(), bytes.size()};
}

}  // namespace fascia
