#include <fascia/deformable/body/body_model.h>

#include <fascia/base/assert.h>
#include <fascia/base/error.h>

namespace fascia {

BodyId BodyModel::add(BodyShapePtr shape) {
  if (!shape) throw Error("body system: found no body, expected one");
  if (!shapes_.empty() && shape->dimension() != dimension()) {
    Issue issue{{},
                "body system: found a body of " + std::to_string(shape->dimension()) +
                    " dimensions, expected " + std::to_string(dimension()) + " as in the others",
                {}};
    throw Error(issue);
  }
  const BodyId id(static_cast<std::int64_t>(shapes_.size()));
  offsets_.push_back(size_);
  size_ += static_cast<std::size_t>(shape->coordinateCount());
  shapes_.push_back(std::move(shape));
  return id;
}

OdeState BodyModel::restState() const {
  OdeState state;
  state.resize(size_);
  for (std::size_t b = 0; b < shapes_.size(); ++b) place(BodyId(b), {}, state);
  return state;
}

void BodyModel::place(BodyId body, const Transform& place, OdeState& state) const {
  FASCIA_ASSERT(body.index() < shapes_.size() && state.r.size() == size_,
                "the state is of these bodies");
  shape(body).setRest(place, part(body, std::span<double>(state.r)));
}

double BodyModel::kineticEnergy_J(std::span<const double> v) const {
  FASCIA_ASSERT(v.size() == size_, "the velocities are of these bodies");
  double sum = 0;
  for (const double x : v) sum += x * x;
  return 0.5 * sum;
}

double BodyModel::elasticEnergy_J(std::span<const double> q) const {
  FASCIA_ASSERT(q.size() == size_, "the coordinates are of these bodies");
  double sum = 0;
  for (std::size_t b = 0; b < shapes_.size(); ++b) sum += shapes_[b]->energy(part(BodyId(b), q));
  return sum;
}

Vec3 BodyModel::momentum_Ns(std::span<const double> v) const {
  FASCIA_ASSERT(v.size() == size_, "the velocities are of these bodies");
  Vec3 sum = Vec3::Zero();
  for (std::size_t b = 0; b < shapes_.size(); ++b) {
    const std::span<const double> part = this->part(BodyId(b), v);
    const Eigen::Map<const Eigen::MatrixXd> V(part.data(), dimension(), shapes_[b]->shapeCount());
    sum.head(dimension()) += V * shapes_[b]->momentumWeights();
  }
  return sum;
}

Vec3 BodyModel::angularMomentum_Nms(std::span<const double> q, std::span<const double> v) const {
  FASCIA_ASSERT(q.size() == size_ && v.size() == size_, "the state is of these bodies");
  // ∫ x × ẋ dm = Σ_j q_j × q̇_j, as the functions s_j are orthonormal over the mass.
  Vec3 sum = Vec3::Zero();
  const auto d = static_cast<std::size_t>(dimension());
  for (std::size_t i = 0; i < size_; i += d) {
    const Vec3 x(q[i], q[i + 1], d == 3 ? q[i + 2] : 0), u(v[i], v[i + 1], d == 3 ? v[i + 2] : 0);
    sum += x.cross(u);
  }
  return sum;
}

}  // namespace fascia
