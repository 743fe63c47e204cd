#include <fascia/skin/grid_skin_builder.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/parallel.h>
#include <fascia/math/points.h>
#include <fascia/skin/cloth/cloth_choice.h>
#include <fascia/skin/grid/grid_kernels.h>
#include <fascia/skin/grid/resample.h>
#include <fascia/skin/grid/tube_mesh.h>
#include <fascia/skin/point/leapfrog.h>

namespace fascia {
namespace {

constexpr int kMinSide = static_cast<int>(kGridSide.range.min);
// Share of the skin's mass that the automatic step may add to points whose cells are much smaller
// than the rest (the rings at the ends): below this no one sees a difference.
constexpr double kAddedMassShare = 0.02;
// A skin whose waves need shorter steps than this rides on a coarse one with about so many points.
constexpr double kFinestStep_s = 0.4e-3;
constexpr std::size_t kCoarsePoints = 1200;
}  // namespace

SkinParts GridSkinBuilder::build() {
  report_.checkValues(def_);
  if (!checkGrid()) return {};
  layout_ = {def_.grid.columns, def_.grid.rows, true};
  if (!checkPoints() || !findJoints() || !layAround()) return {};
  findSource();
  setQuantities();
  if (changes_[static_cast<std::size_t>(SkinQuantity::tissue_rest_length)])
    setNaturalLengths(def_, base_.posedFlesh, attachment_->anchors().anchors(), rest(),
                      (*quantities_)[SkinQuantity::tissue_rest_length]);
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
  forEachGridPoint(layout_, [&](int, int, std::size_t k) { points.push_back(k); });
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
