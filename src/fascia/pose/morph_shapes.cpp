#include <fascia/pose/morph_shapes.h>

#include <algorithm>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>

namespace fascia {
namespace {

constexpr std::size_t kMorphedPerTask = 512;

}  // namespace

MorphShapes::MorphShapes(const PoseSource& source, std::size_t pointCount) {
  std::vector<std::uint32_t> count(pointCount, 0);
  for (const RigMorph& morph : source.morphs) {
    rest_.push_back(double{morph.rest});
    for (const std::uint32_t p : morph.points) {
      FASCIA_ASSERT(p < pointCount, "a morph moves points of the skin");
      ++count[p];
    }
  }
  std::vector<std::uint32_t> next(pointCount, 0);
  firstShare_.push_back(0);
  for (std::size_t p = 0; p < pointCount; ++p) {
    if (count[p] == 0) continue;
    next[p] = firstShare_.back();
    points_.push_back(static_cast<std::uint32_t>(p));
    firstShare_.push_back(firstShare_.back() + count[p]);
  }
  shares_.resize(firstShare_.back());
  for (std::size_t m = 0; m < source.morphs.size(); ++m) {
    const RigMorph& morph = source.morphs[m];
    for (std::size_t k = 0; k < morph.points.size(); ++k)
      shares_[next[morph.points[k]]++] = {static_cast<std::uint32_t>(m),
                                          wide(morph.displacement_m[k])};
  }
}

void MorphShapes::move(std::span<const double> weights, std::span<const WideRotation> rotation,
                       std::span<Vector4f> position) const {
  if (weights.empty() || points_.empty()) return;
  FASCIA_ASSERT(weights.size() == rest_.size(), "a weight for each morph");
  FASCIA_ASSERT(rotation.size() == position.size(), "every point turns");
  const std::size_t count = points_.size();
  parallelFor((count + kMorphedPerTask - 1) / kMorphedPerTask, [&](std::size_t chunk) {
    const std::size_t end = std::min(count, kMorphedPerTask * (chunk + 1));
    for (std::size_t i = kMorphedPerTask * chunk; i < end; ++i) {
      Vector4f sum = Vector4f::Zero();
      for (std::uint32_t s = firstShare_[i]; s < firstShare_[i + 1]; ++s) {
        const Share& share = shares_[s];
        sum += static_cast<float>(weights[share.morph] - rest_[share.morph]) * share.displacement_m;
      }
      const std::uint32_t p = points_[i];
      position[p] += rotation[p] * sum;
    }
  });
}

}  // namespace fascia
