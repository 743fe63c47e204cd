#include <fascia/deformable/body/body_map.h>

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include <fascia/base/assert.h>
#include <fascia/base/error.h>
#include <fascia/geometry/box_tree.h>

namespace fascia {
namespace {

// How far beyond its box, in parts of its size, a body's polynomials are still trusted.
constexpr double kMargin = 0.25;
constexpr int kMaxIterations = 40;
constexpr int kMaxShorterSteps = 8;
// Of the body's size: where Newton's method ends, and what it must reach to have found the point.
constexpr double kTolerance = 1e-10, kFoundTolerance = 1e-7;
// Gradients that squeeze volume below this part cannot be inverted in any useful way.
constexpr double kLeastDeterminant = 1e-9;
constexpr double kSlopeStep = 1e-3;  // of the body's size, between gradients that are compared
// A guess this near, in parts of the body's size, is good enough to start from.
constexpr double kNearGuess = 0.05;
constexpr int kMinSamples = 3, kMaxSamples = 6;  // along each axis
constexpr std::size_t kMostSurfacePoints = 600;  // each costs in every set(), and in searches

using ShapeBuffer = std::array<double, BodyMap::kMaxShapes>;
using GradientBuffer = std::array<double, 3 * BodyMap::kMaxShapes>;

// x = R p of all samples; values: p at each. Coordinates beyond D stay.
template <int D>
void moveSamples(const Eigen::MatrixXd& R, const Eigen::MatrixXd& values,
                 const std::vector<Vec3>& samples_m, std::vector<Vec3>& out_m) {
  const Eigen::Index count = values.rows();
  for (std::size_t i = 0; i < out_m.size(); ++i) {
    const double *value = values.col(static_cast<Eigen::Index>(i)).data(), *column = R.data();
    std::array<double, D> x{};
    for (Eigen::Index j = 0; j < count; ++j, column += D)
      for (std::size_t row = 0; row < D; ++row) x[row] += value[j] * column[row];
    out_m[i] = samples_m[i];
    for (std::size_t row = 0; row < D; ++row) out_m[i][static_cast<Eigen::Index>(row)] = x[row];
  }
}

}  // namespace

BodyMap::BodyMap(BodyShapePtr shape, const Box& domain_m, const TriangleMesh& surface) {
  FASCIA_ASSERT(shape && !domain_m.empty(), "a map is of a body with a domain");
  FASCIA_ASSERT(surface.normals.size() <= surface.positions.size(), "every normal is at a point");
  auto constant = std::make_shared<Constant>();
  Constant& c = *constant;
  const Basis& basis = shape->basis();
  if (basis.size() > kMaxShapes) {
    Issue issue{{},
                "body map: found a basis of " + std::to_string(basis.size()) +
                    " functions, expected at most " + std::to_string(kMaxShapes),
                {}};
    throw Error(issue);
  }
  c.dimension = basis.dimension(), c.shapeCount = basis.size();
  c.affine = basis.degree() == 1;
  c.domain_m = domain_m, c.center_m = domain_m.center();
  c.reach_m = {domain_m.low - kMargin * domain_m.size(), domain_m.high + kMargin * domain_m.size()};
  const int count = std::clamp(basis.degree() + 1, kMinSamples, kMaxSamples);
  c.sampleCount = count;
  for (int k = 0; k < count; ++k)
    for (int j = 0; j < count; ++j)
      for (int i = 0; i < count; ++i)
        c.samples_m.emplace_back(domain_m.low +
                                 domain_m.size().cwiseProduct(Vec3(i, j, k) / (count - 1)));
  c.latticeCount = c.samples_m.size();
  const std::size_t stride = 1 + surface.positions.size() / kMostSurfacePoints;
  for (std::size_t i = 0; i < surface.normals.size(); i += stride) {
    c.samples_m.push_back(surface.positions[i].cast<double>());
    c.normals.push_back(surface.normals[i].cast<double>());
  }
  const auto samples = static_cast<Eigen::Index>(c.samples_m.size());
  c.sampleValues.resize(c.shapeCount, samples);
  for (Eigen::Index i = 0; i < samples; ++i)
    basis.values(c.samples_m[static_cast<std::size_t>(i)], c.sampleValues.col(i));
  c.shape = std::move(shape);
  constant_ = std::move(constant);
  R_.resize(c.dimension, c.shapeCount), rate_.resize(c.dimension, c.shapeCount);
  deformed_m_.resize(c.samples_m.size());
  const std::vector<double> zero(static_cast<std::size_t>(c.shape->coordinateCount()));
  std::vector<double> rest = zero;
  c.shape->setRest({}, rest);
  set(rest, zero);
}

void BodyMap::set(std::span<const double> q, std::span<const double> v) {
  FASCIA_ASSERT(q.size() == v.size() &&
                    q.size() == static_cast<std::size_t>(constant_->shape->coordinateCount()),
                "the coordinates are of this body");
  const BodyShape& shape = *constant_->shape;
  shape.writeShapeMatrix(q, R_);
  shape.writeShapeMatrix(v, rate_);
  center_ = at(center_m());
  const Tangent rate = tangentOf(rate_, center_m(), true);
  centerVelocity_m_per_s_ = rate.x_m, centerRate_per_s_ = rate.gradient;
  constant_->dimension == 2
      ? moveSamples<2>(R_, constant_->sampleValues, constant_->samples_m, deformed_m_)
      : moveSamples<3>(R_, constant_->sampleValues, constant_->samples_m, deformed_m_);
  measure();
}

// R p(X) and its gradient, with the third coordinate of planes: X's own, or at rest if it is a
// rate.
BodyMap::Tangent BodyMap::tangentOf(const Eigen::MatrixXd& R, const Vec3& X, bool isRate) const {
  FASCIA_ASSERT(R.cols() == constant_->shapeCount, "a column for each shape");
  const Constant& c = *constant_;
  ShapeBuffer values;
  GradientBuffer slopes;
  Eigen::Map<Eigen::VectorXd> p(values.data(), c.shapeCount);
  Eigen::Map<Eigen::MatrixXd> dp(slopes.data(), c.shapeCount, 3);
  const Vec3 near = X.cwiseMax(c.reach_m.low).cwiseMin(c.reach_m.high);
  const Basis& basis = c.shape->basis();
  basis.values(near, p);
  basis.gradients(near, dp);
  Tangent t{Vec3::Zero(), Mat3::Zero()};
  for (Eigen::Index j = 0; j < c.shapeCount; ++j) {
    for (Eigen::Index row = 0; row < c.dimension; ++row) {
      t.x_m[row] += R(row, j) * p[j];
      for (Eigen::Index axis = 0; axis < c.dimension; ++axis)
        t.gradient(row, axis) += R(row, j) * dp(j, axis);
    }
  }
  if (c.dimension == 2 && !isRate) t.x_m.z() = near.z(), t.gradient(2, 2) = 1;
  t.x_m += t.gradient * (X - near);
  return t;
}

// ∂x/∂X of the straight continuation too: there the tangent itself changes along the box, by the
// second derivative across it, which is the difference of gradients across it (exact for quadratic
// bodies).
Mat3 BodyMap::slope(const Vec3& X, const Mat3& gradient) const {
  const Constant& c = *constant_;
  const Vec3 near = X.cwiseMax(c.reach_m.low).cwiseMin(c.reach_m.high);
  const Vec3 beyond = X - near;
  const double way_m = beyond.norm();
  if (way_m == 0) return gradient;
  const double step_m = kSlopeStep * c.domain_m.size().maxCoeff();
  const Mat3 inner = at(near - step_m / way_m * beyond).gradient;
  Mat3 out = gradient;
  for (int axis = 0; axis < 3; ++axis)
    if (beyond[axis] == 0) out.col(axis) += way_m / step_m * (gradient.col(axis) - inner.col(axis));
  return out;
}

BodyMap::Tangent BodyMap::at(const Vec3& X) const {
  return tangentOf(R_, X, false);
}

Vec3 BodyMap::velocity(const Vec3& X) const {
  return tangentOf(rate_, X, true).x_m;
}

// The largest second difference of lattice samples in a row along an axis, m.
double BodyMap::largestBend_m(std::size_t axis) const {
  FASCIA_ASSERT(axis < 3 && constant_->latticeCount <= deformed_m_.size(),
                "the lattice is of the samples");
  const auto n = static_cast<std::size_t>(constant_->sampleCount);
  const std::size_t stride = axis == 0 ? 1 : axis == 1 ? n : n * n;
  double largest_m = 0;
  for (std::size_t i = 0; i < constant_->latticeCount; ++i) {
    if (i / stride % n + 2 >= n) continue;
    const Vec3* at = deformed_m_.data() + i;
    largest_m = std::max(largest_m, (at[0] - 2 * at[stride] + at[2 * stride]).norm());
  }
  return largest_m;
}

// Between samples the map is off from the trilinear one by at most h²/8 |∂²x| along each axis, an
// eighth of a second difference: exactly so for quadratic bodies, so twice that for higher ones.
void BodyMap::measure() {
  bounds_ = {};
  for (const Vec3& x : deformed_m_) bounds_.add(x);
  double curved_m = 0;
  for (std::size_t axis = 0; axis < 3 && !constant_->affine; ++axis)
    curved_m += largestBend_m(axis) / 8;
  if (constant_->shape->basis().degree() > 2) curved_m *= 2;
  const Vec3 pad = Vec3::Constant(curved_m);
  bounds_ = {bounds_.low - pad, bounds_.high + pad};
}

// Between a parabola's ends, n − 1 samples apart, the middle is off by (n − 1)²/8 second
// differences.
std::array<Vec3, 3> BodyMap::bulges() const {
  std::array<Vec3, 3> out{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  if (constant_->affine) return out;
  const auto n = static_cast<std::size_t>(constant_->sampleCount), middle = n / 2;
  const std::size_t strides[] = {1, n, n * n};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t stride = strides[axis];
    const std::size_t first = middle * (strides[0] + strides[1] + strides[2]) - middle * stride;
    for (std::size_t i = 0; i + 2 < n; ++i) {
      const Vec3* at = deformed_m_.data() + first + i * stride;
      const Vec3 bulge_m = 0.125 * static_cast<double>((n - 1) * (n - 1)) *
                           (at[0] - 2 * at[stride] + at[2 * stride]);
      if (bulge_m.squaredNorm() > out[axis].squaredNorm()) out[axis] = bulge_m;
    }
  }
  return out;
}

std::size_t BodyMap::nearestSample(const Vec3& x, std::size_t first) const {
  FASCIA_ASSERT(first < deformed_m_.size(), "there are samples");
  std::size_t best = first;
  double best_m2 = 1e300;
  for (std::size_t i = first; i < deformed_m_.size(); ++i) {
    const double square_m2 = (deformed_m_[i] - x).squaredNorm();
    if (square_m2 < best_m2) best_m2 = square_m2, best = i;
  }
  return best;
}

BodyMap::Clearance BodyMap::boxClearance(const Vec3& x) const {
  const Vec3 away = x - x.cwiseMax(bounds_.low).cwiseMin(bounds_.high);
  const double length_m = away.norm();
  return {length_m, length_m > 0 ? Vec3(away / length_m) : Vec3(Vec3::UnitY())};
}

BodyMap::Clearance BodyMap::planeClearance(const Vec3& x) const {
  const std::size_t first = constant_->latticeCount;
  if (first == deformed_m_.size()) return boxClearance(x);
  const std::size_t nearest = nearestSample(x, first);
  const Mat3 F = at(constant_->samples_m[nearest]).gradient;
  const Vec3 image = cofactors(F) * constant_->normals[nearest - first];
  const double length = image.norm();
  const Vec3 n = length > 0 ? Vec3(image / length) : Vec3(Vec3::UnitY());
  return {n.dot(x - deformed_m_[nearest]), n};
}

BodyMap::Inverse BodyMap::inverse(const Vec3& x) const {
  const Mat3& F = center_.gradient;
  const bool sound = F.determinant() > kLeastDeterminant;
  const Vec3 straight =
      sound ? Vec3(center_m() + F.inverse() * (x - center_.x_m)) : Vec3(center_m());
  if (constant_->affine) return {straight, F, sound};
  const double near_m = kNearGuess * constant_->shape->size_m();
  const double off_m = sound ? (point(straight) - x).norm() : 1e300;
  if (off_m < near_m) {
    const Inverse found = newton(x, straight);
    if (found.found) return found;
  }
  // Much bent, the body's own points tell best where to look.
  Vec3 start = constant_->samples_m[nearestSample(x, 0)];
  if (off_m < (point(start) - x).norm()) start = straight;
  return newton(x, start);
}

// Newton's method for map(X) = x, each step shortened until it comes nearer to x.
BodyMap::Inverse BodyMap::newton(const Vec3& x, const Vec3& start) const {
  const double size_m = constant_->shape->size_m();
  Inverse here{start, Mat3::Identity(), false};
  Tangent tangent = at(start);
  double off_m = (x - tangent.x_m).norm();
  for (int i = 0; i < kMaxIterations && off_m > kTolerance * size_m; ++i) {
    const Mat3 F = slope(here.X_m, tangent.gradient);
    if (!(F.determinant() > kLeastDeterminant)) break;
    const Vec3 full = F.inverse() * (x - tangent.x_m);
    double share = std::min(1.0, 0.5 * size_m / full.norm());
    bool nearer = false;
    for (int halving = 0; halving < kMaxShorterSteps && !nearer; ++halving, share *= 0.5) {
      const Vec3 X = here.X_m + share * full;
      const Tangent there = at(X);
      const double thereOff_m = (x - there.x_m).norm();
      if (!(thereOff_m < off_m)) continue;
      here.X_m = X, tangent = there, off_m = thereOff_m, nearer = true;
    }
    if (!nearer) break;
  }
  here.gradient = tangent.gradient;
  here.found =
      off_m <= kFoundTolerance * size_m && tangent.gradient.determinant() > kLeastDeterminant;
  return here;
}

void deform(const BodyMap& map, TriangleMesh& mesh) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const BodyMap::Tangent tangent = map.at(mesh.positions[i].cast<double>());
    mesh.positions[i] = tangent.x_m.cast<float>();
    // The cofactors' image has the direction of F⁻ᵀ n, and exists for flattened bodies too.
    if (i < mesh.normals.size())
      mesh.normals[i] =
          (cofactors(tangent.gradient) * mesh.normals[i].cast<double>()).normalized().cast<float>();
  }
}

}  // namespace fascia
