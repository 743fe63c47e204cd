#pragma once

#include <array>
#include <cmath>
#include <vector>

#include <fascia/geometry/triangle_mesh.h>

namespace fascia {

// Appends a box, counter-clockwise seen from outside.
inline void addBox(TriangleMesh& mesh, const Vec3& low, const Vec3& high) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int k = 0; k < 8; ++k)
    mesh.positions.push_back(Vec3((k & 1) != 0 ? high.x() : low.x(),
                                  (k & 2) != 0 ? high.y() : low.y(),
                                  (k & 4) != 0 ? high.z() : low.z())
                                 .cast<float>());
  constexpr std::array<std::array<std::uint32_t, 3>, 12> kFaces = {{{0, 2, 3},
                                                                    {0, 3, 1},
                                                                    {4, 5, 7},
                                                                    {4, 7, 6},
                                                                    {0, 1, 5},
                                                                    {0, 5, 4},
                                                                    {2, 6, 7},
                                                                    {2, 7, 3},
                                                                    {0, 4, 6},
                                                                    {0, 6, 2},
                                                                    {1, 3, 7},
                                                                    {1, 7, 5}}};
  for (const auto& f : kFaces) mesh.triangles.push_back({first + f[0], first + f[1], first + f[2]});
}

// An open tube along x from 0 to `length`, of rings of `around` points.
inline TriangleMesh tube(double radius, double length, std::uint32_t around, std::uint32_t rings) {
  TriangleMesh mesh;
  for (std::uint32_t r = 0; r < rings; ++r)
    for (std::uint32_t a = 0; a < around; ++a) {
      const double angle = 2 * kPi * a / around;
      mesh.positions.push_back(
          Vec3(length * r / (rings - 1), radius * std::cos(angle), radius * std::sin(angle))
              .cast<float>());
    }
  for (std::uint32_t r = 0; r + 1 < rings; ++r)
    for (std::uint32_t a = 0; a < around; ++a) {
      const std::uint32_t b = (a + 1) % around;
      const std::uint32_t p = r * around + a, q = r * around + b;
      mesh.triangles.push_back({p, q, p + around});
      mesh.triangles.push_back({q, q + around, p + around});
    }
  return mesh;
}

// Area of the regular polygon with as many corners that a tube's ring is.
inline double ringArea(double radius, std::uint32_t around) {
  return 0.5 * around * radius * radius * std::sin(2 * kPi / around);
}

}  // namespace fascia
