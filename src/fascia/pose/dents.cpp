#include <fascia/pose/dents.h>

#include <fascia/base/assert.h>
#include <fascia/geometry/box_tree.h>

namespace fascia {
namespace {

constexpr std::uint8_t kDentRings = 6;
constexpr int kDentPasses = 8;

// In world space, with room for what gives way.
Box boxOf(std::span<const Vector4f> position, const Vec3& origin_m) {
  constexpr double kRoom = 0.1;  // of its size
  Eigen::AlignedBox3f box;
  for (const Vector4f& p : position) box.extend(Eigen::Vector3f(p.head<3>()));
  if (box.isEmpty()) return {};
  const Box skin{box.min().cast<double>() + origin_m, box.max().cast<double>() + origin_m};
  return inflated(skin, kRoom * skin.size().norm());
}

// The skin's points within a solid's bounds, in world space.
void gather(const Box& bounds, const Vec3& origin_m, std::span<const Vector4f> position,
            Dents::Scratch& s) {
  s.inside.clear();
  s.point.resize(0);
  const Eigen::Vector3f low = (bounds.low - origin_m).cast<float>(),
                        high = (bounds.high - origin_m).cast<float>();
  for (std::uint32_t i = 0; i < position.size(); ++i) {
    const auto at = position[i].head<3>().array();
    if ((at < low.array()).any() || (at > high.array()).any()) continue;
    s.inside.push_back(i);
    s.point.x.push_back(position[i].x() + static_cast<float>(origin_m.x()));
    s.point.y.push_back(position[i].y() + static_cast<float>(origin_m.y()));
    s.point.z.push_back(position[i].z() + static_cast<float>(origin_m.z()));
  }
}

// Moves pressed points out of one solid; notes by how much.
void pressOut(const DistanceField& field, SolidId solid, std::span<Vector4f> position,
              Dents::Scratch& s) {
  FASCIA_ASSERT(s.point.size() == s.inside.size() && s.ring.size() == position.size(),
                "the points inside are gathered");
  const std::size_t count = s.inside.size();
  s.distance_m.resize(count);
  s.normal.resize(count);
  field.evaluate(solid, view(s.point, 0, count), s.distance_m.data(), view(s.normal, 0, count));
  for (std::size_t k = 0; k < count; ++k) {
    if (s.distance_m[k] >= 0) continue;
    const std::uint32_t i = s.inside[k];
    if (s.ring[i] == 0) {
      s.ring[i] = 1;
      s.active.push_back(i);
      s.shift[i].setZero();
    }
    const Vector4f out =
        -s.distance_m[k] * Vector4f(s.normal.x[k], s.normal.y[k], s.normal.z[k], 0);
    s.shift[i] += out;
    position[i] += out;
  }
}

// The rings around pressed points share their shift.
void giveWay(const PoseMesh& mesh, std::span<Vector4f> position, Dents::Scratch& s) {
  FASCIA_ASSERT(position.size() == mesh.size() && s.shift.size() == mesh.size(),
                "a shift for each point");
  const std::size_t pressed = s.active.size();
  std::size_t begin = 0;
  for (std::uint8_t ring = 2; ring <= kDentRings; ++ring) {
    const std::size_t end = s.active.size();
    for (; begin < end; ++begin)
      for (const PoseMesh::Edge& e : mesh.around(s.active[begin])) {
        if (s.ring[e.to]) continue;
        s.ring[e.to] = ring;
        s.shift[e.to].setZero();
        s.active.push_back(e.to);
      }
  }
  for (int pass = 0; pass < kDentPasses; ++pass) {
    for (std::size_t k = pressed; k < s.active.size(); ++k) {
      Vector4f sum = Vector4f::Zero();
      float total = 1e-9f;
      for (const PoseMesh::Edge& e : mesh.around(s.active[k])) {
        total += e.weight;
        if (s.ring[e.to]) sum += e.weight * s.shift[e.to];
      }
      s.next[s.active[k]] = sum / total;
    }
    for (std::size_t k = pressed; k < s.active.size(); ++k)
      s.shift[s.active[k]] = s.next[s.active[k]];
  }
  for (std::size_t k = pressed; k < s.active.size(); ++k)
    position[s.active[k]] += s.shift[s.active[k]];
}

}  // namespace

void Dents::press(const PoseMesh& mesh, const PoseObstacles& obstacles, const Vec3& origin_m,
                  std::span<Vector4f> position, Scratch& s) {
  if (!obstacles.field || obstacles.field->solidCount() <= obstacles.first) return;
  s.ring.assign(position.size(), 0);
  s.active.clear();
  s.shift.resize(position.size());
  s.next.resize(position.size());
  const Box skin = boxOf(position, origin_m);
  const auto pressOutOfAll = [&] {
    for (std::size_t n = obstacles.first; n < obstacles.field->solidCount(); ++n) {
      const SolidId solid(static_cast<std::int64_t>(n));
      const Box bounds = obstacles.field->bounds(solid);
      if (!meets(bounds, skin)) continue;
      gather(bounds, origin_m, position, s);
      if (!s.inside.empty()) pressOut(*obstacles.field, solid, position, s);
    }
  };
  pressOutOfAll();
  if (s.active.empty()) return;
  giveWay(mesh, position, s);
  pressOutOfAll();  // what gave way may have come into an obstacle itself
}

}  // namespace fascia
