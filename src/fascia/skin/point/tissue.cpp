#include <fascia/skin/point/tissue.h>

#include <algorithm>
#include <tuple>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

using Anchor = TissueAnchors::Anchor;

bool isBefore(const Anchor& a, const Anchor& b) {
  return std::tie(a.solid, a.point) < std::tie(b.solid, b.point);
}

// Solid by solid, and in each of them point by point. Anchors usually come point by point: then it
// is enough to deal them out to the solids.
void sortBySolid(std::vector<Anchor>& anchors) {
  if (!std::is_sorted(anchors.begin(), anchors.end(),
                      [](const Anchor& a, const Anchor& b) { return a.point < b.point; })) {
    std::sort(anchors.begin(), anchors.end(), isBefore);
    return;
  }
  std::vector<std::size_t> next;  // place of each solid's next anchor
  for (const Anchor& a : anchors) {
    if (next.size() < a.solid.index() + 2) next.resize(a.solid.index() + 2);
    ++next[a.solid.index() + 1];
  }
  for (std::size_t s = 1; s < next.size(); ++s) next[s] += next[s - 1];
  std::vector<Anchor> dealt(anchors.size());
  for (const Anchor& a : anchors) dealt[next[a.solid.index()]++] = a;
  anchors = std::move(dealt);
}

}  // namespace

TissueAnchors::TissueAnchors(std::vector<Anchor> anchors)
    : anchors_(std::move(anchors)), material_(anchors_.size()) {
  sortBySolid(anchors_);
  for (std::size_t i = 0; i < anchors_.size(); ++i) {
    const Anchor& a = anchors_[i];
    material_.x[i] = static_cast<float>(a.material.x());
    material_.y[i] = static_cast<float>(a.material.y());
    material_.z[i] = static_cast<float>(a.material.z());
    if (groups_.empty() || groups_.back().solid != a.solid) groups_.push_back({a.solid, i, 0});
    ++groups_.back().count;
  }
}

void TissueAnchors::place(const Field& field, VectorArray& scratch, VectorArray& anchor) const {
  FASCIA_ASSERT(anchors_.size() == material_.size(), "every anchor has its matter");
  scratch.resize(anchors_.size());
  for (const Group& g : groups_)
    field.worldFromMaterials(g.solid, view(material_, g.first, g.count),
                             view(scratch, g.first, g.count));
  for (std::size_t i = 0; i < anchors_.size(); ++i) {
    const std::size_t k = anchors_[i].point;
    FASCIA_ASSERT(k < anchor.size(), "an anchor holds a point of the skin");
    anchor.x[k] = scratch.x[i];
    anchor.y[k] = scratch.y[i];
    anchor.z[k] = scratch.z[i];
  }
}

}  // namespace fascia
