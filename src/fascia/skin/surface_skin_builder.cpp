#include <fascia/skin/surface_skin_builder.h>

#include <algorithm>
#include <numeric>

#include <fascia/base/parallel.h>
#include <fascia/geometry/atlas.h>
#include <fascia/math/points.h>
#include <fascia/skin/grid/grid_layout.h>
#include <fascia/skin/mesh/point_order.h>
#include <fascia/skin/point/attach.h>
#include <fascia/skin/point/face_samples.h>
#include <fascia/skin/point/leapfrog.h>
#include <fascia/skin/skin_fit.h>
#include <fascia/skin/surface/surface_mesh.h>

namespace fascia {
namespace {

// Share of the skin's mass that the automatic step may add to points in narrow places.
constexpr double kAddedShare = 0.02;
// Of the skin's size: how far a joint may be behind the nearest one and still have a share of a
// point.
constexpr double kJointReach = 0.08;
// Of the skin's size: what is left of a triangle's dip into the fat between places that are kept
// out of the flesh.
constexpr double kDipTolerance = 1e-3;

VectorArray normalsOf(const std::vector<TriangleMembrane::Corners>& triangles,
                      const VectorArray& points) {
  std::vector<Eigen::Vector3f> places, normals;
  for (std::size_t k = 0; k < points.size(); ++k) places.push_back(floatPointAt(points, k));
  computeNormals(places, triangles, normals);
  VectorArray out(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) setPoint(out, k, normals[k].cast<double>());
  return out;
}

Vec3 longestAxis(const Solid& solid, const Transform& world) {
  Eigen::Index axis;
  solid.bounds().size().maxCoeff(&axis);
  return world.rotation.col(axis);
}

}  // namespace

SkinParts SurfaceSkinBuilder::build() {
  // Out of its range an edge would make a mesh without end.
  if (!report_.checkValues(def_) || !checkDef() || !lay() || !checkPoints()) return {};
  setQuantities();
  setNaturalLengths(def_, base_.posedFlesh, attachment_->anchors().anchors(), restShape(),
                    (*quantities_)[SkinQuantity::tissue_rest_length]);
  applyEdits();
  makeTopology();
  makeModel();
  if (before_ && before_->shape == parts_.shape) {
    parts_.fit = before_->fit;
  } else {
    TriangleMesh surface;
    parts_.topology->surface(restShape(), surface);
    parts_.fit = std::make_shared<SkinFit>(findSkinFit(base_.posedFlesh, surface));
  }
  return std::move(parts_);
}

bool SurfaceSkinBuilder::checkDef() const {
  if (base_.flesh.solidCount() > 0) return true;
  report_.error("", "found a skin, but no solids for it to lie on", "add at least one solid");
  return false;
}

bool SurfaceSkinBuilder::checkPoints() const {
  if (!def_.points) return true;
  if (!def_.points->anchor.empty() || !def_.points->rest_position_m.empty()) {
    report_.error("/points", "found anchors or rest positions",
                  "this skin is made from its solids");
    return false;
  }
  return report_.checkPointLists(*def_.points, count(), "points of the surface");
}

SurfaceRestKey SurfaceSkinBuilder::restKey() const {
  SurfaceRestKey key;
  key.surface = *def_.surface;
  key.fat_m = def_.fat.thickness_m;
  for (std::size_t s = 0; s < base_.flesh.solidCount(); ++s) {
    const SolidId id(static_cast<std::int64_t>(s));
    const Solid& solid = base_.posedFlesh.solid(id);
    key.solids.push_back(base_.flesh.def(id).solid);
    key.joints.push_back(base_.flesh.joint(id));
    key.frames.push_back(base_.posedFlesh.frame(id));
    std::vector<double>& parameters = key.parameters.emplace_back();
    for (std::size_t i = 0; i < solid.parameterCount(); ++i)
      parameters.push_back(solid.parameter(static_cast<int>(i)));
  }
  return key;
}

// The rest shape and what its points are attached to: that of the skin before if nothing that they
// are made of has changed.
bool SurfaceSkinBuilder::lay() {
  SurfaceRestKey key = restKey();
  if (before_ && before_->surfaceRest->key == key) {
    rest_ = parts_.surfaceRest = before_->surfaceRest;
    parts_.shape = before_->shape;
    attachment_ = std::static_pointer_cast<const FleshAttachment>(before_->attachment);
    parts_.attachment = attachment_;
    return true;
  }
  const std::string edge = shortestText(surfaceEdge_m(base_.posedFlesh, key.surface));
  if (isTooFine(base_.posedFlesh, key.surface, key.fat_m)) {
    report_.error("/surface/edge_m", "found " + edge + ", which would make too many points",
                  "choose a larger one, or let the solids be as large as they are in metres");
    return false;
  }
  const TriangleMesh mesh = surfaceOfSolids(base_.posedFlesh, key.surface, key.fat_m);
  if (mesh.triangles.empty()) {
    report_.error("/surface/edge_m", "found " + edge + ", longer than all solids are thick",
                  "choose a smaller one");
    return false;
  }
  making_ = std::make_shared<SurfaceRest>();
  rest_ = parts_.surfaceRest = making_;
  making_->key = std::move(key);
  const std::vector<std::uint32_t> order = setShape(mesh);
  drape(mesh, order);
  sampleBetweenPoints();
  attach();
  making_->weights = sharesOfJoints(base_.flesh, base_.posedFlesh, base_.skeleton.jointCount(),
                                    restShape(), order.size(), kJointReach * parts_.shape->size_m);
  making_.reset();
  return true;
}

// Points that lie together are stored together. Returns the mesh's point per storage index.
std::vector<std::uint32_t> SurfaceSkinBuilder::setShape(const TriangleMesh& mesh) {
  const std::vector<std::uint32_t> order = orderInBlocks(mesh.positions);
  // Kernels read whole vectors, one beyond the last.
  const std::size_t storage =
      (order.size() + GridLayout::kPad - 1) / GridLayout::kPad * GridLayout::kPad +
      GridLayout::kPad;
  auto shape = std::make_shared<SkinShape>();
  shape->rest.resize(storage);
  Box box;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Vec3 p = mesh.positions[order[k]].cast<double>();
    setPoint(shape->rest, k, p);
    box.add(p);
  }
  shape->size_m = std::max(1e-6, box.size().norm());
  for (std::size_t k = 0; k < order.size(); k += PointBlock::kCapacity)
    shape->blocks.push_back(
        {k, static_cast<std::uint32_t>(std::min(PointBlock::kCapacity, order.size() - k))});
  parts_.shape = std::move(shape);
  return order;
}

// Triangles, and how they are drawn, by storage.
void SurfaceSkinBuilder::drape(const TriangleMesh& mesh, const std::vector<std::uint32_t>& order) {
  std::vector<std::uint32_t> storageOf(order.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    storageOf[order[k]] = static_cast<std::uint32_t>(k);
  for (const auto& t : mesh.triangles)
    making_->triangles.push_back({storageOf[t[0]], storageOf[t[1]], storageOf[t[2]]});
  // Triangles that lie together come after each other, as points do.
  const auto first = [](const TriangleMembrane::Corners& t) {
    return std::min({t[0], t[1], t[2]});
  };
  std::stable_sort(making_->triangles.begin(), making_->triangles.end(),
                   [&](const auto& a, const auto& b) { return first(a) < first(b); });
  Atlas atlas = makeAtlas(mesh);
  for (const std::uint32_t p : atlas.points) making_->drawn.points.push_back(storageOf[p]);
  making_->drawn.uvs = std::move(atlas.uvs);
  making_->drawn.triangles = std::move(atlas.triangles);
  making_->drawn.smooth = true;
}

// Where triangles dip into the fat between their corners.
void SurfaceSkinBuilder::sampleBetweenPoints() {
  auto shape = std::make_shared<SkinShape>(*parts_.shape);
  FaceSamples faces = sampleFaces(base_.posedFlesh, making_->triangles, shape->rest,
                                  def_.fat.thickness_m, kDipTolerance * shape->size_m);
  if (faces.empty()) return;
  shape->faces = std::make_shared<FaceSamples>(std::move(faces));
  parts_.shape = std::move(shape);
}

// Every point by a strand to the flesh below it, and with the matter of its nearest solid.
void SurfaceSkinBuilder::attach() {
  const std::size_t points = static_cast<std::size_t>(
      std::accumulate(parts_.shape->blocks.begin(), parts_.shape->blocks.end(), std::size_t{0},
                      [](std::size_t sum, const PointBlock& b) { return sum + b.count; }));
  std::vector<PointRun> runs;
  for (const PointBlock& b : parts_.shape->blocks) runs.push_back({b.first, b.first, b.count});
  const VectorArray normals = normalsOf(making_->triangles, restShape());
  const PosedFlesh& flesh = base_.posedFlesh;
  const std::vector<Attachment> found =
      attachAlongNormals(flesh, runs, restShape(), normals, def_.fat.thickness_m);
  const std::vector<SolidId> nearest = nearestSolids(flesh, runs, restShape());
  std::vector<TissueAnchors::Anchor> anchors(points), placements(points);
  making_->solid.resize(points);
  parallelFor(runs.size(), [&](std::size_t n) {
    for (std::size_t k = runs[n].first; k < runs[n].first + runs[n].count; ++k) {
      anchors[k] = {k, found[k].solid, flesh.materialFromWorld(found[k].solid, found[k].place_m)};
      placements[k] = {k, nearest[k], flesh.materialFromWorld(nearest[k], pointAt(restShape(), k))};
      making_->solid[k] = found[k].solid;
    }
  });
  attachment_ = std::make_shared<FleshAttachment>(TissueAnchors(std::move(anchors)),
                                                  TissueAnchors(std::move(placements)),
                                                  std::vector<FleshAttachment::Fixed>{});
  parts_.attachment = attachment_;
}

void SurfaceSkinBuilder::setQuantities() {
  for (const QuantityInfo& i : quantityInfos()) {
    FloatArray& values = (*quantities_)[i.quantity];
    values.assign(restShape().size(), static_cast<float>(uniformValue(def_, i.quantity)));
    if (!def_.points) continue;
    const std::vector<float>& saved = pointValues(*def_.points, i.quantity);
    std::copy(saved.begin(), saved.end(), values.begin());
  }
}

void SurfaceSkinBuilder::applyEdits() {
  std::vector<std::string> joints;
  for (std::size_t j = 0; j < base_.skeleton.jointCount(); ++j)
    joints.push_back(base_.skeleton.joint(JointId(static_cast<std::int64_t>(j))).name);
  std::vector<EditPoint> points;
  for (std::size_t k = 0; k < count(); ++k)
    points.push_back({k, 0, 0, rest_->solid[k], &rest_->weights[k]});
  QuantityMask all;
  all.fill(true);
  applySkinEdits(def_, base_, report_, points, {SkinKind::surface, joints}, restShape(), all,
                 *quantities_);
}

// u runs across the way of a point's solid, as around a grid.
void SurfaceSkinBuilder::makeTopology() {
  TriangleMaterial material = triangleMaterial(*quantities_, def_.material.max_stretch);
  for (const TriangleMembrane::Corners& t : rest_->triangles) {
    const SolidId solid = rest_->solid[t[0]];
    material.u.push_back(
        longestAxis(base_.posedFlesh.solid(solid), base_.posedFlesh.frame(solid)).cast<float>());
  }
  parts_.topology = std::make_shared<MeshTopology>(
      count(), TriangleMembrane(rest_->triangles, restShape(), material), rest_->drawn);
}

void SurfaceSkinBuilder::makeModel() {
  const TriangleMembrane& membrane = static_cast<const MeshTopology&>(*parts_.topology).membrane();
  parts_.contactResponse = {def_.material.friction_per_s, def_.material.restitution};
  std::vector<std::size_t> points(count());
  std::iota(points.begin(), points.end(), 0u);
  const double size_m = parts_.shape->size_m;
  auto model = std::make_shared<PointModel>(
      makePointModel({*quantities_,
                      membrane.pointAreas(),
                      membrane.stiffnessBound(),
                      1e-6 * size_m * size_m / static_cast<double>(count()),
                      points,
                      {},
                      points}));
  model->carry = static_cast<float>(def_.tissue.carry);
  parts_.defaultStep_s = longestStep(*model, kAddedShare);
  parts_.points = std::move(model);
  parts_.quantities = quantities_;
  if (def_.contact.self)
    parts_.selfContact = std::make_shared<SelfContactModel>(
        prepareSelfContact(rest_->triangles, restShape(), parts_.shape->blocks,
                           static_cast<float>(def_.contact.gap_m)));
  if (def_.fat.bulk_Pa > 0) layFat();
}

// The fat's volume is measured between the skin and its strands' inner ends at rest.
void SurfaceSkinBuilder::layFat() {
  VectorArray anchors = restShape(), scratch;
  attachment_->anchors().place(base_.posedFlesh, scratch, anchors);
  FatPressureModel model =
      prepareFatPressure({def_.fat.bulk_Pa, rest_->triangles, restShape(), anchors,
                          (*quantities_)[SkinQuantity::fat], rest_->solid, *parts_.points, true});
  if (!model.layers.empty())
    parts_.fatPressure = std::make_shared<FatPressureModel>(std::move(model));
}

}  // namespace fascia
