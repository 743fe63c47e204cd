#include <fascia/skin/mesh_skin_builder.h>

#include <algorithm>
#include <array>
#include <numeric>

#include <fascia/pose/softness.h>
#include <fascia/skin/grid/grid_layout.h>
#include <fascia/skin/mesh/point_order.h>

namespace fascia {
namespace {

// A mesh is as fine as its author wanted, fingers and faces finest. Steps of this length follow
// whatever one sees; points that would need shorter ones get added mass and move with their
// anchors.
constexpr double kStep_s = 1.0 / 480;
// A joint with a smaller share of a point does not press on it.
constexpr float kFeltWeight = 0.05f;
// How far a point may slide from its anchor: so much of its fat, and this share of the model's
// size.
constexpr double kSlideOfFat = 0.6, kLeastSlide = 0.0015;
// Pieces with a smaller share of the model's size are carried as they are.
constexpr double kSmallPiece = 0.04;

// Points on edges that only one triangle has: eyes, mouth, cuffs, the hem of an open sheet.
std::vector<char> borderPoints(const RiggedModel& rig) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (const auto& t : rig.triangles)
    for (std::size_t e = 0; e < 3; ++e) {
      const auto [a, b] = std::minmax(t[e], t[(e + 1) % 3]);
      edges.push_back({a, b});
    }
  std::sort(edges.begin(), edges.end());
  std::vector<char> border(rig.points_m.size(), 0);
  for (std::size_t i = 0, j; i < edges.size(); i = j) {
    for (j = i + 1; j < edges.size() && edges[j] == edges[i];) ++j;
    if (j - i == 1) border[edges[i][0]] = border[edges[i][1]] = 1;
  }
  return border;
}

// Mean length of the edges around each point; 0 without any.
std::vector<double> edgesAround(const RiggedModel& rig) {
  std::vector<double> sum(rig.points_m.size()), count(sum.size());
  for (const auto& t : rig.triangles)
    for (std::size_t e = 0; e < 3; ++e) {
      const std::uint32_t a = t[e], b = t[(e + 1) % 3];
      const double length = double{(rig.points_m[a] - rig.points_m[b]).norm()};
      for (const std::uint32_t p : {a, b}) sum[p] += length, count[p] += 1;
    }
  for (std::size_t p = 0; p < sum.size(); ++p) sum[p] /= std::max(1.0, count[p]);
  return sum;
}

}  // namespace

SkinParts MeshSkinBuilder::build() {
  report_.checkValues(def_);
  if (!checkDef() || !findJoints()) return {};
  lay();
  setQuantities();
  makeModel();
  makePoseSkin();
  parts_.shape = shape_;
  parts_.meshRest = rest_;
  parts_.quantities = quantities_;
  parts_.points = points_;
  return std::move(parts_);
}

MeshRestKey MeshSkinBuilder::restKey() const {
  MeshRestKey key;
  for (const Joint& j : joints_) {
    key.joints.push_back(j.skeletonJoint);
    key.joints_world.push_back(j.rest_world);
  }
  for (std::size_t s = 0; s < base_.flesh.solidCount(); ++s) {
    const SolidId id(static_cast<std::int64_t>(s));
    key.solids.push_back(base_.flesh.def(id).solid);
    key.solidJoints.push_back(base_.flesh.joint(id));
    key.solidFrames.push_back(base_.posedFlesh.frame(id));
    const Solid& solid = base_.posedFlesh.solid(id);
    std::vector<double>& parameters = key.solidParameters.emplace_back();
    for (std::size_t i = 0; i < solid.parameterCount(); ++i)
      parameters.push_back(solid.parameter(static_cast<int>(i)));
  }
  key.parts = def_.mesh.parts;
  key.simulated = def_.mesh.pose.simulate;
  return key;
}

// The mesh on its flesh: that of the skin before if nothing that it is made of has changed.
void MeshSkinBuilder::lay() {
  MeshRestKey key = restKey();
  const MeshRest* old = before_ ? before_->meshRest.get() : nullptr;
  if (old && old->key == key) {
    rest_ = before_->meshRest;
    shape_ = before_->shape;
    return;
  }
  making_ = std::make_shared<MeshRest>();
  rest_ = making_;
  making_->key = std::move(key);
  making_->normals = old ? old->normals : pointNormals();
  making_->edges_m = old ? old->edges_m : edgesAround(rig_);
  findFelt();
  measureFat();
  chooseFixed();
  orderPoints();
  if (old && old->order == rest_->order && old->fixed == rest_->fixed &&
      old->key.joints_world == rest_->key.joints_world)
    shape_ = before_->shape;
  else
    makeRestShape();
  making_.reset();
}

bool MeshSkinBuilder::checkDef() const {
  bool ok = true;
  if (def_.points) {
    if (!def_.points->anchor.empty() || !def_.points->rest_position_m.empty()) {
      report_.error("/points", "found anchors or rest positions",
                    "an imported mesh brings its own");
      ok = false;
    }
    ok = report_.checkPointLists(*def_.points, rig_.points_m.size(), "points of the mesh") && ok;
  }
  for (std::size_t i = 0; i < def_.mesh.parts.size(); ++i) {
    const auto named = [&](const RigPart& part) {
      return part.name == def_.mesh.parts[i].name ||
             (part.material >= 0 && rig_.materials[static_cast<std::size_t>(part.material)].name ==
                                        def_.mesh.parts[i].name);
    };
    if (std::any_of(rig_.parts.begin(), rig_.parts.end(), named)) continue;
    report_.error("/parts/" + std::to_string(i) + "/name",
                  "found no part or material named '" + def_.mesh.parts[i].name + "' in the mesh",
                  "'fascia info' lists them");
    ok = false;
  }
  return ok;
}

bool MeshSkinBuilder::findJoints() {
  bool ok = true;
  for (std::size_t j = 0; j < rig_.joints.size(); ++j) {
    const JointId id = report_.findJoint("", nameOf(j));
    ok = ok && id.valid();
    if (id.valid()) joints_.push_back({id.index(), base_.posedSkeleton.joint_world[id.index()]});
  }
  return ok;
}

// The solids that lie beneath a point: those of the joints that move it.
void MeshSkinBuilder::findFelt() {
  felt_.resize(rig_.points_m.size());
  if (base_.flesh.solidCount() == 0) return;  // all skin and bones: carried by joints alone
  std::vector<std::vector<SolidId>> ofJoint(base_.skeleton.jointCount());
  for (std::size_t s = 0; s < base_.flesh.solidCount(); ++s) {
    const SolidId solid(static_cast<std::int64_t>(s));
    ofJoint[base_.flesh.joint(solid).index()].push_back(solid);
  }
  for (std::size_t p = 0; p < felt_.size(); ++p) {
    for (std::size_t i = 0; i < PointWeights::kMost; ++i) {
      if (rig_.weights[p].weight[i] < kFeltWeight) continue;
      const std::size_t joint = joints_[rig_.weights[p].joint[i]].skeletonJoint;
      const std::vector<SolidId>& solids = ofJoint[joint];
      felt_[p].insert(felt_[p].end(), solids.begin(), solids.end());
    }
    if (felt_[p].empty()) felt_[p].push_back(nearestFlesh(base_.posedFlesh, modelPoint(p)).solid);
  }
}

// What is not simulated, if the rest is: borders, small pieces and those without flesh beneath. And
// what rules make rigid.
void MeshSkinBuilder::chooseFixed() {
  making_->fixed.assign(rig_.points_m.size(), 0);
  // Pieces that one joint carries (armour, eyes, a robot) stay hard unless a rule says otherwise.
  making_->rigid = stiffPieces({rig_.points_m, rig_.weights, rig_.triangles, rig_.joints});
  if (def_.mesh.pose.simulate) fixLoosePieces();
  for (const SkinPartDef& rule : def_.mesh.parts)
    for (const RigPart& part : rig_.parts) {
      const bool material =
          part.material >= 0 &&
          rig_.materials[static_cast<std::size_t>(part.material)].name == rule.name;
      if (part.name != rule.name && !material) continue;
      for (std::uint32_t v = 0; v < part.vertexCount; ++v) {
        const std::uint32_t point = rig_.vertices[part.firstVertex + v].point;
        making_->rigid[point] = rule.rigid ? 1 : 0;
        if (def_.mesh.pose.simulate) making_->fixed[point] = making_->rigid[point];
      }
    }
}

void MeshSkinBuilder::fixLoosePieces() {
  making_->fixed = borderPoints(rig_);
  std::vector<Box> boxes(rig_.componentCount);
  std::vector<std::size_t> points(rig_.componentCount), covered(rig_.componentCount);
  for (std::size_t p = 0; p < rig_.points_m.size(); ++p) {
    const std::uint32_t c = rig_.component[p];
    boxes[c].add(modelPoint(p));
    ++points[c];
    covered[c] += making_->covered[p] ? 1u : 0u;
  }
  const double small = kSmallPiece * rig_.size_m();
  for (std::size_t p = 0; p < making_->fixed.size(); ++p) {
    const std::uint32_t c = rig_.component[p];
    if (boxes[c].size().norm() < small || 2 * covered[c] < points[c]) making_->fixed[p] = 1;
  }
}

void MeshSkinBuilder::orderPoints() {
  making_->order.resize(rig_.points_m.size());
  std::iota(making_->order.begin(), making_->order.end(), 0u);
  const auto fixed = std::stable_partition(making_->order.begin(), making_->order.end(),
                                           [&](std::uint32_t p) { return !making_->fixed[p]; });
  making_->elasticCount = static_cast<std::size_t>(fixed - making_->order.begin());
  sortIntoBlocks(rig_.points_m, std::span(making_->order).first(making_->elasticCount));
  making_->storageOf.resize(making_->order.size());
  for (std::size_t k = 0; k < making_->order.size(); ++k)
    making_->storageOf[making_->order[k]] = static_cast<std::uint32_t>(k);
}

void MeshSkinBuilder::makeRestShape() {
  // Kernels read whole vectors, one beyond the last.
  const std::size_t storage =
      (making_->order.size() + GridLayout::kPad - 1) / GridLayout::kPad * GridLayout::kPad +
      GridLayout::kPad;
  auto shape = std::make_shared<SkinShape>();
  shape->rest.resize(storage);
  for (std::size_t k = 0; k < making_->order.size(); ++k) {
    const Eigen::Vector3f& p = rig_.points_m[making_->order[k]];
    shape->rest.x[k] = p.x(), shape->rest.y[k] = p.y(), shape->rest.z[k] = p.z();
  }
  shape->size_m = std::max(1e-6, rig_.size_m());
  for (std::size_t k = making_->elasticCount; k < making_->order.size(); ++k)
    shape->fixedPoints.push_back(k);
  shape_ = std::move(shape);
}

// How far a point's weight stretches its strand: so much higher lies the anchor.
Vec3 MeshSkinBuilder::sag(std::size_t k) const {
  const double stiffness = points_->tissueStiffness[k];
  if (!(stiffness > 0)) return Vec3::Zero();
  return points_->mass[k] / stiffness * settings_.gravity_m_per_s2;
}

TriangleMembrane MeshSkinBuilder::makeMembrane() const {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  TriangleMaterial material = triangleMaterial(*quantities_, def_.material.max_stretch);
  for (const auto& t : rig_.triangles) {
    // Triangles between fixed points move as their joints do: they pull on nothing.
    if (rest_->fixed[t[0]] && rest_->fixed[t[1]] && rest_->fixed[t[2]]) continue;
    triangles.push_back({rest_->storageOf[t[0]], rest_->storageOf[t[1]], rest_->storageOf[t[2]]});
    // u runs around the limb, as on a grid: across the way from the joint to the triangle's flesh.
    const Joint& joint = joints_[rig_.weights[t[0]].joint[0]];
    material.u.push_back(joint.rest_world.rotation.col(1).cast<float>());
  }
  return TriangleMembrane(triangles, shape_->rest, material);
}

bool MeshSkinBuilder::keepsTopology() const {
  if (!before_ || before_->shape != shape_) return false;
  const auto& old = static_cast<const MeshTopology&>(*before_->topology);
  const auto maxStretch = static_cast<float>(def_.material.max_stretch);
  if (old.membrane().cap() != maxStretch * maxStretch - 1) return false;
  using Q = SkinQuantity;
  return std::ranges::all_of(
      std::array{Q::stretch_u, Q::stretch_v, Q::shear, Q::bending, Q::prestretch},
      [&](Q q) { return (*before_->quantities)[q] == (*quantities_)[q]; });
}

// The surface's own forces, and how it is drawn.
std::shared_ptr<const MeshTopology> MeshSkinBuilder::makeTopology() const {
  if (keepsTopology()) return std::static_pointer_cast<const MeshTopology>(before_->topology);
  MeshTopology::Drawn drawn;
  for (const RigVertex& v : rig_.vertices) {
    drawn.points.push_back(rest_->storageOf[v.point]);
    drawn.uvs.push_back(v.uv);
  }
  drawn.triangles = rig_.drawnTriangles;
  return std::make_shared<MeshTopology>(rest_->order.size(), makeMembrane(), std::move(drawn));
}

void MeshSkinBuilder::makeModel() {
  const std::shared_ptr<const MeshTopology> topology = makeTopology();
  const TriangleMembrane& membrane = topology->membrane();
  parts_.topology = topology;
  parts_.contactResponse = {def_.material.friction_per_s, def_.material.restitution};
  const std::size_t count = rest_->order.size();
  std::vector<std::size_t> points(count);
  std::iota(points.begin(), points.end(), 0u);
  const std::span<const std::size_t> elastic = std::span(points).first(rest_->elasticCount);
  (*points_) = makePointModel({(*quantities_), membrane.pointAreas(), membrane.stiffnessBound(),
                               1e-6 * shape_->size_m * shape_->size_m / static_cast<double>(count),
                               points, shape_->fixedPoints, elastic});
  points_->carry = static_cast<float>(def_.tissue.carry);
  points_->slideLimit.resize(rest_->elasticCount);
  for (std::size_t k = 0; k < rest_->elasticCount; ++k) {
    const double slide =
        kSlideOfFat * double{(*quantities_)[SkinQuantity::fat][k]} + kLeastSlide * shape_->size_m;
    points_->slideLimit[k] = static_cast<float>(slide + sag(k).norm());
  }
  parts_.defaultStep_s = kStep_s;
}

// The pose function, on points in storage order. Fat that was put on or taken away is in its rest
// shape.
void MeshSkinBuilder::makePoseSkin() {
  const SkinQuantities& q = (*quantities_);
  const std::vector<Vec3>& normals = rest_->normals;
  const std::size_t count = rest_->order.size();
  std::vector<Eigen::Vector3f> rest;
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t p = rest_->order[k];
    const double fat = double{q[SkinQuantity::fat][k] - naturalFat_[k]};
    rest.push_back((modelPoint(p) + fat * normals[p]).cast<float>());
  }
  auto rigged = std::make_shared<RiggedSkin>();
  std::vector<RigJoint> joints = rig_.joints;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    joints[j].rest_world = joints_[j].rest_world;
    rigged->joints.push_back({joints_[j].skeletonJoint, joints_[j].rest_world.inverse()});
  }
  rigged->skin = evaluator(rest, joints);
  rigged->fleshSolids = base_.flesh.solidCount();
  parts_.simulated = def_.mesh.pose.simulate;
  VectorArray skin = shape_->rest, anchors = shape_->rest;
  VectorArray sags(shape_->rest.size());
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3 s = k < rest_->elasticCount ? sag(k) : Vec3::Zero();
    sags.x[k] = static_cast<float>(s.x());
    sags.y[k] = static_cast<float>(s.y());
    sags.z[k] = static_cast<float>(s.z());
    skin.x[k] = rest[k].x(), skin.y[k] = rest[k].y(), skin.z[k] = rest[k].z();
    anchors.x[k] = skin.x[k] - sags.x[k];
    anchors.y[k] = skin.y[k] - sags.y[k];
    anchors.z[k] = skin.z[k] - sags.z[k];
  }
  rigged->soft =
      SoftRide(base_.flesh, base_.posedFlesh, base_.posedSkeleton.joint_world, skin, count);
  parts_.attachment =
      std::make_shared<MeshAttachment>(rigged, std::move(sags), count, shape_->fixedPoints);
  parts_.rigged = std::move(rigged);
  if (def_.fat.bulk_Pa > 0 && def_.mesh.pose.simulate) layFat(skin, anchors);
}

// With what the skin before has prepared, if only dials have changed.
std::shared_ptr<const PoseSkin> MeshSkinBuilder::evaluator(
    const std::vector<Eigen::Vector3f>& rest, const std::vector<RigJoint>& joints) const {
  const std::size_t count = rest.size();
  std::vector<PointWeights> weights;
  PoseDials dials;
  for (const std::uint32_t p : rest_->order) {
    weights.push_back(rig_.weights[p]);
    dials.rigid.push_back(rest_->rigid[p]);
  }
  const auto listOf = [&](SkinQuantity quantity) {
    const FloatArray& values = (*quantities_)[quantity];
    return std::vector<float>(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count));
  };
  dials.jiggle = listOf(SkinQuantity::jiggle);
  dials.muscle = listOf(SkinQuantity::muscle);
  dials.volume = listOf(SkinQuantity::volume);
  dials.tightness = listOf(SkinQuantity::tightness);
  const std::vector<TriangleMembrane::Corners> triangles = storedTriangles();
  const std::vector<RigMorph> morphs = storedMorphs();
  const PoseSource source{rest, weights, triangles, joints, morphs};
  if (!before_) return std::make_shared<PoseSkin>(source, dials);
  const PoseSkin& old = *before_->rigged->skin;
  const MeshRest& laid = *before_->meshRest;
  const bool keeps = laid.order == rest_->order && laid.rigid == rest_->rigid &&
                     laid.key.joints_world == rest_->key.joints_world && old.mesh().rest == rest;
  if (!keeps) return std::make_shared<PoseSkin>(source, dials);
  if (old.has(dials)) return before_->rigged->skin;
  return std::make_shared<PoseSkin>(old, source, dials);
}

std::vector<TriangleMembrane::Corners> MeshSkinBuilder::storedTriangles() const {
  std::vector<TriangleMembrane::Corners> triangles;
  for (const auto& t : rig_.triangles)
    triangles.push_back({rest_->storageOf[t[0]], rest_->storageOf[t[1]], rest_->storageOf[t[2]]});
  return triangles;
}

std::vector<RigMorph> MeshSkinBuilder::storedMorphs() const {
  std::vector<RigMorph> morphs = rig_.morphs;
  for (RigMorph& morph : morphs)
    for (std::uint32_t& point : morph.points) point = rest_->storageOf[point];
  return morphs;
}

// The fat's volume is measured between where the rest posture puts the skin and its anchors.
void MeshSkinBuilder::layFat(const VectorArray& skin, const VectorArray& anchors) {
  std::vector<SolidId> solid;
  for (const std::uint32_t p : rest_->order)
    solid.push_back(rest_->covered[p] ? rest_->solid[p] : SolidId());
  FatPressureModel model =
      prepareFatPressure({def_.fat.bulk_Pa, storedTriangles(), skin, anchors,
                          (*quantities_)[SkinQuantity::fat], solid, *points_, false});
  if (!model.layers.empty())
    parts_.fatPressure = std::make_shared<FatPressureModel>(std::move(model));
}

}  // namespace fascia
