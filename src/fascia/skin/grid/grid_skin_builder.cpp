#include <fascia/skin/grid/grid_skin_builder.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/parallel.h>
#include <fascia/math/points.h>
#include <fascia/skin/grid/attach.h>
#include <fascia/skin/grid/grid_kernels.h>
#include <fascia/skin/grid/resample.h>

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

template <class Visit>
void forEachPoint(const GridLayout& g, const Visit& visit) {
  for (int j = 0; j < g.rows; ++j)
    for (int i = 0; i < g.columns; ++i) visit(i, j, g.at(i, j));
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

}  // namespace

void GridSkinBuilder::build() {
  report_.checkValues(def_);
  EndRing bottom, top;
  if (!checkGrid()) return;
  layout_ = {def_.columns, def_.rows, true};
  if (!checkPoints() || !findEnds(bottom, top)) return;
  makeRestShape(bottom, top);
  placeCarriers();
  setQuantities();
  attach();
  applyEdits();
  makeModel();
  // Without strands nothing draws the two grids together again when they drift apart.
  if (skin_.settings_.integrator == "auto" && def_.tissue.stiffness_N_per_m3 > 0 &&
      skin_.defaultStep_s_ < kFinestStep_s && layout_.pointCount() >= 2 * kCoarsePoints)
    makeCoarse();
}

bool GridSkinBuilder::checkGrid() const {
  const bool columns = report_.checkSide("/grid/0", def_.columns);
  const bool rows = report_.checkSide("/grid/1", def_.rows);
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

bool GridSkinBuilder::findEnds(EndRing& bottom, EndRing& top) {
  if (base_.flesh.solidCount() == 0) {
    report_.error("", "found a skin, but no solids for it to lie on", "add at least one solid");
    return false;
  }
  const JointId joints[2] = {report_.findJoint("/bottom/joint", def_.bottom.joint),
                             report_.findJoint("/top/joint", def_.top.joint)};
  if (!joints[0].valid() || !joints[1].valid()) return false;
  const SkinEndDef* ends[2] = {&def_.bottom, &def_.top};
  Vec3 origin[2];
  for (int e = 0; e < 2; ++e)
    origin[e] = base_.posedSkeleton.joint_world[joints[e].index()].point(ends[e]->position_m);
  EndRing* rings[2] = {&bottom, &top};
  for (int e = 0; e < 2; ++e) {
    Vec3 axis = ends[e]->axis.norm() > 0
                    ? base_.posedSkeleton.joint_world[joints[e].index()].vector(ends[e]->axis)
                    : Vec3(origin[e] - origin[1 - e]);
    if (!(axis.norm() > 1e-9)) axis = e == 0 ? Vec3(-Vec3::UnitY()) : Vec3(Vec3::UnitY());
    rings[e]->axis = axis.normalized();
    rings[e]->center_m =
        exitPoint(base_.posedFlesh, origin[e], rings[e]->axis, def_.fat.thickness_m);
    joint_[e] = joints[e];
  }
  const double length = (top.center_m - bottom.center_m).norm();
  for (int e = 0; e < 2; ++e) {
    rings[e]->radius_m = ends[e]->radius_m > 0 ? ends[e]->radius_m : kEndRadius * length;
    if (rings[e]->radius_m > 1e-6) continue;
    report_.error(e == 0 ? "/bottom" : "/top", "found both ends of the skin in the same place",
                  "fix the ends to different joints, or give them different axes");
    return false;
  }
  return true;
}

void GridSkinBuilder::makeRestShape(const EndRing& bottom, const EndRing& top) {
  const GridLayout& g = layout_;
  if (def_.points && !def_.points->rest_position_m.empty()) {
    const GridLayout saved = savedLayout();
    VectorArray r(saved.storage());
    std::size_t p = 0;
    forEachPoint(saved, [&](int, int, std::size_t k) {
      const auto& v = def_.points->rest_position_m[p++];
      r.x[k] = v[0], r.y[k] = v[1], r.z[k] = v[2];
    });
    fillPads(saved, r);
    skin_.rest_ = sameGrid() ? r : resample(saved, r, g);
  } else {
    skin_.rest_ = shrinkWrap(base_.posedFlesh, g, bottom, top, {def_.fat.thickness_m, def_.cling});
  }
  Box box;
  forEachPoint(layout_, [&](int, int, std::size_t k) { box.add(pointAt(skin_.rest_, k)); });
  skin_.size_m_ = std::max(1e-6, box.size().norm());
}

void GridSkinBuilder::placeCarriers() {
  const std::vector<SolidId> solids = nearestSolids(base_.posedFlesh, layout_, skin_.rest_);
  std::vector<TissueAnchors::Anchor> carriers(solids.size());
  const auto columns = static_cast<std::size_t>(layout_.columns);
  parallelFor(solids.size() / columns, [&](std::size_t row) {
    for (std::size_t i = 0; i < columns; ++i) {
      const std::size_t p = row * columns + i, k = layout_.row(static_cast<int>(row)) + i;
      carriers[p] = {k, solids[p],
                     base_.posedFlesh.materialFromWorld(solids[p], pointAt(skin_.rest_, k))};
    }
  });
  skin_.carriers_ = TissueAnchors(std::move(carriers));
}

void GridSkinBuilder::setQuantities() {
  const GridLayout& g = layout_;
  for (const QuantityInfo& i : quantityInfos()) {
    FloatArray& values = skin_.quantities_[i.quantity];
    values.assign(g.storage(), static_cast<float>(uniformValue(def_, i.quantity)));
    if (!def_.points || pointValues(*def_.points, i.quantity).empty()) continue;
    const std::vector<float>& saved = pointValues(*def_.points, i.quantity);
    FloatArray stored(savedLayout().storage());
    std::size_t p = 0;
    forEachPoint(savedLayout(), [&](int, int, std::size_t k) { stored[k] = saved[p++]; });
    values = sameGrid() ? stored : resample(savedLayout(), stored, g);
  }
}

void GridSkinBuilder::attach() {
  const bool saved = def_.points && !def_.points->anchor.empty() && sameGrid();
  std::vector<Attachment> found;
  if (!saved) {
    VectorArray normals(layout_.storage());
    gridNormals(layout_, skin_.rest_, 0, layout_.rows, normals);
    found =
        attachAlongNormals(base_.posedFlesh, layout_, skin_.rest_, normals, def_.fat.thickness_m);
  }
  std::vector<TissueAnchors::Anchor> anchors(layout_.pointCount());
  parallelFor(static_cast<std::size_t>(layout_.rows - 2), [&](std::size_t row) {
    const int j = static_cast<int>(row) + 1;
    for (int i = 0; i < layout_.columns; ++i) {
      const auto p = static_cast<std::size_t>(j * layout_.columns + i);
      TissueAnchors::Anchor& anchor = anchors[p];
      anchor.point = layout_.at(i, j);
      if (saved) {
        anchor.solid = SolidId(def_.points->anchor_solid[p]);
        const auto& m = def_.points->anchor[p];
        anchor.material = Vec3(m[0], m[1], m[2]);
      } else {
        anchor.solid = found[p].solid;
        anchor.material = base_.posedFlesh.materialFromWorld(anchor.solid, found[p].place_m);
      }
      overrideAnchor(i, j, anchor);
    }
  });
  std::erase_if(anchors, [](const TissueAnchors::Anchor& a) { return !a.solid.valid(); });
  if (!def_.tissue.rest_length_m && !(def_.points && !def_.points->tissue_rest_length.empty()))
    measureStrands(anchors);
  skin_.anchors_ = TissueAnchors(std::move(anchors));
}

// The length at attachment is the one at rest.
void GridSkinBuilder::measureStrands(std::span<const TissueAnchors::Anchor> anchors) {
  FloatArray& restLength = skin_.quantities_[SkinQuantity::tissue_rest_length];
  parallelFor(anchors.size(), [&](std::size_t n) {
    const TissueAnchors::Anchor& a = anchors[n];
    const Vec3 inner = base_.posedFlesh.worldFromMaterial(a.solid, a.material);
    restLength[a.point] = static_cast<float>((pointAt(skin_.rest_, a.point) - inner).norm());
  });
}

void GridSkinBuilder::overrideAnchor(int i, int j, TissueAnchors::Anchor& anchor) const {
  for (const SkinAnchorDef& a : def_.anchors) {
    const int column =
        layout_.wrapped(static_cast<int>(std::lround(a.u * layout_.columns)) % layout_.columns);
    const int row = static_cast<int>(std::lround(a.v * (layout_.rows - 1)));
    if (column != i || row != j) continue;
    anchor.solid = base_.flesh.find(a.solid);
    if (!anchor.solid.valid()) continue;  // reported by applyEdits
    const Vec3 world = base_.posedFlesh.frame(anchor.solid).point(a.position_m);
    const float x = static_cast<float>(world.x()), y = static_cast<float>(world.y()),
                z = static_cast<float>(world.z());
    float d, nx, ny, nz;
    base_.posedFlesh.evaluate(anchor.solid, {&x, &y, &z, 1}, &d, {&nx, &ny, &nz, 1});
    anchor.material =
        base_.posedFlesh.materialFromWorld(anchor.solid, world - double{d} * Vec3(nx, ny, nz));
  }
}

void GridSkinBuilder::applyEdits() {
  for (std::size_t n = 0; n < def_.anchors.size(); ++n)
    report_.findSolid("/anchors/" + std::to_string(n) + "/solid", def_.anchors[n].solid);
  std::vector<EditPoint> points;
  std::vector<std::size_t> numbers(layout_.storage());
  forEachPoint(layout_, [&](int i, int j, std::size_t k) {
    numbers[k] = points.size();
    points.push_back({k, static_cast<double>(i) / layout_.columns,
                      static_cast<double>(j) / (layout_.rows - 1), SolidId()});
  });
  for (const TissueAnchors::Anchor& a : skin_.anchors_.anchors())
    points[numbers[a.point]].solid = a.solid;
  applySkinEdits(def_, base_, report_, points, nullptr, skin_.rest_, skin_.quantities_);
}

void GridSkinBuilder::makeModel() {
  const GridLayout& g = layout_;
  const SkinQuantities& q = skin_.quantities_;
  ElasticGrid elastic(
      g, skin_.rest_,
      {q[SkinQuantity::stretch_u], q[SkinQuantity::stretch_v], q[SkinQuantity::shear],
       q[SkinQuantity::prestretch], static_cast<float>(def_.material.max_stretch)});
  Bending bending(g, skin_.rest_, q[SkinQuantity::bending]);
  FloatArray stiffness = elastic.stiffnessBound();
  bending.addStiffnessBound(stiffness);
  auto topology = std::make_shared<GridTopology>(g, std::move(elastic), std::move(bending));
  skin_.grid_ = topology.get();
  skin_.topology_ = std::move(topology);
  skin_.contactResponse_ = {def_.material.friction_per_s, def_.material.restitution};
  fixEnds();
  std::vector<std::size_t> points, tied;
  forEachPoint(g, [&](int, int, std::size_t k) { points.push_back(k); });
  for (const TissueAnchors::Anchor& a : skin_.anchors_.anchors()) tied.push_back(a.point);
  skin_.points_ =
      makePointModel({q, pointAreas(g, skin_.rest_), stiffness,
                      1e-6 * skin_.size_m_ * skin_.size_m_ / static_cast<double>(g.pointCount()),
                      points, skin_.fixedPoints_, tied});
  skin_.points_.carry = static_cast<float>(def_.tissue.carry);
  for (int j = 1; j + 1 < g.rows; ++j)
    for (int i = 0; i < g.columns; i += static_cast<int>(PointBlock::kCapacity))
      skin_.blocks_.push_back(
          {g.at(i, j), std::min<std::uint32_t>(PointBlock::kCapacity,
                                               static_cast<std::uint32_t>(g.columns - i))});
  skin_.defaultStep_s_ = longestStep(skin_.points_, kAddedMassShare);
  if (def_.contact.self)
    skin_.selfContact_ = std::make_shared<SelfContactModel>(prepareSelfContact(
        cellTriangles(g), skin_.rest_, skin_.blocks_, static_cast<float>(def_.contact.gap_m)));
}

void GridSkinBuilder::fixEnds() {
  for (int e = 0; e < 2; ++e) {
    const Transform inverse = base_.posedSkeleton.joint_world[joint_[e].index()].inverse();
    for (int i = 0; i < layout_.columns; ++i) {
      const std::size_t k = layout_.at(i, e == 0 ? 0 : layout_.rows - 1);
      skin_.fixedPoints_.push_back(k);
      skin_.fixed_.push_back({k, joint_[e], inverse.point(pointAt(skin_.rest_, k))});
    }
  }
}

// The skin that a fine one rides on: everything resampled, attached anew.
void GridSkinBuilder::makeCoarse() {
  auto coarse = std::shared_ptr<Skin>(new Skin);
  const double ratio = std::sqrt(static_cast<double>(skin_.pointCount()) / kCoarsePoints);
  const auto side = [&](int fine) {
    return std::max(kMinSide, static_cast<int>(std::lround(fine / ratio)));
  };
  GridSkinBuilder builder(*coarse, def_, base_, report_);
  const GridLayout& g = builder.layout_ = {side(layout_.columns), side(layout_.rows), true};
  coarse->settings_ = skin_.settings_;
  coarse->size_m_ = skin_.size_m_;
  coarse->rest_ = resample(layout_, skin_.rest_, g);
  for (const QuantityInfo& i : quantityInfos())
    coarse->quantities_[i.quantity] = resample(layout_, skin_.quantities_[i.quantity], g);
  builder.joint_[0] = joint_[0];
  builder.joint_[1] = joint_[1];
  builder.placeCarriers();
  const FloatArray restLength = coarse->quantities_[SkinQuantity::tissue_rest_length];
  builder.attach();
  coarse->quantities_[SkinQuantity::tissue_rest_length] = restLength;
  builder.makeModel();
  skin_.coarse_ = std::move(coarse);
}

}  // namespace fascia
