#include <fascia/geometry/triangle_hierarchy.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/geometry/closest_point.h>

namespace fascia {

namespace {

// Entry and exit of a ray through a box by slabs; an axis with no direction only tests the origin.
bool rayMeets(const Box& box, const Vec3& origin, const Vec3& direction, double tMax) {
  double enter = 0, leave = tMax;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0) {
      if (origin[axis] < box.low[axis] || origin[axis] > box.high[axis]) return false;
      continue;
    }
    const double a = (box.low[axis] - origin[axis]) / direction[axis];
    const double b = (box.high[axis] - origin[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  // The slack keeps rays that graze an edge: rounding may not lose them between two boxes.
  return enter <= leave + 1e-12 * std::abs(leave);
}

// Möller & Trumbore 1997, without culling. t and the weights of the corners b and c.
std::optional<Vec3> rayTriangle(const std::array<Vec3, 3>& v, const Vec3& origin,
                                const Vec3& direction) {
  const Vec3 ab = v[1] - v[0], ac = v[2] - v[0];
  const Vec3 cross = direction.cross(ac);
  const double determinant = ab.dot(cross);
  if (determinant == 0) return std::nullopt;
  const Vec3 toOrigin = origin - v[0];
  const double wb = toOrigin.dot(cross) / determinant;
  const Vec3 other = toOrigin.cross(ab);
  const double wc = direction.dot(other) / determinant;
  if (!(wb >= 0 && wc >= 0 && wb + wc <= 1)) return std::nullopt;
  return Vec3(ac.dot(other) / determinant, wb, wc);
}

}  // namespace

TriangleHierarchy::TriangleHierarchy(const TriangleMesh& mesh)
    : mesh_(&mesh), boxes_(mesh.triangles.size()) {
  updateBoxes();
  tree_.build(boxes_);
}

void TriangleHierarchy::refit() {
  FASCIA_ASSERT(boxes_.size() == mesh_->triangles.size(), "the mesh keeps its triangles");
  updateBoxes();
  tree_.refit(boxes_);
}

void TriangleHierarchy::updateBoxes() {
  for (std::uint32_t i = 0; i < boxes_.size(); ++i) {
    boxes_[i] = Box{};
    for (const Vec3& corner : corners(i)) boxes_[i].add(corner);
  }
}

std::array<Vec3, 3> TriangleHierarchy::corners(std::uint32_t triangle) const {
  FASCIA_ASSERT(triangle < mesh_->triangles.size(), "the triangle exists");
  const auto& t = mesh_->triangles[triangle];
  FASCIA_ASSERT(areBelow(t, mesh_->positions.size()), "corners are points of the mesh");
  return {mesh_->positions[t[0]].cast<double>(), mesh_->positions[t[1]].cast<double>(),
          mesh_->positions[t[2]].cast<double>()};
}

std::optional<TriangleHierarchy::Nearest> TriangleHierarchy::closest(const Vec3& p,
                                                                     double limit_m) const {
  FASCIA_ASSERT(p.allFinite() && limit_m >= 0, "a search has a centre and a radius");
  std::optional<Nearest> best;
  double bestSquare = limit_m * limit_m;
  const auto key = [&](const Box& box) { return squaredDistance(box, p); };
  tree_.visitNearFirst(
      key, [&](const Box& box) { return squaredDistance(box, p) <= bestSquare; },
      [&](std::uint32_t triangle) {
        const auto [a, b, c] = corners(triangle);
        const TrianglePoint point = closestPointOnTriangle(p, a, b, c);
        const double square = (point.position - p).squaredNorm();
        if (square > bestSquare) return;
        if (best && square == bestSquare && triangle > best->triangle) return;
        bestSquare = square;
        best = Nearest{triangle, point.position, point.weights, std::sqrt(square)};
      });
  return best;
}

std::optional<TriangleHierarchy::Hit> TriangleHierarchy::firstHit(const Vec3& origin,
                                                                  const Vec3& direction,
                                                                  double tMax) const {
  FASCIA_ASSERT(direction.squaredNorm() > 0 && tMax >= 0, "a ray goes somewhere");
  std::optional<Hit> best;
  double limit = tMax;
  const auto key = [&](const Box& box) { return squaredDistance(box, origin); };
  tree_.visitNearFirst(
      key, [&](const Box& box) { return rayMeets(box, origin, direction, limit); },
      [&](std::uint32_t triangle) {
        const auto hit = rayTriangle(corners(triangle), origin, direction);
        if (!hit || hit->x() < 0 || hit->x() > limit) return;
        if (best && hit->x() == limit && triangle > best->triangle) return;
        limit = hit->x();
        best = Hit{triangle, limit, Vec3(1 - hit->y() - hit->z(), hit->y(), hit->z())};
      });
  return best;
}

std::optional<TriangleHierarchy::Hit> TriangleHierarchy::hitOf(std::uint32_t triangle,
                                                               const Vec3& origin,
                                                               const Vec3& direction) const {
  const auto hit = rayTriangle(corners(triangle), origin, direction);
  if (!hit || hit->x() < 0) return std::nullopt;
  return Hit{triangle, hit->x(), Vec3(1 - hit->y() - hit->z(), hit->y(), hit->z())};
}

void TriangleHierarchy::allHits(const Vec3& origin, const Vec3& direction, double tMax,
                                std::vector<Hit>& hits) const {
  FASCIA_ASSERT(direction.squaredNorm() > 0 && tMax >= 0, "a ray goes somewhere");
  hits.clear();
  tree_.visit([&](const Box& box) { return rayMeets(box, origin, direction, tMax); },
              [&](std::uint32_t triangle) {
                const auto hit = hitOf(triangle, origin, direction);
                if (hit && hit->t <= tMax) hits.push_back(*hit);
              });
  std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) {
    return a.t != b.t ? a.t < b.t : a.triangle < b.triangle;
  });
}

}  // namespace fascia
