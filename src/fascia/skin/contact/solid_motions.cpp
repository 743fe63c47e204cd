#include <fascia/skin/contact/solid_motions.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fascia {

bool SolidMotions::follow(const MovingField& field, CulledSolids& out) {
  const std::size_t solids = field.solidCount();
  const bool first = solids_.size() != solids;
  if (first) out.resize(solids);
  solids_.resize(solids);
  for (std::size_t s = 0; s < solids; ++s) {
    const SolidId id(static_cast<std::int64_t>(s));
    const Transform frame = field.frame(id);
    const MovingField::Outline& outline = field.outline(id);
    Solid& solid = solids_[s];
    CulledSolids::Motion motion;
    if (!first && outline == solid.outline) {
      motion = rigid(solid.frame, frame, outline);
    } else {
      Corners before, now;
      for (std::size_t c = 0; c < kCorners; ++c) {
        now[c] = frame.point(outline[c]).cast<float>();
        before[c] = first ? now[c] : solid.frame.point(solid.outline[c]).cast<float>();
      }
      motion = between(before, now);
      solid.outline = outline;
    }
    solid.frame = frame;
    motion.steepness = static_cast<float>(field.lipschitz(id));
    out.setMotion(s, motion);
  }
  return !first;
}

// While only the frame changes, the matter goes with it.
CulledSolids::Motion SolidMotions::rigid(const Transform& before, const Transform& now,
                                         const MovingField::Outline& outline) {
  const Mat3 change = now.rotation * before.rotation.transpose() - Mat3::Identity();
  CulledSolids::Motion m;
  m.change = change.cast<float>();
  m.origin = before.translation_m.cast<float>();
  m.shift = (now.translation_m + change * (m.origin.cast<double>() - before.translation_m) -
             before.translation_m)
                .cast<float>();
  m.turn = m.change.norm();
  // What is rounded, on the way to floats and by rotations that are not quite orthonormal.
  constexpr double kRounding = 1e-6;
  const double size_m = (outline[kCorners - 1] - outline[0]).norm();
  m.extra_m = static_cast<float>(kRounding *
                                 (size_m + before.translation_m.norm() + now.translation_m.norm()));
  return m;
}

CulledSolids::Motion SolidMotions::between(const Corners& before, const Corners& now) {
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
