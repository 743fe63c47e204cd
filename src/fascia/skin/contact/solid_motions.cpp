#include <fascia/skin/contact/solid_motions.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fascia {

bool SolidMotions::follow(const MovingField& field, CulledSolids& out) {
  const std::size_t solids = field.solidCount();
  const bool first = corners_.size() != solids * kCorners;
  if (first) out.resize(solids);
  corners_.resize(solids * kCorners);
  for (std::size_t s = 0; s < solids; ++s) {
    const SolidId id(static_cast<std::int64_t>(s));
    const Transform frame = field.frame(id);
    const MovingField::Outline& outline = field.outline(id);
    std::array<Eigen::Vector3f, kCorners> now;
    for (std::size_t c = 0; c < kCorners; ++c) now[c] = frame.point(outline[c]).cast<float>();
    Eigen::Vector3f* before = corners_.data() + s * kCorners;
    if (first) std::copy(now.begin(), now.end(), before);
    CulledSolids::Motion motion =
        between(std::span<const Eigen::Vector3f, kCorners>(before, kCorners), now);
    motion.steepness = static_cast<float>(field.lipschitz(id));
    out.setMotion(s, motion);
    std::copy(now.begin(), now.end(), before);
  }
  return !first;
}

CulledSolids::Motion SolidMotions::between(std::span<const Eigen::Vector3f, kCorners> before,
                                           std::span<const Eigen::Vector3f, kCorners> now) {
  CulledSolids::Motion m;
  Eigen::Matrix3f edges, edgesNow;
  for (int a = 0; a < 3; ++a) {
    edges.col(a) = before[std::size_t{1} << a] - before[0];
    edgesNow.col(a) = now[std::size_t{1} << a] - now[0];
  }
  const Eigen::Matrix3f map = edgesNow * edges.inverse();
  m.change = map - Eigen::Matrix3f::Identity();
  m.origin = before[0];
  m.shift = now[0] - before[0];
  m.turn = m.change.norm();
  // Distances change where the map is not rigid, and where the corners do not follow it.
  const float size = (before[kCorners - 1] - before[0]).norm();
  m.extra_m = 2 * size * (map.transpose() * map - Eigen::Matrix3f::Identity()).norm();
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Eigen::Vector3f way = m.change * (before[c] - m.origin) + m.shift;
    m.extra_m += (now[c] - before[c] - way).norm();
  }
  // A box without volume has no map: nothing is known then.
  if (!std::isfinite(m.turn) || !std::isfinite(m.extra_m)) {
    m = {Eigen::Matrix3f::Zero(), m.origin, m.shift, 0, -kUnknownGap_m};
  }
  return m;
}

}  // namespace fascia
