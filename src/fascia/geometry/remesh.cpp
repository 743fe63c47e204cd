#include <fascia/geometry/remesh.h>

#include <algorithm>
#include <cmath>

#include <fascia/geometry/editable_mesh.h>
#include <fascia/math/points.h>

namespace fascia {
namespace {

// Of the length that an edge is to have (Botsch & Kobbelt's): beyond these a split or a collapse
// brings it nearer to it.
constexpr double kLong = 4.0 / 3, kShort = 4.0 / 5;
// Per length, how much the length that edges are to have may change along the surface.
constexpr double kGradation = 0.25;
constexpr int kGradationPasses = 8;
// A triangle stands no farther off the surface than acos of this; less would stall it.
constexpr double kLeastCosine = 0.3;
// Triangles flatter than this are none: twice the area over the square of the longest edge.
constexpr double kLeastHeight = 0.12;
constexpr int kSmoothings = 3;
constexpr double kFarthest = 0.5;  // edges that a point moves at once
constexpr int kEvenValence = 6;
constexpr std::uint32_t kNoPoint = 0xffffffff;

class Remesher {
 public:
  Remesher(const ImplicitSurface& surface, const TriangleMesh& mesh, const RemeshOptions& options)
      : surface_(surface), options_(options), mesh_(mesh) {}

  TriangleMesh run() {
    for (int round = 0; round < options_.rounds; ++round) {
      findSizes();
      splitLong();
      collapseShort();
      flipToEven();
      for (int n = 0; n < kSmoothings; ++n) smooth();
    }
    flipToEven();
    return mesh_.mesh();
  }

 private:
  using Edge = EditableMesh::Edge;

  using Corners = std::array<Vec3, 3>;

  double length(const Edge& e) const { return (mesh_.place(e.a) - mesh_.place(e.b)).norm(); }
  double sizeOf(const Edge& e) const { return 0.5 * (size_[e.a] + size_[e.b]); }

  // The length of the edges around each point: by the turn of the surface's normal along them.
  void findSizes() {
    const std::size_t count = mesh_.pointCount();
    VectorArray at(count), gradient(count);
    std::vector<float> value(count);
    for (std::uint32_t p = 0; p < count; ++p) setPoint(at, p, mesh_.place(p));
    surface_.evaluate(view(at, 0, count), value.data(), view(gradient, 0, count));
    std::vector<double> turn(count, 0.0);  // per metre
    const std::vector<Edge> edges = mesh_.edges();
    normal_.resize(count);
    for (std::uint32_t p = 0; p < count; ++p) normal_[p] = pointAt(gradient, p).normalized();
    for (const Edge& e : edges) {
      const Vec3 &a = normal_[e.a], &b = normal_[e.b];
      const double here = (a - b).norm() / std::max(length(e), 1e-3 * options_.edge_m);
      turn[e.a] = std::max(turn[e.a], here), turn[e.b] = std::max(turn[e.b], here);
    }
    size_.resize(count);
    for (std::size_t p = 0; p < count; ++p)
      size_[p] = std::clamp(options_.arc_rad / std::max(turn[p], 1e-9),
                            options_.finest * options_.edge_m, options_.edge_m);
    for (int n = 0; n < kGradationPasses; ++n)
      for (const Edge& e : edges) {
        const double most = kGradation * length(e);
        size_[e.a] = std::min(size_[e.a], size_[e.b] + most);
        size_[e.b] = std::min(size_[e.b], size_[e.a] + most);
      }
  }

  // Edges that `wanted` picks, by length.
  template <class Wanted>
  std::vector<Edge> edgesBy(bool longestFirst, const Wanted& wanted) const {
    std::vector<std::pair<double, Edge>> found;
    for (const Edge& e : mesh_.edges())
      if (wanted(e)) found.emplace_back(longestFirst ? -length(e) : length(e), e);
    std::stable_sort(found.begin(), found.end(),
                     [](const auto& x, const auto& y) { return x.first < y.first; });
    std::vector<Edge> out;
    out.reserve(found.size());
    for (const auto& [key, edge] : found) out.push_back(edge);
    return out;
  }

  void splitLong() {
    const auto isLong = [&](const Edge& e) { return length(e) > kLong * sizeOf(e); };
    for (std::vector<Edge> edges = edgesBy(true, isLong); !edges.empty();
         edges = edgesBy(true, isLong)) {
      for (const Edge& e : edges) {
        if (!mesh_.wings(e.a, e.b) || !isLong(e)) continue;
        mesh_.split(e.a, e.b, 0.5 * (mesh_.place(e.a) + mesh_.place(e.b)));
        size_.push_back(sizeOf(e));
        normal_.push_back((normal_[e.a] + normal_[e.b]).normalized());
      }
    }
  }

  void collapseShort() {
    const auto isShort = [&](const Edge& e) { return length(e) < kShort * sizeOf(e); };
    for (const Edge& e : edgesBy(false, isShort)) {
      if (!mesh_.wings(e.a, e.b) || !isShort(e) || !mesh_.canCollapse(e.a, e.b)) continue;
      // To its middle, or where that would fold the surface to one of its ends.
      const Vec3 a = mesh_.place(e.a), b = mesh_.place(e.b);
      for (const Vec3& place : {Vec3(0.5 * (a + b)), a, b}) {
        if (makesLong(e, place) || turnsOver(e.a, place, e.b) || turnsOver(e.b, place, e.a))
          continue;
        collapse(e, place);
        break;
      }
    }
  }

  void collapse(const Edge& e, const Vec3& place) {
    mesh_.collapse(e.a, e.b, place);
    size_[e.a] = sizeOf(e);
    normal_[e.a] = (normal_[e.a] + normal_[e.b]).normalized();
  }

  bool makesLong(const Edge& e, const Vec3& place) const {
    for (const std::uint32_t end : {e.a, e.b})
      for (const std::uint32_t t : mesh_.around(end))
        for (const std::uint32_t p : mesh_.corners(t))
          if (p != e.a && p != e.b &&
              (mesh_.place(p) - place).norm() > kLong * 0.5 * (size_[p] + sizeOf(e)))
            return true;
    return false;
  }

  // Whether a triangle of p that does not have `but` too would turn over, or nearly vanish.
  bool turnsOver(std::uint32_t p, const Vec3& place, std::uint32_t but) const {
    for (const std::uint32_t t : mesh_.around(p)) {
      const EditableMesh::Corners& c = mesh_.corners(t);
      if (c[0] == but || c[1] == but || c[2] == but) continue;
      const Corners now = placesOf(c);
      Corners then = now;
      for (std::size_t k = 0; k < 3; ++k)
        if (c[k] == p) then[k] = place;
      if (!isFit(now, then, normal_[c[0]] + normal_[c[1]] + normal_[c[2]])) return true;
    }
    return false;
  }

  Corners placesOf(const EditableMesh::Corners& c) const {
    return {mesh_.place(c[0]), mesh_.place(c[1]), mesh_.place(c[2])};
  }

  static Vec3 area(const Corners& t) { return (t[1] - t[0]).cross(t[2] - t[0]); }
  static double height(const Corners& t) {
    const double longest = std::max(
        {(t[1] - t[0]).squaredNorm(), (t[2] - t[1]).squaredNorm(), (t[0] - t[2]).squaredNorm()});
    return area(t).norm() / std::max(longest, 1e-300);
  }
  static double facing(const Corners& t, const Vec3& normal) {
    const Vec3 own = area(t);
    return own.dot(normal) / std::max(own.norm() * normal.norm(), 1e-300);
  }
  // Whether a triangle may become another where the surface has this normal. What is unfit already
  // may become anything that is less so.
  static bool isFit(const Corners& now, const Corners& then, const Vec3& normal) {
    return height(then) >= std::min(kLeastHeight, height(now)) &&
           facing(then, normal) >= std::min(kLeastCosine, facing(now, normal));
  }

  // Flips where the valences of the four points come nearer to six.
  void flipToEven() {
    for (const Edge& e : mesh_.edges()) {
      if (!mesh_.canFlip(e.a, e.b)) continue;
      const auto wing = *mesh_.wings(e.a, e.b);
      const auto off = [&](std::uint32_t p, int change) {
        const int d = static_cast<int>(mesh_.valence(p)) + change - kEvenValence;
        return d * d;
      };
      const int before = off(e.a, 0) + off(e.b, 0) + off(wing[0], 0) + off(wing[1], 0);
      const int after = off(e.a, -1) + off(e.b, -1) + off(wing[0], 1) + off(wing[1], 1);
      if (after >= before) continue;
      const Vec3 &a = mesh_.place(e.a), &b = mesh_.place(e.b), &l = mesh_.place(wing[0]),
                 &r = mesh_.place(wing[1]);
      const double longest = kLong * 0.5 * (size_[wing[0]] + size_[wing[1]]);
      if ((l - r).norm() > std::max(longest, (a - b).norm())) continue;
      const Corners left{a, b, l}, right{b, a, r}, newLeft{a, r, l}, newRight{b, l, r};
      const Vec3 normal = normal_[e.a] + normal_[e.b] + normal_[wing[0]] + normal_[wing[1]];
      const bool fit = isFit(left, newLeft, normal) && isFit(left, newRight, normal) &&
                       isFit(right, newLeft, normal) && isFit(right, newRight, normal);
      if (!fit) continue;
      mesh_.flip(e.a, e.b);
    }
  }

  // Each point to the middle of its triangles, along the surface and onto it.
  void smooth() {
    std::vector<std::uint32_t> points;
    std::vector<Vec3> places;
    for (std::uint32_t p = 0; p < mesh_.pointCount(); ++p) {
      if (mesh_.around(p).empty()) continue;
      points.push_back(p);
      places.push_back(middleAround(p));
    }
    projectOnto(surface_, kFarthest * options_.edge_m, places);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (!turnsOver(points[i], places[i], kNoPoint)) mesh_.setPlace(points[i], places[i]);
  }

  // By the triangles' areas over the square of the length that edges are to have there, so that
  // points do not leave where they are to be dense.
  Vec3 middleAround(std::uint32_t p) const {
    Vec3 sum = Vec3::Zero(), normal = Vec3::Zero();
    double weights = 0;
    for (const std::uint32_t t : mesh_.around(p)) {
      const EditableMesh::Corners& c = mesh_.corners(t);
      const Corners at = placesOf(c);
      const Vec3 twice = area(at);
      const double size = (size_[c[0]] + size_[c[1]] + size_[c[2]]) / 3;
      const double weight = twice.norm() / (size * size);
      sum += weight * (at[0] + at[1] + at[2]) / 3;
      weights += weight;
      normal += twice;
    }
    const Vec3& here = mesh_.place(p);
    if (!(weights > 0) || !(normal.norm() > 0)) return here;
    normal.normalize();
    const Vec3 way = sum / weights - here;
    return here + way - way.dot(normal) * normal;
  }

  const ImplicitSurface& surface_;
  const RemeshOptions& options_;
  EditableMesh mesh_;
  std::vector<double> size_;  // of each point: how long edges there are to be
  std::vector<Vec3> normal_;  // the surface's there, as the round found it
};

}  // namespace

TriangleMesh remeshed(const ImplicitSurface& surface, const TriangleMesh& mesh,
                      const RemeshOptions& options) {
  return Remesher(surface, mesh, options).run();
}

}  // namespace fascia
