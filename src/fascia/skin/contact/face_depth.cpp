#include <fascia/skin/contact/face_depth.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include <fascia/base/parallel.h>

namespace fascia {
namespace {

constexpr std::size_t kFacesPerTask = 64;
constexpr double kDensity = 1.0 / 300;  // pieces are this small, as a share of the surface's size
// Smaller ones are only looked at around the deepest place, while they are few: parallel surfaces
// are as deep everywhere.
constexpr std::size_t kFew = 256;
constexpr int kMostLevels = 12;

struct FacePiece {
  Eigen::Vector3f a, b, c;
  float radius_m;  // about the middle

  Eigen::Vector3f middle() const { return (a + b + c) / 3; }
};

FacePiece pieceOf(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
  FacePiece piece{a, b, c, 0};
  const Eigen::Vector3f m = piece.middle();
  piece.radius_m =
      std::sqrt(std::max({(a - m).squaredNorm(), (b - m).squaredNorm(), (c - m).squaredNorm()}));
  return piece;
}

// Looks at pieces level by level: those that may be inside fall apart into four.
class FaceSearch {
 public:
  FaceSearch(const DistanceField& field, float finest_m) : field_(field), finest_m_(finest_m) {}

  // Deeper than `depth_m`, or that.
  float deepest(SolidId solid, std::vector<FacePiece>& pieces, float depth_m) {
    const auto steepness = static_cast<float>(field_.lipschitz(solid));
    for (int level = 0; level < kMostLevels && !pieces.empty(); ++level) {
      evaluate(solid, pieces);
      for (std::size_t i = 0; i < pieces.size(); ++i) depth_m = std::max(depth_m, -distance_[i]);
      next_.clear();
      for (std::size_t i = 0; i < pieces.size(); ++i) {
        const bool fine = pieces[i].radius_m <= finest_m_;
        if (distance_[i] - steepness * pieces[i].radius_m < -depth_m &&
            (!fine || (depth_m > 0 && next_.size() < kFew)))
          split(pieces[i]);
      }
      std::swap(pieces, next_);
    }
    return depth_m;
  }

 private:
  void evaluate(SolidId solid, const std::vector<FacePiece>& pieces) {
    const std::size_t count = pieces.size();
    for (auto* values : {&x_, &y_, &z_, &distance_, &nx_, &ny_, &nz_}) values->resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector3f m = pieces[i].middle();
      x_[i] = m.x(), y_[i] = m.y(), z_[i] = m.z();
    }
    field_.evaluate(solid, {x_.data(), y_.data(), z_.data(), count}, distance_.data(),
                    {nx_.data(), ny_.data(), nz_.data(), count});
  }
  // All four have the shape of the whole.
  void split(const FacePiece& p) {
    const Eigen::Vector3f ab = (p.a + p.b) / 2, bc = (p.b + p.c) / 2, ca = (p.c + p.a) / 2;
    const float radius_m = p.radius_m / 2;
    next_.push_back({p.a, ab, ca, radius_m});
    next_.push_back({ab, p.b, bc, radius_m});
    next_.push_back({ca, bc, p.c, radius_m});
    next_.push_back({ab, bc, ca, radius_m});
  }

  const DistanceField& field_;
  float finest_m_;
  std::vector<FacePiece> next_;
  std::vector<float> x_, y_, z_, distance_, nx_, ny_, nz_;
};

bool meet(const Box& a, const Box& b) {
  return (a.low.array() <= b.high.array()).all() && (a.high.array() >= b.low.array()).all();
}

// Of some of the surface's faces.
float deepestOf(const DistanceField& field, const std::vector<Box>& bounds,
                const TriangleMesh& surface, std::size_t first, std::size_t last, float finest_m) {
  std::vector<FacePiece> faces, pieces;
  std::vector<Box> boxes;
  Box all;
  for (std::size_t f = first; f < last; ++f) {
    const auto& t = surface.triangles[f];
    faces.push_back(
        pieceOf(surface.positions[t[0]], surface.positions[t[1]], surface.positions[t[2]]));
    Box box;
    for (const std::uint32_t v : t) box.add(surface.positions[v].cast<double>());
    boxes.push_back(box);
    all.add(box);
  }
  FaceSearch search(field, finest_m);
  float depth_m = 0;
  for (std::size_t s = 0; s < bounds.size(); ++s) {
    if (!meet(all, bounds[s])) continue;
    pieces.clear();
    for (std::size_t f = 0; f < faces.size(); ++f)
      if (meet(boxes[f], bounds[s])) pieces.push_back(faces[f]);
    if (!pieces.empty())
      depth_m = search.deepest(SolidId(static_cast<std::int64_t>(s)), pieces, depth_m);
  }
  return depth_m;
}

}  // namespace

double deepestFace(const DistanceField& field, const TriangleMesh& surface) {
  Box all;
  for (const Eigen::Vector3f& p : surface.positions) all.add(p.cast<double>());
  if (all.empty() || surface.triangles.empty()) return 0;
  const auto finest_m = static_cast<float>(kDensity * all.size().norm());
  std::vector<Box> bounds;
  for (std::size_t s = 0; s < field.solidCount(); ++s)
    bounds.push_back(field.bounds(SolidId(static_cast<std::int64_t>(s))));
  const std::size_t faces = surface.triangles.size();
  std::vector<float> deepest((faces + kFacesPerTask - 1) / kFacesPerTask);
  parallelFor(deepest.size(), [&](std::size_t task) {
    const std::size_t first = task * kFacesPerTask;
    deepest[task] =
        deepestOf(field, bounds, surface, first, std::min(faces, first + kFacesPerTask), finest_m);
  });
  return double{*std::ranges::max_element(deepest)};
}

}  // namespace fascia
