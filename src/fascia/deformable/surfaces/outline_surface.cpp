#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include <fascia/deformable/surfaces/body_surface.h>
#include <fascia/geometry/polygon.h>

namespace fascia {
namespace {

// Edges of the drawn mesh are at most this part of the outline's extent: of a bend by a right angle
// over the whole length the eye then does not see the corners.
constexpr double kEdgeShare = 1.0 / 24;
// Corners of the rim that turn by less are drawn round.
const double kRoundCosine = std::cos(radians(40));

Vec2 outwardNormal(const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a;
  return Vec2(along.y(), -along.x()).normalized();
}

// Both faces of the plate and its rim, each with vertices of its own.
class PlateMesh {
 public:
  PlateMesh(const PlanarMesh& flat, double half_m) : flat_(flat), half_m_(half_m) {
    addFace(1);
    addFace(-1);
    addRim();
  }
  TriangleMesh take() { return std::move(mesh_); }

 private:
  std::uint32_t addVertex(std::uint32_t point, double side, const Vec3& normal) {
    const Vec2& p = flat_.positions_m[point];
    mesh_.positions.push_back(Vec3(p.x(), p.y(), side * half_m_).cast<float>());
    mesh_.normals.push_back(normal.cast<float>());
    return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
  }
  void addFace(double side) {
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    for (std::uint32_t p = 0; p < flat_.positions_m.size(); ++p)
      addVertex(p, side, Vec3(0, 0, side));
    for (const auto& [a, b, c] : flat_.triangles) {
      if (side > 0)
        mesh_.triangles.push_back({first + a, first + b, first + c});
      else
        mesh_.triangles.push_back({first + a, first + c, first + b});
    }
  }
  // Border edges are those whose reverse no triangle has; `next` follows them counter-clockwise.
  std::map<std::uint32_t, std::uint32_t> border() const {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const auto& t : flat_.triangles)
      for (std::size_t c = 0; c < 3; ++c) edges[{t[c], t[(c + 1) % 3]}] = 1;
    std::map<std::uint32_t, std::uint32_t> next;
    for (const auto& [edge, count] : edges)
      if (!edges.contains({edge.second, edge.first})) next[edge.first] = edge.second;
    return next;
  }
  void addRim() {
    const auto next = border();
    std::map<std::uint32_t, std::uint32_t> before;
    for (const auto& [a, b] : next) before[b] = a;
    const auto normalOf = [&](std::uint32_t a) {
      return outwardNormal(flat_.positions_m[a], flat_.positions_m[next.at(a)]);
    };
    const auto cornerNormal = [&](const Vec2& own, const Vec2& neighbour) {
      const Vec2 n = own.dot(neighbour) > kRoundCosine ? Vec2((own + neighbour).normalized()) : own;
      return Vec3(n.x(), n.y(), 0);
    };
    for (const auto& [a, b] : next) {
      const Vec2 own = normalOf(a);
      const Vec3 atA = cornerNormal(own, normalOf(before.at(a)));
      const Vec3 atB = cornerNormal(own, normalOf(b));
      const std::uint32_t lowA = addVertex(a, -1, atA), lowB = addVertex(b, -1, atB),
                          highA = addVertex(a, 1, atA), highB = addVertex(b, 1, atB);
      mesh_.triangles.push_back({lowA, lowB, highB});
      mesh_.triangles.push_back({lowA, highB, highA});
    }
  }

  const PlanarMesh& flat_;
  double half_m_;
  TriangleMesh mesh_;
};

class OutlineSurface final : public BodySurface {
 public:
  OutlineSurface(std::span<const Vec2> outline_m, double thickness_m)
      : corners_m_(outline_m.begin(), outline_m.end()), half_m_(0.5 * thickness_m) {
    if (signedArea(corners_m_) < 0) std::ranges::reverse(corners_m_);
    for (const Vec2& p : corners_m_) {
      bounds_m_.add(Vec3(p.x(), p.y(), -half_m_));
      bounds_m_.add(Vec3(p.x(), p.y(), half_m_));
    }
    const double edge_m = kEdgeShare * bounds_m_.size().head<2>().maxCoeff();
    mesh_ = PlateMesh(refined(corners_m_, triangulatePolygon(corners_m_), edge_m), half_m_).take();
  }

  Box bounds_m() const override { return bounds_m_; }
  const TriangleMesh& mesh() const override { return mesh_; }

  void evaluate(ConstVectors X, float* distance_m, Vectors normal) const override {
    for (std::size_t i = 0; i < X.count; ++i) {
      const Planar flat = planar(Vec2(X.x[i], X.y[i]));
      const double up = X.z[i] < 0 ? -1 : 1, above_m = std::abs(double{X.z[i]}) - half_m_;
      Vec3 n(0, 0, up);
      double d_m = above_m;
      if (flat.distance_m > 0 && above_m > 0) {  // nearest to an edge of the rim
        d_m = std::hypot(flat.distance_m, above_m);
        n << flat.normal * (flat.distance_m / d_m), up * above_m / d_m;
      } else if (flat.distance_m > above_m) {
        d_m = flat.distance_m;
        n << flat.normal, 0;
      }
      distance_m[i] = static_cast<float>(d_m);
      normal.x[i] = static_cast<float>(n.x());
      normal.y[i] = static_cast<float>(n.y());
      normal.z[i] = static_cast<float>(n.z());
    }
  }

 private:
  struct Planar {
    double distance_m;
    Vec2 normal;
  };
  // Exact distance to the polygon; inside where the winding number is odd.
  Planar planar(const Vec2& p) const {
    double best_m2 = 1e300;
    Vec2 offset = Vec2::Zero(), edgeNormal = Vec2::UnitX();
    bool inside = false;
    for (std::size_t i = 0; i < corners_m_.size(); ++i) {
      const Vec2 &a = corners_m_[i], &b = corners_m_[(i + 1) % corners_m_.size()];
      const Vec2 ab = b - a, ap = p - a;
      const double along = std::clamp(ap.dot(ab) / ab.squaredNorm(), 0.0, 1.0);
      const Vec2 away = ap - along * ab;
      if (away.squaredNorm() < best_m2) {
        best_m2 = away.squaredNorm(), offset = away, edgeNormal = outwardNormal(a, b);
      }
      const bool spans = (a.y() > p.y()) != (b.y() > p.y());
      if (spans && (ab.x() * ap.y() - ab.y() * ap.x() > 0) == (b.y() > a.y())) inside = !inside;
    }
    const double distance_m = std::sqrt(best_m2), sign = inside ? -1 : 1;
    // On the border itself the offset has no direction.
    const Vec2 normal = distance_m > 0 ? Vec2(sign / distance_m * offset) : edgeNormal;
    return {sign * distance_m, normal};
  }

  std::vector<Vec2> corners_m_;  // counter-clockwise
  double half_m_;
  Box bounds_m_;
  TriangleMesh mesh_;
};

}  // namespace

BodySurfacePtr makeOutlineSurface(std::span<const Vec2> outline_m, double thickness_m) {
  checkSimplePolygon(outline_m);
  if (!(thickness_m > 0 && std::isfinite(thickness_m))) {
    Issue issue{{},
                "outline: thickness_m: found " + std::to_string(thickness_m) +
                    ", expected a positive number",
                {}};
    throw Error(issue);
  }
  return std::make_shared<OutlineSurface>(outline_m, thickness_m);
}

}  // namespace fascia
