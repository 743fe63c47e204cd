#pragma once

#include <array>
#include <functional>
#include <vector>

#include <fascia/math/types.h>
#include <fascia/skin/self_contact/self_contact.h>

#include "grids.h"

// Sheets that may touch, and the part of a skin's stepping that matters for that.
namespace fascia::test {

inline constexpr float kGap_m = 0.002f;
inline constexpr double kInterval_s = 1.0 / 60;
inline constexpr int kStepsOfInterval = 8;  // per interval

// Points and triangles as a skin has them, and the part of its stepping that matters here.
struct Surface {
  VectorArray rest, position, velocity;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<PointBlock> blocks;
  PointModel points;
  PointSurroundings around;
  SelfContactModel model;
  SelfContact contact;

  std::size_t size() const { return rest.size(); }

  // columns x rows points at place(u, v), u and v in [0, 1], facing ∂u × ∂v. Returns the first.
  std::size_t addSheet(int columns, int rows, double mass_kg,
                       const std::function<Vec3(double, double)>& place) {
    const std::size_t first = size();
    const auto count = static_cast<std::size_t>(columns * rows);
    rest.resize(first + count);
    points.mass.resize(first + count, static_cast<float>(mass_kg / static_cast<double>(count)));
    points.free.resize(first + count, 1.f);
    const auto index = [&](int i, int j) {
      return static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(j * columns + i);
    };
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i)
        put(rest, index(i, j), place(i / (columns - 1.0), j / (rows - 1.0)));
    for (int j = 0; j + 1 < rows; ++j)
      for (int i = 0; i + 1 < columns; ++i) {
        const std::uint32_t a = index(i, j), b = index(i + 1, j), c = index(i + 1, j + 1),
                            d = index(i, j + 1);
        triangles.push_back({a, b, c});
        triangles.push_back({a, c, d});
      }
    for (std::size_t k = first; k < first + count; k += PointBlock::kCapacity)
      blocks.push_back({k, static_cast<std::uint32_t>(
                               std::min<std::size_t>(PointBlock::kCapacity, first + count - k))});
    return first;
  }

  void build(float gap_m = kGap_m) {
    model = prepareSelfContact(triangles, rest, blocks, gap_m);
    contact = SelfContact(model);
    position = rest;
    velocity = VectorArray(size());
    around.resize(size());
  }

  void move(std::size_t first, std::size_t end, const Vec3& by) {
    for (std::size_t k = first; k < end; ++k) put(position, k, at(position, k) + by);
  }
  void setVelocity(std::size_t first, std::size_t end, const Vec3& v) {
    for (std::size_t k = first; k < end; ++k) put(velocity, k, v);
  }

  SelfContact::Result resolve(float reach_m = 0.005f) {
    around.normal.fill(0.f);
    around.fleshVelocity.fill(0.f);
    return resolveAboveFlesh(reach_m);
  }
  // Like resolve(), with the flesh that `around` tells of.
  SelfContact::Result resolveAboveFlesh(float reach_m = 0.005f) {
    const auto duration_s = static_cast<float>(kInterval_s);
    const SelfContact::Result result =
        contact.separate(points, reach_m, position, velocity, duration_s);
    for (std::size_t k = 0; k < size(); ++k) {
      const Vec3 n = at(around.normal, k);
      const double depth = double{around.offset[k]} - n.dot(at(position, k));
      if (depth > 0) put(position, k, at(position, k) + depth * n);
    }
    contact.writeHalfSpaces(position, velocity, duration_s, around);
    return result;
  }

  // One step within an interval: flight and half spaces as in the stabilised leapfrog.
  void step(int number, double h_s) {
    for (std::size_t k = 0; k < size(); ++k) {
      Vec3 r = at(position, k) + h_s * at(velocity, k);
      const Vec3 n = at(around.normal, k), flesh = at(around.fleshVelocity, k);
      const double depth = around.offset[k] + number * h_s * n.dot(flesh) - n.dot(r);
      if (depth > 0) {
        r += depth * n;
        const double along = n.dot(at(velocity, k) - flesh);
        if (along < 0) put(velocity, k, at(velocity, k) - along * n);
      }
      put(position, k, r);
    }
  }
  using Accelerate = std::function<void(double h_s)>;
  void interval(const Accelerate& accelerate = {}, float reach_m = 0.005f) {
    resolve(reach_m);
    for (int s = 1; s <= kStepsOfInterval; ++s) {
      if (accelerate) accelerate(kInterval_s / kStepsOfInterval);
      step(s, kInterval_s / kStepsOfInterval);
    }
  }

  Vec3 momentum() const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < size(); ++k) sum += double(points.mass[k]) * at(velocity, k);
    return sum;
  }
  double kineticEnergy() const {
    double sum = 0;
    for (std::size_t k = 0; k < size(); ++k)
      sum += 0.5 * double(points.mass[k]) * at(velocity, k).squaredNorm();
    return sum;
  }

  // Pairs of triangles without a common corner of which an edge of one passes through the other.
  std::size_t crossingPairs() const {
    std::size_t pairs = 0;
    for (std::size_t s = 0; s < triangles.size(); ++s)
      for (std::size_t t = s + 1; t < triangles.size(); ++t)
        pairs += cross(triangles[s], triangles[t]);
    return pairs;
  }
  bool cross(const std::array<std::uint32_t, 3>& s, const std::array<std::uint32_t, 3>& t) const {
    for (const std::uint32_t a : s)
      for (const std::uint32_t b : t)
        if (a == b) return false;
    return pierces(s, t) || pierces(t, s);
  }
  bool pierces(const std::array<std::uint32_t, 3>& edges,
               const std::array<std::uint32_t, 3>& triangle) const {
    const Vec3 a = at(position, triangle[0]), b = at(position, triangle[1]),
               c = at(position, triangle[2]);
    const Vec3 normal = (b - a).cross(c - a);
    for (std::size_t e = 0; e < 3; ++e) {
      const Vec3 p = at(position, edges[e]), q = at(position, edges[(e + 1) % 3]);
      const double from = normal.dot(p - a), to = normal.dot(q - a);
      if ((from > 0) == (to > 0)) continue;
      const Vec3 hit = p + from / (from - to) * (q - p);
      if (normal.dot((b - a).cross(hit - a)) > 0 && normal.dot((c - b).cross(hit - b)) > 0 &&
          normal.dot((a - c).cross(hit - c)) > 0)
        return true;
    }
    return false;
  }
};

inline std::function<Vec3(double, double)> flat(const Vec3& origin, const Vec3& u, const Vec3& v) {
  return [=](double a, double b) { return Vec3(origin + a * u + b * v); };
}

inline bool sameBits(const VectorArray& a, const VectorArray& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}

// Two level sheets with the same border but different points, the lower one facing up and the upper
// one down.
struct TwoSheets : Surface {
  std::size_t lower, upper, end;

  explicit TwoSheets(double height_m, double lowerMass_kg = 0.1, double upperMass_kg = 0.1) {
    lower = addSheet(12, 12, lowerMass_kg, flat(Vec3(0, 0, 0), Vec3(0, 0, 0.11), Vec3(0.11, 0, 0)));
    upper = addSheet(13, 13, upperMass_kg,
                     flat(Vec3(0, height_m, 0), Vec3(0.11, 0, 0), Vec3(0, 0, 0.11)));
    end = size();
    build();
  }
  double leastHeight() const {
    double low = 1e9, high = -1e9;
    for (std::size_t k = lower; k < upper; ++k) high = std::max(high, at(position, k).y());
    for (std::size_t k = upper; k < end; ++k) low = std::min(low, at(position, k).y());
    return low - high;
  }
};

}  // namespace fascia::test
