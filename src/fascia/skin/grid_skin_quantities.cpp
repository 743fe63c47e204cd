#include <algorithm>
#include <functional>

#include <fascia/skin/grid/resample.h>
#include <fascia/skin/grid_skin_builder.h>

// What a grid's points have each, and what regions, brushes and saved lists make of it.
namespace fascia {

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
    forEachGridPoint(savedLayout(), [&](int, int, std::size_t k) { stored[k] = saved[p++]; });
    values = sameGrid() ? stored : resample(savedLayout(), stored, g);
  }
}

void GridSkinBuilder::applyEdits() {
  for (std::size_t n = 0; n < def_.grid.anchors.size(); ++n)
    report_.findSolid("/anchors/" + std::to_string(n) + "/solid", def_.grid.anchors[n].solid);
  if (std::ranges::none_of(changes_, std::identity{})) return;
  std::vector<EditPoint> points;
  std::vector<std::size_t> numbers(layout_.storage());
  forEachGridPoint(layout_, [&](int i, int j, std::size_t k) {
    numbers[k] = points.size();
    points.push_back({k, static_cast<double>(i) / layout_.columns,
                      static_cast<double>(j) / (layout_.rows - 1), SolidId()});
  });
  for (const TissueAnchors::Anchor& a : attachment_->anchors().anchors())
    points[numbers[a.point]].solid = a.solid;
  applySkinEdits(def_, base_, report_, points, {SkinKind::grid, {}}, rest(), changes_,
                 *quantities_);
}

}  // namespace fascia
