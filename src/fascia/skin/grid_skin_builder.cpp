#include <fascia/skin/grid_skin_builder.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include <fascia/base/parallel.h>
#include <fascia/math/points.h>
#include <fascia/skin/cloth/cloth_choice.h>
#include <fascia/skin/contact/face_lift.h>
#include <fascia/skin/grid/grid_kernels.h>
#include <fascia/skin/grid/resample.h>
#include <fascia/skin/point/attach.h>
#include <fascia/skin/point/face_samples.h>
#include <fascia/skin/point/leapfrog.h>
#include <fascia/skin/point/nearest_solids.h>
#include <fascia/skin/skin_fit.h>

namespace fascia {
namespace {

constexpr int kMinSide = static_cast<int>(kGridSide.range.min);
// Share of the skin's mass that the automatic step may add to points whose cells are much smaller
// than the rest (the rings at the ends): below this no one sees a difference.
constexpr double kAddedMassShare = 0.02;
// Radius of an end ring that the file leaves open, over the distance of the ends. The same at every
// resolution: a membrane held at a mere point would stretch without bound there.
constexpr double kEndRadius = 0.022;
// A skin whose waves need shorter steps than this rides on a coarse one with about so many points.
constexpr double kFinestStep_s = 0.4e-3;
constexpr std::size_t kCoarsePoints = 1200;
// How deep a face may cut the flesh between its samples, as a share of the skin's size.
constexpr double kFaceTolerance = 1e-3;

template <class Visit>
void forEachPoint(const GridLayout& g, const Visit& visit) {
  for (int j = 0; j < g.rows; ++j)
    for (int i = 0; i < g.columns; ++i) visit(i, j, g.at(i, j));
}

// Rows in pieces that lie together.
std::vector<PointRun> runsOf(const GridLayout& g) {
  std::vector<PointRun> runs;
  const auto columns = static_cast<std::size_t>(g.columns);
  for (int j = 0; j < g.rows; ++j)
    for (std::size_t i = 0; i < columns; i += NearestSolids::kBlock)
      runs.push_back({g.row(j) + i, static_cast<std::size_t>(j) * columns + i,
                      std::min(NearestSolids::kBlock, columns - i)});
  return runs;
}

std::vector<std::array<std::uint32_t, 3>> cellTriangles(const GridLayout& g) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(g.at(g.wrapped(i), j)); };
  for (int j = 0; j + 1 < g.rows; ++j)
    for (int i = 0; i < g.columns; ++i) {
      triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return triangles;
}

// With a fan over each of its ends. Vertices are storage indices, and the two centres.
TriangleMesh closedTube(const GridLayout& g, const VectorArray& r) {
  TriangleMesh mesh;
  for (std::size_t k = 0; k < r.size(); ++k) mesh.positions.push_back(floatPointAt(r, k));
  mesh.triangles = cellTriangles(g);
  for (const int row : {0, g.rows - 1}) {
    Vec3 center = Vec3::Zero();
    for (int i = 0; i < g.columns; ++i) center += pointAt(r, g.at(i, row)) / g.columns;
    const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(center.cast<float>());
    for (int i = 0; i < g.columns; ++i) {
      const auto a = static_cast<std::uint32_t>(g.at(i, row)),
                 b = static_cast<std::uint32_t>(g.at(g.wrapped(i + 1), row));
      mesh.triangles.push_back(row == 0 ? std::array{middle, b, a} : std::array{middle, a, b});
    }
  }
  return mesh;
}

}  // namespace

SkinParts GridSkinBuilder::build() {
  report_.checkValues(def_);
  if (!checkGrid()) return {};
  layout_ = {def_.grid.columns, def_.grid.rows, true};
  if (!checkPoints() || !findJoints() || !layAround()) return {};
  findSource();
  setQuantities();
  setNaturalLengths();
  applyEdits();
  makeModel();
  chooseScheme();
  // Without strands nothing draws the two grids together again when they drift apart.
  if (settings_.integrator == "auto" && def_.tissue.stiffness_N_per_m3 > 0 &&
      parts_.defaultStep_s < kFinestStep_s && layout_.pointCount() >= 2 * kCoarsePoints)
    makeCoarse();
  // While a rest shape follows edits, what it was wrapped around stays inside.
  parts_.fit = parts_.gridRest->wrap->fit;
  return std::move(parts_);
}

bool GridSkinBuilder::checkGrid() const {
  const bool columns = report_.checkSide("/grid/0", def_.grid.columns);
  const bool rows = report_.checkSide("/grid/1", def_.grid.rows);
  return columns && rows;
}

// A saved skin brings all or nothing of its rest shape, and lists of the right length.
bool GridSkinBuilder::checkPoints() const {
  if (!def_.points) return true;
  const SkinPointsDef& p = *def_.points;
  const bool columns = report_.checkSide("/points/columns", p.columns);
  if (!report_.checkSide("/points/rows", p.rows) || !columns) return false;
  const std::size_t count = static_cast<std::size_t>(p.columns) * static_cast<std::size_t>(p.rows);
  bool ok = report_.checkPointLists(p, count, "columns x rows");
  const auto check = [&](std::size_t size, const char* name) {
    if (size == 0 || size == count) return;
    report_.error(std::string("/points/") + name, "found " + std::to_string(size) +
                                                      " values, expected " + std::to_string(count) +
                                                      " (columns x rows) or none");
    ok = false;
  };
  check(p.anchor_solid.size(), "anchor_solid");
  check(p.anchor.size(), "anchor");
  check(p.rest_position_m.size(), "rest_position_m");
  if (p.anchor.size() != p.anchor_solid.size()) {
    report_.error("/points/anchor", "found anchors without their solids",
                  "give both lists or none");
    ok = false;
  }
  const auto finite = [](const std::array<float, 3>& v) {
    return std::all_of(v.begin(), v.end(), [](float c) { return std::abs(c) < 1e6f; });
  };
  if (!std::all_of(p.rest_position_m.begin(), p.rest_position_m.end(), finite) ||
      !std::all_of(p.anchor.begin(), p.anchor.end(), finite)) {
    report_.error("/points", "found a coordinate beyond 1e6", "metres are meant");
    ok = false;
  }
  for (const int s : p.anchor_solid) {
    if (s >= -1 && s < static_cast<int>(base_.flesh.solidCount())) continue;
    report_.error("/points/anchor_solid", "found solid number " + std::to_string(s) +
                                              ", there are " +
                                              std::to_string(base_.flesh.solidCount()));
    return false;
  }
  return ok;
}

bool GridSkinBuilder::findJoints() {
  if (base_.flesh.solidCount() == 0) {
    report_.error("", "found a skin, but no solids for it to lie on", "add at least one solid");
    return false;
  }
  joint_[0] = report_.findJoint("/bottom/joint", def_.grid.bottom.joint);
  joint_[1] = report_.findJoint("/top/joint", def_.grid.top.joint);
  return joint_[0].valid() && joint_[1].valid();
}

bool GridSkinBuilder::findEnds(EndRing (&rings)[2]) const {
  const SkinEndDef* ends[2] = {&def_.grid.bottom, &def_.grid.top};
  Vec3 origin[2];
  for (int e = 0; e < 2; ++e) origin[e] = jointFrame(e).point(ends[e]->position_m);
  for (int e = 0; e < 2; ++e) {
    Vec3 axis = ends[e]->axis.norm() > 0 ? jointFrame(e).vector(ends[e]->axis)
                                         : Vec3(origin[e] - origin[1 - e]);
    if (!(axis.norm() > 1e-9)) axis = e == 0 ? Vec3(-Vec3::UnitY()) : Vec3(Vec3::UnitY());
    rings[e].axis = axis.normalized();
    rings[e].center_m = exitPoint(base_.posedFlesh, origin[e], rings[e].axis, def_.fat.thickness_m);
  }
  const double length = (rings[1].center_m - rings[0].center_m).norm();
  for (int e = 0; e < 2; ++e) {
    rings[e].radius_m = ends[e]->radius_m > 0 ? ends[e]->radius_m : kEndRadius * length;
    if (rings[e].radius_m > 1e-6) continue;
    report_.error(e == 0 ? "/bottom" : "/top", "found both ends of the skin in the same place",
                  "fix the ends to different joints, or give them different axes");
    return false;
  }
  return true;
}

GridRestKey GridSkinBuilder::restKey() const {
  GridRestKey key;
  for (std::size_t s = 0; s < base_.flesh.solidCount(); ++s) {
    const SolidId id(static_cast<std::int64_t>(s));
    const Solid& solid = base_.posedFlesh.solid(id);
    key.frames.push_back(base_.posedFlesh.frame(id));
    std::vector<double>& parameters = key.parameters.emplace_back();
    for (std::size_t i = 0; i < solid.parameterCount(); ++i)
      parameters.push_back(solid.parameter(static_cast<int>(i)));
  }
  key.endJoints = {jointFrame(0), jointFrame(1)};
  key.fat_m = def_.fat.thickness_m;
  key.anchors = def_.grid.anchors;
  return key;
}

// The rest shape and what its points are attached to: taken over, following the wrap of the skin
// before, or wrapped anew.
bool GridSkinBuilder::layAround() {
  const GridRest* old = before_ ? before_->gridRest.get() : nullptr;
  const GridWrapKey wrapKey = GridWrapKey::of(def_, joint_[0], joint_[1]);
  const bool keeps =
      old && old->wrap->key == wrapKey && sameStructure(old->wrap->flesh, base_.flesh);
  GridRestKey key = restKey();
  if (keeps && old->key == key) {
    takeOverRest();
    return true;
  }
  EndRing ends[2];
  if (!findEnds(ends)) return false;
  const std::shared_ptr<const GridWrap> wrap = keeps ? old->wrap : wrapAnew(wrapKey, ends);
  const FollowInput input{base_.flesh, base_.posedFlesh, {ends[0], ends[1]}, def_.fat.thickness_m};
  setRest(wrap, std::move(key),
          keeps ? follow(*wrap, input) : FollowedGrid{wrap->rest, wrap->anchors, wrap->placements});
  return true;
}

void GridSkinBuilder::takeOverRest() {
  parts_.shape = before_->shape;
  parts_.gridRest = before_->gridRest;
  parts_.attachment = before_->attachment;
  attachment_ = before_->grid->attachment;
}

std::shared_ptr<const GridWrap> GridSkinBuilder::wrapAnew(const GridWrapKey& key,
                                                          const EndRing (&ends)[2]) const {
  auto wrap = std::make_shared<GridWrap>();
  wrap->key = key;
  wrap->layout = layout_;
  wrap->fat_m = def_.fat.thickness_m;
  std::copy(ends, ends + 2, wrap->ends);
  wrap->flesh = base_.flesh;
  wrap->posedFlesh = base_.posedFlesh;
  if (isSaved())
    wrap->rest = savedShape(), wrap->fit = fitOf(wrap->rest);
  else
    wrapFlesh(ends, *wrap);
  FaceSamples faces = sampleFaces(wrap->posedFlesh, cellTriangles(layout_), wrap->rest, wrap->fat_m,
                                  kFaceTolerance * sizeOf(wrap->rest));
  if (!faces.empty()) {
    if (!isSaved()) liftRest(faces, *wrap);
    wrap->faces = std::make_shared<FaceSamples>(std::move(faces));
  }
  placePoints(*wrap);
  attach(*wrap);
  return wrap;
}

// Faces that are lifted whenever they are shown are no longer then than at rest.
void GridSkinBuilder::liftRest(const FaceSamples& faces, GridWrap& wrap) const {
  PointModel points;
  points.fat.assign(layout_.storage(), static_cast<float>(wrap.fat_m));
  points.free.assign(layout_.storage(), 0.f);
  forEachPoint(layout_, [&](int, int j, std::size_t k) {
    if (j > 0 && j + 1 < layout_.rows) points.free[k] = 1;
  });
  liftFaces(faces, wrap.posedFlesh, points, static_cast<float>(kFaceClearance * sizeOf(wrap.rest)),
            wrap.rest);
  fillPads(layout_, wrap.rest);
}

bool GridSkinBuilder::isSaved() const {
  return def_.points && !def_.points->rest_position_m.empty();
}

// A straight tube, or one along the way through the flesh where that holds more of it.
void GridSkinBuilder::wrapFlesh(const EndRing (&ends)[2], GridWrap& wrap) const {
  const WrapOptions options{def_.fat.thickness_m, def_.grid.cling};
  const auto faults = [](const SkinFit& fit) {
    return std::pair(fit.outside.size(), fit.crossings);
  };
  wrap.rest = shrinkWrap(base_.posedFlesh, layout_, ends[0], ends[1], options);
  wrap.fit = fitOf(wrap.rest);
  if (faults(*wrap.fit) == std::pair<std::size_t, std::size_t>(0, 0)) return;
  VectorArray along = wrapAlongFlesh(base_.posedFlesh, layout_, ends[0], ends[1], options);
  std::shared_ptr<const SkinFit> fit = fitOf(along);
  if (!(faults(*fit) < faults(*wrap.fit))) return;
  wrap.rest = std::move(along);
  wrap.fit = std::move(fit);
}

std::shared_ptr<const SkinFit> GridSkinBuilder::fitOf(const VectorArray& tube) const {
  return std::make_shared<SkinFit>(findSkinFit(base_.posedFlesh, closedTube(layout_, tube)));
}

VectorArray GridSkinBuilder::savedShape() const {
  const GridLayout saved = savedLayout();
  VectorArray r(saved.storage());
  std::size_t p = 0;
  forEachPoint(saved, [&](int, int, std::size_t k) {
    const auto& v = def_.points->rest_position_m[p++];
    r.x[k] = v[0], r.y[k] = v[1], r.z[k] = v[2];
  });
  fillPads(saved, r);
  return sameGrid() ? r : resample(saved, r, layout_);
}

void GridSkinBuilder::placePoints(GridWrap& wrap) const {
  const std::vector<SolidId> solids = nearestSolids(wrap.posedFlesh, runsOf(layout_), wrap.rest);
  wrap.placements.resize(solids.size());
  const auto columns = static_cast<std::size_t>(layout_.columns);
  parallelFor(solids.size() / columns, [&](std::size_t row) {
    for (std::size_t i = 0; i < columns; ++i) {
      const std::size_t p = row * columns + i, k = layout_.row(static_cast<int>(row)) + i;
      const Vec3 material = wrap.posedFlesh.materialFromWorld(solids[p], pointAt(wrap.rest, k));
      wrap.placements[p] = {k, solids[p], material};
    }
  });
  wrap.placed = VectorArray(layout_.storage());
  VectorArray scratch;
  TissueAnchors(wrap.placements).place(wrap.posedFlesh, scratch, wrap.placed);
}

// The strands of all inner points, row by row.
void GridSkinBuilder::attach(GridWrap& wrap) const {
  const bool saved = def_.points && !def_.points->anchor.empty() && sameGrid();
  std::vector<Attachment> found;
  if (!saved) {
    VectorArray normals(layout_.storage());
    gridNormals(layout_, wrap.rest, 0, layout_.rows, normals);
    found = attachAlongNormals(wrap.posedFlesh, runsOf(layout_), wrap.rest, normals, wrap.fat_m);
  }
  const auto columns = static_cast<std::size_t>(layout_.columns);
  const auto inner = static_cast<std::size_t>(layout_.rows - 2);
  wrap.anchors.resize(columns * inner);
  parallelFor(inner, [&](std::size_t row) {
    for (std::size_t i = 0; i < columns; ++i) {
      const std::size_t p = (row + 1) * columns + i;
      TissueAnchors::Anchor& anchor = wrap.anchors[row * columns + i];
      anchor.point = layout_.row(static_cast<int>(row) + 1) + i;
      if (saved) {
        anchor.solid = SolidId(def_.points->anchor_solid[p]);
        const auto& m = def_.points->anchor[p];
        anchor.material = Vec3(m[0], m[1], m[2]);
      } else {
        anchor.solid = found[p].solid;
        anchor.material = wrap.posedFlesh.materialFromWorld(anchor.solid, found[p].place_m);
      }
    }
  });
}

void GridSkinBuilder::setRest(std::shared_ptr<const GridWrap> wrap, GridRestKey key,
                              FollowedGrid followed) {
  auto shape = std::make_shared<SkinShape>();
  shape->rest = std::move(followed.rest);
  shape->faces = wrap->faces;
  shape->size_m = size_m_ > 0 ? size_m_ : sizeOf(shape->rest);
  for (int j = 1; j + 1 < layout_.rows; ++j)
    for (int i = 0; i < layout_.columns; i += static_cast<int>(PointBlock::kCapacity))
      shape->blocks.push_back(
          {layout_.at(i, j),
           std::min<std::uint32_t>(PointBlock::kCapacity,
                                   static_cast<std::uint32_t>(layout_.columns - i))});
  std::vector<FleshAttachment::Fixed> fixed = fixEnds(*shape);

  overrideAnchors(followed.anchors);
  std::erase_if(followed.anchors, [](const TissueAnchors::Anchor& a) { return !a.solid.valid(); });
  attachment_ = std::make_shared<FleshAttachment>(TissueAnchors(std::move(followed.anchors)),
                                                  TissueAnchors(std::move(followed.placements)),
                                                  std::move(fixed));
  parts_.attachment = attachment_;
  parts_.gridRest = std::make_shared<GridRest>(
      GridRest{std::move(wrap), std::move(key), pointAreas(layout_, shape->rest)});
  parts_.shape = std::move(shape);
}

double GridSkinBuilder::sizeOf(const VectorArray& rest) const {
  Box box;
  forEachPoint(layout_, [&](int, int, std::size_t k) { box.add(pointAt(rest, k)); });
  return std::max(1e-6, box.size().norm());
}

std::vector<FleshAttachment::Fixed> GridSkinBuilder::fixEnds(SkinShape& shape) const {
  std::vector<FleshAttachment::Fixed> fixed;
  for (int e = 0; e < 2; ++e) {
    const Transform inverse = jointFrame(e).inverse();
    for (int i = 0; i < layout_.columns; ++i) {
      const std::size_t k = layout_.at(i, e == 0 ? 0 : layout_.rows - 1);
      shape.fixedPoints.push_back(k);
      fixed.push_back({k, joint_[e], inverse.point(pointAt(shape.rest, k))});
    }
  }
  return fixed;
}

// Strands that were moved by hand; `anchors` are those of all inner points, row by row.
void GridSkinBuilder::overrideAnchors(std::vector<TissueAnchors::Anchor>& anchors) const {
  for (const SkinAnchorDef& a : def_.grid.anchors) {
    const int column =
        layout_.wrapped(static_cast<int>(std::lround(a.u * layout_.columns)) % layout_.columns);
    const int row = static_cast<int>(std::lround(a.v * (layout_.rows - 1)));
    const SolidId solid = base_.flesh.find(a.solid);
    // What is not found is reported by applyEdits.
    if (column < 0 || row < 1 || row + 1 >= layout_.rows || !solid.valid()) continue;
    const Vec3 world = base_.posedFlesh.frame(solid).point(a.position_m);
    const float x = static_cast<float>(world.x()), y = static_cast<float>(world.y()),
                z = static_cast<float>(world.z());
    float d, nx, ny, nz;
    base_.posedFlesh.evaluate(solid, {&x, &y, &z, 1}, &d, {&nx, &ny, &nz, 1});
    TissueAnchors::Anchor& anchor =
        anchors[static_cast<std::size_t>((row - 1) * layout_.columns + column)];
    anchor.solid = solid;
    anchor.material =
        base_.posedFlesh.materialFromWorld(solid, world - double{d} * Vec3(nx, ny, nz));
  }
}

void GridSkinBuilder::findSource() {
  auto source = std::make_shared<GridQuantitySource>();
  source->def = def_;
  for (const SkinBrushDef& brush : def_.brushes)
    source->brushCenters_m.push_back(brushCenter(brush, base_).value_or(Vec3::Zero()));
  parts_.gridQuantitySource = std::move(source);
  const GridQuantitySource* old = before_ ? before_->gridQuantitySource.get() : nullptr;
  const bool alike = old && before_->shape == parts_.shape &&
                     before_->attachment == parts_.attachment &&
                     old->editsAlike(*parts_.gridQuantitySource);
  for (const QuantityInfo& i : quantityInfos())
    changes_[static_cast<std::size_t>(i.quantity)] = !alike || !keepsQuantity(i.quantity);
}

// Whether the definition gives all points the value that it gave them.
bool GridSkinBuilder::keepsQuantity(SkinQuantity quantity) const {
  const SkinDef& old = before_->gridQuantitySource->def;
  if (quantity == SkinQuantity::tissue_rest_length &&
      old.tissue.rest_length_m != def_.tissue.rest_length_m)
    return false;
  return uniformValue(old, quantity) == uniformValue(def_, quantity);
}

void GridSkinBuilder::setQuantities() {
  const GridLayout& g = layout_;
  for (const QuantityInfo& i : quantityInfos()) {
    FloatArray& values = (*quantities_)[i.quantity];
    if (!changes_[static_cast<std::size_t>(i.quantity)]) {
      values = (*before_->quantities)[i.quantity];
      continue;
    }
    values.assign(g.storage(), static_cast<float>(uniformValue(def_, i.quantity)));
    if (!def_.points || pointValues(*def_.points, i.quantity).empty()) continue;
    const std::vector<float>& saved = pointValues(*def_.points, i.quantity);
    FloatArray stored(savedLayout().storage());
    std::size_t p = 0;
    forEachPoint(savedLayout(), [&](int, int, std::size_t k) { stored[k] = saved[p++]; });
    values = sameGrid() ? stored : resample(savedLayout(), stored, g);
  }
}

// Where nobody says otherwise a strand is as long at rest as in the rest posture.
void GridSkinBuilder::setNaturalLengths() {
  if (!changes_[static_cast<std::size_t>(SkinQuantity::tissue_rest_length)]) return;
  if (def_.tissue.rest_length_m || (def_.points && !def_.points->tissue_rest_length.empty()))
    return;
  FloatArray& restLength = (*quantities_)[SkinQuantity::tissue_rest_length];
  const std::vector<TissueAnchors::Anchor>& anchors = attachment_->anchors().anchors();
  parallelFor(anchors.size(), [&](std::size_t n) {
    const TissueAnchors::Anchor& a = anchors[n];
    const Vec3 inner = base_.posedFlesh.worldFromMaterial(a.solid, a.material);
    restLength[a.point] = static_cast<float>((pointAt(rest(), a.point) - inner).norm());
  });
}

void GridSkinBuilder::applyEdits() {
  for (std::size_t n = 0; n < def_.grid.anchors.size(); ++n)
    report_.findSolid("/anchors/" + std::to_string(n) + "/solid", def_.grid.anchors[n].solid);
  if (std::ranges::none_of(changes_, std::identity{})) return;
  std::vector<EditPoint> points;
  std::vector<std::size_t> numbers(layout_.storage());
  forEachPoint(layout_, [&](int i, int j, std::size_t k) {
    numbers[k] = points.size();
    points.push_back({k, static_cast<double>(i) / layout_.columns,
                      static_cast<double>(j) / (layout_.rows - 1), SolidId()});
  });
  for (const TissueAnchors::Anchor& a : attachment_->anchors().anchors())
    points[numbers[a.point]].solid = a.solid;
  applySkinEdits(def_, base_, report_, points, {SkinKind::grid, {}}, rest(), changes_,
                 *quantities_);
}

// The surface's own forces; those of the skin before if nothing that they are made of has changed.
void GridSkinBuilder::makeTopology() {
  const SkinQuantities& q = *quantities_;
  const auto maxStretch = static_cast<float>(def_.material.max_stretch);
  const auto same = [&](SkinQuantity quantity) {
    return (*before_->quantities)[quantity] == q[quantity];
  };
  using Q = SkinQuantity;
  if (before_ && before_->shape == parts_.shape && same(Q::stretch_u) && same(Q::stretch_v) &&
      same(Q::shear) && same(Q::prestretch) && same(Q::bending) &&
      before_->grid->elastic().coefficients().cap == maxStretch * maxStretch - 1) {
    parts_.topology = before_->grid->topology;
    parts_.grid = std::make_shared<GridSkin>(GridSkin{before_->grid->topology, attachment_});
    return;
  }
  ElasticGrid elastic(
      layout_, rest(),
      {q[Q::stretch_u], q[Q::stretch_v], q[Q::shear], q[Q::prestretch], maxStretch});
  Bending bending(layout_, rest(), q[Q::bending]);
  auto topology = std::make_shared<GridTopology>(layout_, std::move(elastic), std::move(bending));
  parts_.grid = std::make_shared<GridSkin>(GridSkin{topology, attachment_});
  parts_.topology = std::move(topology);
}

void GridSkinBuilder::makeModel() {
  makeTopology();
  FloatArray stiffness = parts_.grid->elastic().stiffnessBound();
  parts_.grid->bending().addStiffnessBound(stiffness);
  parts_.contactResponse = {def_.material.friction_per_s, def_.material.restitution};
  std::vector<std::size_t> points, tied;
  forEachPoint(layout_, [&](int, int, std::size_t k) { points.push_back(k); });
  for (const TissueAnchors::Anchor& a : attachment_->anchors().anchors()) tied.push_back(a.point);
  const double size_m = parts_.shape->size_m;
  auto model = std::make_shared<PointModel>(
      makePointModel({*quantities_, parts_.gridRest->area_m2, stiffness,
                      1e-6 * size_m * size_m / static_cast<double>(layout_.pointCount()), points,
                      parts_.shape->fixedPoints, tied}));
  model->carry = static_cast<float>(def_.tissue.carry);
  parts_.defaultStep_s = longestStep(*model, kAddedMassShare);
  parts_.points = std::move(model);
  parts_.quantities = quantities_;
  if (def_.contact.self) makeSelfContact();
}

void GridSkinBuilder::chooseScheme() {
  parts_.cloth = settings_.integrator == "cloth" ||
                 (settings_.integrator == "auto" &&
                  suitsCloth(parts_.grid->elastic(), *parts_.points,
                             settings_.gravity_m_per_s2.norm(), parts_.defaultStep_s));
  if (parts_.cloth) parts_.defaultStep_s = clothStep_s(layout_.pointCount());
}

void GridSkinBuilder::makeSelfContact() {
  const auto gap_m = static_cast<float>(def_.contact.gap_m);
  if (before_ && before_->selfContact && before_->shape == parts_.shape &&
      before_->selfContact->gap_m == gap_m) {
    parts_.selfContact = before_->selfContact;
    return;
  }
  parts_.selfContact = std::make_shared<SelfContactModel>(
      prepareSelfContact(cellTriangles(layout_), rest(), parts_.shape->blocks, gap_m));
}

// The skin that a fine one rides on: everything resampled, attached anew.
void GridSkinBuilder::makeCoarse() {
  const double ratio = std::sqrt(static_cast<double>(layout_.pointCount()) / kCoarsePoints);
  const auto side = [&](int fine) {
    return std::max(kMinSide, static_cast<int>(std::lround(fine / ratio)));
  };
  const bool keeps = before_ && before_->coarse && before_->gridRest->wrap == parts_.gridRest->wrap;
  const Skin* before = keeps ? before_->coarse.get() : nullptr;
  GridSkinBuilder builder(def_, settings_, base_, before, report_);
  builder.layout_ = {side(layout_.columns), side(layout_.rows), true};
  builder.joint_[0] = joint_[0];
  builder.joint_[1] = joint_[1];
  builder.size_m_ = parts_.shape->size_m;
  builder.layUnder(layout_, parts_);
  const bool sameLayout = before_ && before_->coarse &&
                          before_->coarse->grid()->layout().columns == builder.layout_.columns &&
                          before_->coarse->grid()->layout().rows == builder.layout_.rows;
  for (const QuantityInfo& i : quantityInfos()) {
    const FloatArray& fine = (*quantities_)[i.quantity];
    (*builder.quantities_)[i.quantity] = sameLayout && (*before_->quantities)[i.quantity] == fine
                                             ? before_->coarse->quantities()[i.quantity]
                                             : resample(layout_, fine, builder.layout_);
  }
  builder.makeModel();
  parts_.coarse = std::make_shared<Skin>(settings_, std::move(builder.parts_));
}

// The rest shape of a coarse grid is the fine one's; its strands are its own.
void GridSkinBuilder::layUnder(const GridLayout& fineLayout, const SkinParts& fine) {
  GridRestKey key = fine.gridRest->key;
  const GridRest* old = before_ ? before_->gridRest.get() : nullptr;
  if (old && old->key == key) {
    takeOverRest();
    return;
  }
  std::shared_ptr<const GridWrap> wrap = old ? old->wrap : nullptr;
  if (!wrap) {
    auto own = std::make_shared<GridWrap>(*fine.gridRest->wrap);
    own->layout = layout_;
    own->faces = nullptr;  // of the fine grid, which is the one that is seen
    own->rest = resample(fineLayout, own->rest, layout_);
    own->anchors.clear(), own->placements.clear();
    placePoints(*own);
    attach(*own);
    wrap = std::move(own);
  }
  FollowedGrid followed = followMatter(*wrap, base_.flesh);
  followed.rest = resample(fineLayout, fine.shape->rest, layout_);
  placeIn(base_.posedFlesh, followed);
  setRest(std::move(wrap), std::move(key), std::move(followed));
}

}  // namespace fascia
