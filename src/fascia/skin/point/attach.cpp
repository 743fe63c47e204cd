#include <fascia/skin/grid/attach.h>

#include <algorithm>

#include <fascia/base/parallel.h>
#include <fascia/math/points.h>
#include <fascia/skin/grid/nearest_solids.h>

namespace fascia {
namespace {

constexpr double kTouch_m = 1e-4;
constexpr int kSteps = 64;

// Points of one row that lie together.
struct Piece {
  std::size_t first, number, count;  // storage index, place in the result
};

template <class Visit>
void forEachPiece(const GridLayout& g, const Visit& visit) {
  const auto columns = static_cast<std::size_t>(g.columns);
  parallelFor(static_cast<std::size_t>(g.rows), [&](std::size_t j) {
    for (std::size_t i = 0; i < columns; i += NearestSolids::kBlock)
      visit(Piece{g.row(static_cast<int>(j)) + i, j * columns + i,
                  std::min(NearestSolids::kBlock, columns - i)});
  });
}

// One point on its way along its normal.
struct March {
  std::size_t point;  // of the piece
  Vec3 from_m, inward;
  double reach_m = 0, gone_m = 0;

  Vec3 at() const { return from_m + gone_m * inward; }
};

void attachPiece(const DistanceField& field, ConstVectors points, ConstVectors normals,
                 double fat_m, Attachment* out) {
  NearestSolids flesh(field, kTouch_m);
  VectorArray at(NearestSolids::kBlock);
  std::vector<March> marching(points.count);
  flesh.measure(points);
  for (std::size_t i = 0; i < points.count; ++i) {
    const Vec3 from = pointAt(points, i);
    const double gap = flesh.distance_m(i);
    // A strand much longer than the shortest one would cross the body.
    marching[i] = {i, from, -pointAt(normals, i), 4 * std::max(gap, kTouch_m) + fat_m};
    out[i] = {flesh.solid(i), from - gap * pointAt(flesh.normals(), i)};
  }
  for (int step = 0; step < kSteps && !marching.empty(); ++step) {
    for (std::size_t m = 0; m < marching.size(); ++m) setPoint(at, m, marching[m].at());
    flesh.measure(view(static_cast<const VectorArray&>(at), 0, marching.size()));
    std::size_t left = 0;
    for (std::size_t m = 0; m < marching.size(); ++m) {
      March march = marching[m];
      const double gap = flesh.distance_m(m);
      if (gap < kTouch_m) {
        out[march.point] = {flesh.solid(m), march.at() - gap * pointAt(flesh.normals(), m)};
        continue;
      }
      march.gone_m += gap;
      if (march.gone_m <= march.reach_m) marching[left++] = march;
    }
    marching.resize(left);
  }
}

}  // namespace

std::vector<Attachment> attachAlongNormals(const DistanceField& field, const GridLayout& layout,
                                           const VectorArray& points_m, const VectorArray& normals,
                                           double fat_m) {
  std::vector<Attachment> attachments(layout.pointCount());
  forEachPiece(layout, [&](const Piece& piece) {
    attachPiece(field, view(points_m, piece.first, piece.count),
                view(normals, piece.first, piece.count), fat_m, attachments.data() + piece.number);
  });
  return attachments;
}

std::vector<SolidId> nearestSolids(const DistanceField& field, const GridLayout& layout,
                                   const VectorArray& points_m) {
  std::vector<SolidId> nearest(layout.pointCount());
  forEachPiece(layout, [&](const Piece& piece) {
    NearestSolids flesh(field, kTouch_m);
    flesh.measure(view(points_m, piece.first, piece.count));
    for (std::size_t i = 0; i < piece.count; ++i) nearest[piece.number + i] = flesh.solid(i);
  });
  return nearest;
}

}  // namespace fascia
