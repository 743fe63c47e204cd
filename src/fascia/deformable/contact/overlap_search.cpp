#include <fascia/deformable/contact/overlap_search.h>

#include <algorithm>

#include <fascia/math/points.h>

namespace fascia {

void OverlapSearch::find(std::span<const double> q, double leastShare,
                         std::vector<BodyContacts::Overlap>& out) {
  contacts_.refresh();
  out.clear();
  found_ = &out;
  const std::size_t count = contacts_.bodies_.size();
  still_.assign(q.size(), 0.0);
  contacts_.field_.update(q, still_);
  contacts_.obstacles_.update(0);
  points_.resize(count), boxes_.resize(count);
  for (std::size_t b = 0; b < count; ++b) placePoints(BodyId(b), q);
  bodies_.update(boxes_);
  for (std::size_t b = 0; b < count; ++b) {
    if (boxes_[b].empty()) continue;
    findObstacles(BodyId(b), leastShare);
    if (contacts_.settings_.bodies_collide) findBodies(BodyId(b), leastShare);
  }
}

// Also their box; empty without points.
void OverlapSearch::placePoints(BodyId body, std::span<const double> q) {
  Box& box = boxes_[body.index()];
  box = {};
  const auto& known = contacts_.bodies_[body.index()].points;
  if (!known) return;
  const BodyModel& model = contacts_.model_;
  const Eigen::MatrixXd& weights = known->weights;
  const int d = model.dimension(), k = model.shape(body).shapeCount();
  const double* x = model.part(body, q).data();
  VectorArray& points = points_[body.index()];
  points.resize(known->size());
  for (Eigen::Index i = 0; i < weights.cols(); ++i) {
    Vec3 place = Vec3::Zero();
    for (int j = 0; j < k; ++j)
      for (int row = 0; row < d; ++row) place[row] += x[d * j + row] * weights(j, i);
    setPoint(view(points, 0, points.size()), static_cast<std::size_t>(i), place);
    box.add(place);
  }
}

// Of the deepest of the body's points that are within the solid's bounds.
double OverlapSearch::depth_m(BodyId body, const DistanceField& field, SolidId solid) {
  const Box bounds = field.bounds(solid);
  const VectorArray& points = points_[body.index()];
  inside_.resize(points.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 p(points.x[i], points.y[i], points.z[i]);
    if ((p.array() < bounds.low.array()).any() || (p.array() > bounds.high.array()).any()) continue;
    setPoint(view(inside_, 0, points.size()), count++, p);
  }
  if (count == 0) return 0;
  distance_m_.resize(count), normal_.resize(count);
  field.evaluate(solid, view(std::as_const(inside_), 0, count), distance_m_.data(),
                 view(normal_, 0, count));
  return -std::min(0.f,
                   *std::min_element(distance_m_.begin(),
                                     distance_m_.begin() + static_cast<std::ptrdiff_t>(count)));
}

void OverlapSearch::findObstacles(BodyId body, double leastShare) {
  const Box& box = boxes_[body.index()];
  const double least_m = leastShare * size_m(body);
  if (const auto& ground_m = contacts_.settings_.ground_m)
    if (const double depth = *ground_m - box.low.y(); depth > least_m)
      found_->push_back({body, {}, {}, depth});
  contacts_.obstacles_.find(box, near_);
  for (const std::uint32_t number : near_) {
    const Obstacles::Part& part = contacts_.obstacles_.parts()[number];
    if (part.obstacle->padding) continue;  // it gives way
    if (const double depth = depth_m(body, *part.obstacle->field, part.solid); depth > least_m)
      found_->push_back({body, {}, part.obstacle->id, depth});
  }
}

void OverlapSearch::findBodies(BodyId body, double leastShare) {
  bodies_.find(boxes_[body.index()], near_);
  for (const std::uint32_t number : near_) {
    const BodyId other(number);
    if (other == body || !contacts_.collides(body, other)) continue;
    const double least_m = leastShare * std::min(size_m(body), size_m(other));
    const double depth = depth_m(body, contacts_.field_, contacts_.bodies_[number].solid);
    if (depth > least_m) found_->push_back({body, other, {}, depth});
  }
}

}  // namespace fascia
