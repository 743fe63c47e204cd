#include <fascia/skin/mesh/soft_ride.h>

#include <algorithm>
#include <cmath>

namespace fascia {
namespace {

constexpr double kReach = 0.35;  // of a solid's shortest side: skin farther away does not ride

}  // namespace

SoftRide::SoftRide(const Flesh& flesh, const Field& field, std::span<const Transform> joints,
                   const VectorArray& rest, std::size_t count) {
  for (std::size_t s = 0; s < flesh.solidCount(); ++s) {
    const SolidId id(static_cast<std::int64_t>(s));
    if (!flesh.def(id).soft) continue;
    Solid solid{id, flesh.joint(id).index(), {}, {}, {}, {}};
    std::vector<float> distance(count);
    VectorArray normal(count);
    field.evaluate(id, view(rest, 0, count), distance.data(), view(normal, 0, count));
    const auto reach = static_cast<float>(kReach * field.bounds(id).size().minCoeff());
    const Transform toJoint = joints[solid.joint].inverse();
    for (std::uint32_t i = 0; i < count; ++i) {
      const float t = std::clamp(1 - distance[i] / reach, 0.f, 1.f);
      if (t <= 0) continue;
      const Vec3 world(rest.x[i], rest.y[i], rest.z[i]);
      const Vec3 material = field.materialFromWorld(id, world);
      solid.point.push_back(i);
      solid.share.push_back(t * t * (3 - 2 * t));
      solid.inJoint_m.push_back(toJoint.point(world));
      solid.material.x.push_back(static_cast<float>(material.x()));
      solid.material.y.push_back(static_cast<float>(material.y()));
      solid.material.z.push_back(static_cast<float>(material.z()));
    }
    if (!solid.point.empty()) solids_.push_back(std::move(solid));
  }
}

void SoftRide::move(const Field& field, std::span<const Transform> joints, VectorArray& world,
                    VectorArray& skin) const {
  for (const Solid& s : solids_) {
    world.resize(s.point.size());
    field.worldFromMaterials(s.solid, view(s.material, 0, s.point.size()),
                             view(world, 0, s.point.size()));
    for (std::size_t k = 0; k < s.point.size(); ++k) {
      const Vec3 carried = joints[s.joint].point(s.inJoint_m[k]);
      const std::uint32_t i = s.point[k];
      skin.x[i] += s.share[k] * (world.x[k] - static_cast<float>(carried.x()));
      skin.y[i] += s.share[k] * (world.y[k] - static_cast<float>(carried.y()));
      skin.z[i] += s.share[k] * (world.z[k] - static_cast<float>(carried.z()));
    }
  }
}

}  // namespace fascia
