#include <fascia/skin/point/tissue.h>

#include <algorithm>
#include <tuple>

#include <fascia/base/assert.h>

namespace fascia {

TissueAnchors::TissueAnchors(std::vector<Anchor> anchors)
    : anchors_(std::move(anchors)), material_(anchors_.size()) {
  std::sort(anchors_.begin(), anchors_.end(), [](const Anchor& a, const Anchor& b) {
    return std::tie(a.solid, a.point) < std::tie(b.solid, b.point);
  });
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
