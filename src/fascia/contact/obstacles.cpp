#include <fascia/contact/obstacles.h>

#include <algorithm>
#include <array>

#include <fascia/math/points.h>

namespace fascia {

ObstacleId Obstacles::add(const MovingField& field, double friction) {
  obstacles_.push_back({ObstacleId(next_++), &field, friction});
  parts_.clear();
  return obstacles_.back().id;
}

ObstacleId Obstacles::addPadding(const SurfaceField& surface, double modulus_Pa, double friction) {
  const ObstacleId id = add(surface, friction);
  obstacles_.back().padding = &surface;
  obstacles_.back().modulus_Pa = modulus_Pa;
  return id;
}

void Obstacles::remove(ObstacleId obstacle) {
  std::erase_if(obstacles_, [&](const Obstacle& o) { return o.id == obstacle; });
  parts_.clear();
}

void Obstacles::update(double span_s) {
  parts_.clear(), boxes_.clear();
  for (const Obstacle& obstacle : obstacles_) {
    for (std::size_t s = 0; s < obstacle.field->solidCount(); ++s) {
      const SolidId solid(s);
      Box bounds = obstacle.field->bounds(solid);
      if (bounds.empty()) continue;
      bounds = inflated(bounds, outlineSpeed(*obstacle.field, solid) * span_s);
      parts_.push_back({&obstacle, solid, bounds});
      boxes_.push_back(bounds);
    }
  }
  near_.update(boxes_);
}

double outlineSpeed(const MovingField& field, SolidId solid) {
  constexpr std::size_t kCorners = MovingField::kOutline;
  const Transform frame = field.frame(solid);
  std::array<float, kCorners> x, y, z, vx, vy, vz;
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Eigen::Vector3f p = frame.point(field.outline(solid)[c]).cast<float>();
    x[c] = p.x(), y[c] = p.y(), z[c] = p.z();
  }
  const Vectors velocity{vx.data(), vy.data(), vz.data(), kCorners};
  field.velocity(solid, {x.data(), y.data(), z.data(), kCorners}, velocity);
  double fastest = 0;
  for (std::size_t c = 0; c < kCorners; ++c)
    fastest = std::max(fastest, pointAt(velocity, c).norm());
  return fastest;
}

}  // namespace fascia
