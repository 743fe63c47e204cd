#include <algorithm>

#include <fascia/deformable/contact/body_contact.h>
#include <fascia/geometry/box_tree.h>
#include <fascia/math/points.h>

// Which bodies are inside of what, whatever the steps made of it.

namespace fascia {

void BodyContacts::placePoints(BodyId body, std::span<const double> q, VectorArray& points) const {
  const Eigen::MatrixXd& weights = bodies_[body.index()].points->weights;
  const int d = model_.dimension(), k = model_.shape(body).shapeCount();
  const double* x = model_.part(body, q).data();
  points.resize(static_cast<std::size_t>(weights.cols()));
  for (Eigen::Index i = 0; i < weights.cols(); ++i) {
    Vec3 place = Vec3::Zero();
    for (int j = 0; j < k; ++j)
      for (int row = 0; row < d; ++row) place[row] += x[d * j + row] * weights(j, i);
    setPoint(view(points, 0, points.size()), static_cast<std::size_t>(i), place);
  }
}

// Of the deepest of the points that are within the solid's bounds.
double BodyContacts::depthOf(const VectorArray& points, const Field& field, SolidId solid) const {
  const Box bounds = field.bounds(solid);
  VectorArray inside;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 p(points.x[i], points.y[i], points.z[i]);
    if ((p.array() < bounds.low.array()).any() || (p.array() > bounds.high.array()).any()) continue;
    inside.x.push_back(points.x[i]);
    inside.y.push_back(points.y[i]);
    inside.z.push_back(points.z[i]);
  }
  const std::size_t count = inside.x.size();
  if (count == 0) return 0;
  FloatArray distance_m(count);
  VectorArray normal;
  normal.resize(count);
  field.evaluate(solid, view(inside, 0, count), distance_m.data(), view(normal, 0, count));
  return -std::min(0.f, *std::ranges::min_element(distance_m));
}

void BodyContacts::findOverlaps(std::span<const double> q, double leastShare,
                                std::vector<Overlap>& out) {
  refresh();
  out.clear();
  still_.assign(q.size(), 0.0);
  field_.update(q, still_);
  std::vector<VectorArray> points(bodies_.size());
  std::vector<Box> boxes(bodies_.size());
  std::vector<std::size_t> order;  // along x
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (!bodies_[b].points) continue;
    placePoints(BodyId(b), q, points[b]);
    for (std::size_t i = 0; i < points[b].size(); ++i)
      boxes[b].add(Vec3(points[b].x[i], points[b].y[i], points[b].z[i]));
    if (!boxes[b].empty()) order.push_back(b);
  }
  const auto sizeOf = [&](std::size_t b) { return model_.shape(BodyId(b)).size_m(); };
  const auto note = [&](const Overlap& overlap, double size_m) {
    if (overlap.depth_m > leastShare * size_m) out.push_back(overlap);
  };
  for (const std::size_t b : order) {
    if (settings_.ground_m)
      note({BodyId(b), {}, {}, *settings_.ground_m - boxes[b].low.y()}, sizeOf(b));
    for (const Obstacle& obstacle : obstacles_)
      for (std::size_t s = obstacle.padding ? 1 : 0; s < obstacle.field->solidCount(); ++s)
        if (meets(boxes[b], obstacle.field->bounds(SolidId(s))))
          note({BodyId(b), {}, obstacle.id, depthOf(points[b], *obstacle.field, SolidId(s))},
               sizeOf(b));
  }
  if (settings_.bodies_collide) {
    std::ranges::stable_sort(order, {}, [&](std::size_t b) { return boxes[b].low.x(); });
    const auto meet = [&](std::size_t a, std::size_t b) {
      note({BodyId(a), BodyId(b), {}, depthOf(points[a], field_, bodies_[b].solid)},
           std::min(sizeOf(a), sizeOf(b)));
    };
    for (std::size_t i = 0; i < order.size(); ++i) {
      for (std::size_t j = i + 1; j < order.size(); ++j) {
        const std::size_t a = order[i], b = order[j];
        if (boxes[b].low.x() > boxes[a].high.x()) break;
        if (!meets(boxes[a], boxes[b]) || !collides(BodyId(a), BodyId(b))) continue;
        meet(a, b), meet(b, a);
      }
    }
  }
  std::ranges::stable_sort(out, {}, [](const Overlap& o) { return std::pair(o.body, o.other); });
}

}  // namespace fascia
